//! Training: the network's forward pass recorded on the [`Tape`], its gradients, Adam. network.md §6. Each step's batch
//! is dealt in a fixed number of shares, summed in their order, so the result does not depend on threads.

pub(crate) mod adam;
mod blur;
mod checkpoint;
mod coarse;
mod compass;
pub mod curve;
mod duration;
mod fit;
pub mod gradient;
pub(crate) mod hypernetwork;
mod initial;
pub(crate) mod item;
mod limbs;
mod mirror;
pub(crate) mod parameters;
mod recording;
mod slice;
mod step;
pub(crate) mod tape;
#[cfg(test)]
mod tests;
mod unsimulated;
mod variant;
mod watch;
mod weights;

use crate::dataset::{Sample, Setup, digest, fingerprint};
use crate::judging::Bending;
use crate::loss::{Known, LOSSES, Losses, SELF_SUPERVISED, Scene, TEACHER, Term, magnitude, told};
use crate::{Error, Result};
use coarse::Coarse;
use ctsn_core::model::{HostModel, Storage};
use ctsn_core::network::DeviceModel;
use ctsn_rig::vertices;
pub use curve::Row;
use duration::duration;
pub use fit::{End, Files};
use hypernetwork::Hypernetwork;
pub use initial::{Architecture, initial};
pub(crate) use initial::{layer, mlp};
use item::Item;
pub use mirror::mirrored;
use parameters::Parameters;
use recording::Recording;
pub use slice::{POSES, Slices, slices};
use std::time::{Duration, Instant};
use step::Worker;
use tape::Tape;
use unsimulated::Unsimulated;
pub use variant::{Part, Variant, is_mesh_silent};

/// Shares a batch is dealt in.
const SHARES: usize = 8;

/// A gradient per parameter array.
type Sums = Vec<Vec<f32>>;

/// How to train.
#[derive(Clone, Copy, Debug, PartialEq, clap::Args)]
pub struct Settings {
    /// Passes over the training poses. Default: 100
    #[arg(long)]
    pub epochs: Option<usize>,
    /// Train for this long instead (90s, 60m, 1.5h); the learning rate falls over that time
    #[arg(long = "time-budget", value_name = "TIME", value_parser = duration, conflicts_with = "epochs")]
    pub budget: Option<Duration>,
    /// Stop after so many epochs without a better validation error
    #[arg(long, default_value_t = Self::default().patience)]
    pub patience: usize,
    /// Simulated poses per optimisation step
    #[arg(long, default_value_t = Self::default().batch)]
    pub batch: usize,
    /// Adam's greatest learning rate: it rises over the first twentieth, then falls along a cosine
    #[arg(id = "learning-rate", long = "learning-rate", value_name = "RATE", default_value_t = Self::default().rate)]
    pub rate: f32,
    /// Seed of the initial weights, the order of poses, and the poses mixed during training
    #[arg(long, default_value_t = Self::default().seed)]
    pub seed: u64,
    /// The parts that learn
    #[arg(skip = Variant::FULL)]
    pub variant: Variant,
}

/// Passes over the training poses, where no other number is asked for.
pub const EPOCHS: usize = 100;

impl Default for Settings {
    fn default() -> Self {
        Self { epochs: None, budget: None, patience: 50, batch: 8, rate: 1e-3, seed: 1, variant: Variant::FULL }
    }
}

impl Settings {
    /// Passes over the training poses.
    pub fn epochs(&self) -> usize {
        self.epochs.unwrap_or(EPOCHS)
    }
}

/// Training in progress: parameters, moments and the recorded network.
pub struct Trainer {
    model: HostModel,
    settings: Settings,
    /// Tells the model before the first step from any other.
    start: u64,
    /// [`fingerprint`] of the samples.
    data: u64,
    /// The losses that take part.
    terms: Vec<Term>,
    items: Vec<Item>,
    /// The network, as it learns from samples.
    recording: Recording,
    /// None where no loss reads what the network makes of such poses, or there is nothing to make them of.
    unsimulated: Option<Unsimulated>,
    bending: Bending,
    /// None where no pose was simulated coarsely.
    coarse: Option<Coarse>,
    parameters: Parameters,
    /// What makes some of `parameters`, where something does.
    hypernetwork: Option<Hypernetwork>,
    /// One per thread.
    workers: Vec<Worker>,
    /// Gradients of `parameters`, summed over the poses of each share.
    sums: Vec<Sums>,
    curve: Vec<Row>,
    /// E_dist on the validation slice before the first epoch, metres.
    pub untrained: Option<f32>,
    /// [`magnitude`](crate::loss::magnitude) of the losses at the first step, before anything is learned.
    first: Option<f32>,
    /// Values of `parameters` at the best epoch; empty before the first.
    best: Vec<Vec<f32>>,
    /// When this process began to train, and the seconds spent before.
    started: (Instant, f64),
    /// Epochs done.
    pub epoch: usize,
}

impl Trainer {
    /// Prepares training of `model` on `samples` by [`LOSSES`].
    pub fn new(model: HostModel, setup: &Setup, samples: &[&Sample], settings: Settings) -> Result<Self> {
        Self::with(model, None, LOSSES, setup, samples, settings)
    }

    /// Prepares training by [`TEACHER`].
    pub fn teacher(model: HostModel, setup: &Setup, samples: &[&Sample], settings: Settings) -> Result<Self> {
        Self::with(model, None, TEACHER, setup, samples, settings)
    }

    /// Prepares training without truth, by [`SELF_SUPERVISED`]; what the samples hold as such is not read.
    pub fn self_supervised(model: HostModel, setup: &Setup, samples: &[&Sample], settings: Settings) -> Result<Self> {
        Self::with(model, None, SELF_SUPERVISED, setup, samples, settings)
    }

    /// The same by other `losses`, or where a network makes some of the model's arrays.
    pub(crate) fn with(
        mut model: HostModel,
        mut hypernetwork: Option<Hypernetwork>,
        losses: &[Term],
        setup: &Setup,
        samples: &[&Sample],
        settings: Settings,
    ) -> Result<Self> {
        if samples.is_empty() {
            return Err(Error::Training("the training split is empty".to_owned()));
        }
        let Settings { batch, rate, variant, .. } = settings;
        if batch == 0 || rate.is_nan() || rate <= 0.0 {
            return Err(Error::Training(format!("batch and learning rate must be positive, found {batch} and {rate}")));
        }
        variant.silence(&mut model);
        let made = || Losses::new(losses, &Scene { model: &model, setup, variant });
        let own = made()?;
        let terms = own.terms();
        let items =
            samples.iter().map(|sample| Item::new(&model, sample, &own, Known::Truth)).collect::<Result<_>>()?;
        let (recording, shared, learning) = Recording::new(&model, variant, variant.streams());
        let unsimulated = Unsimulated::new(&model, &terms, setup, samples, &settings)?;
        let shares = SHARES.min(batch);
        let worker = |_| Worker::new(&recording, unsimulated.as_ref(), &shared, made()?);
        let workers = (0..shares.min(rayon::current_num_threads())).map(worker).collect::<Result<_>>()?;
        let mut parameters = Parameters::new(shared, learning).over(model.graph.clone());
        hypernetwork.iter_mut().for_each(|network| network.make(&mut parameters));
        let sums = vec![parameters.each().map(|(_, values)| vec![0.0; values.len()]).collect(); shares];
        let mut trainer = Self {
            model,
            settings,
            start: 0,
            data: fingerprint(setup, samples)?,
            terms,
            items,
            recording,
            unsimulated,
            bending: Bending::new(&setup.elastic()?, &vertices(&setup.garment)),
            coarse: None,
            parameters,
            hypernetwork,
            workers,
            sums,
            curve: Vec::new(),
            untrained: None,
            first: None,
            best: Vec::new(),
            started: (Instant::now(), 0.0),
            epoch: 0,
        };
        trainer.start = digest(&trainer.model().to_bytes(Storage::F32));
        Ok(trainer)
    }

    /// Adds poses of the same garment and character whose cloth was simulated coarsely. They are no part of an epoch:
    /// as many are drawn for each step as come to one of each, up to four times the batch.
    pub fn add_coarse(&mut self, setup: &Setup, samples: &[&Sample]) -> Result<()> {
        let Some(Worker { losses, .. }) = self.workers.first() else { return Ok(()) };
        self.coarse = Coarse::new(&self.model, setup, samples, losses, &self.settings, self.steps())?;
        let Some(coarse) = &self.coarse else { return Ok(()) };
        for worker in &mut self.workers {
            worker.coarse = Some(coarse.recording.lane(&self.parameters.shared)?);
        }
        Ok(())
    }

    /// One pass over the samples, shuffled by seed and epoch; the mean of each loss. `progress(step, steps, losses)`
    /// after every step.
    pub fn epoch(&mut self, mut progress: impl FnMut(usize, usize, &[f32])) -> Result<Vec<f32>> {
        let mut order: Vec<usize> = (0..self.items.len()).collect();
        fastrand::Rng::with_seed(self.settings.seed.wrapping_add(self.epoch as u64)).shuffle(&mut order);
        let steps = self.steps();
        let mut total = vec![0.0; self.terms.len()];
        for (i, batch) in order.chunks(self.settings.batch).enumerate() {
            let losses = self.step(batch, self.epoch * steps + i)?;
            if losses.iter().any(|loss| !loss.is_finite()) {
                let (epoch, step, told) = (self.epoch + 1, i + 1, told(&self.terms, &losses));
                return Err(Error::Diverged(format!("epoch {epoch} step {step}: {told}")));
            }
            self.first.get_or_insert(magnitude(&self.terms, &losses));
            let share = batch.len() as f32 / order.len() as f32;
            total.iter_mut().zip(&losses).for_each(|(total, loss)| *total += share * loss);
            progress(i + 1, steps, &losses);
        }
        self.epoch += 1;
        Ok(total)
    }

    /// Optimisation steps per epoch.
    pub fn steps(&self) -> usize {
        self.items.len().div_ceil(self.settings.batch)
    }

    /// Seconds of training so far, in this process and before.
    pub fn seconds(&self) -> f64 {
        self.started.1 + self.started.0.elapsed().as_secs_f64()
    }

    /// The model as trained so far.
    pub fn model(&self) -> HostModel {
        self.filled(self.parameters.each())
    }

    /// The epoch with the least validation error and its model; `None` before the first.
    pub fn best(&self) -> Option<(Row, HostModel)> {
        let best = self.parameters.each().map(|(name, _)| name).zip(self.best.iter().map(Vec::as_slice));
        Some((self.best_epoch()?.clone(), self.filled(best)))
    }

    /// The model with these arrays, by name, in the order of its parameters.
    fn filled<'a>(&self, arrays: impl Iterator<Item = (&'a str, &'a [f32])>) -> HostModel {
        let mut model = self.model.clone();
        let mut arrays = arrays.peekable();
        for (name, array) in model.parameters_mut() {
            if let Some((_, values)) = arrays.next_if(|(learned, _)| *learned == name) {
                array.copy_from_slice(values);
            }
        }
        model
    }
}

pub(crate) fn upload(model: &HostModel, tape: &mut Tape) -> DeviceModel<Tape> {
    let tape = std::cell::RefCell::new(tape);
    model.map(|values| tape.borrow_mut().buffer(values), |indices| tape.borrow_mut().indices(indices))
}
