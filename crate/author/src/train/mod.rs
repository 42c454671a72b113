//! Training: the network's forward pass recorded on the [`Tape`], its gradients, Adam. network.md §6.
//! Each step's batch is dealt in a fixed number of shares, summed in their order, so the result does not depend on threads.

pub(crate) mod adam;
mod checkpoint;
mod curve;
mod fit;
pub mod gradient;
mod initial;
pub(crate) mod item;
mod limbs;
mod operation;
mod penetration;
mod recording;
mod slice;
mod smooth;
mod step;
pub(crate) mod tape;
#[cfg(test)]
mod tests;
mod variant;
mod weights;

use crate::dataset::{Sample, Setup, digest, fingerprint};
use crate::{Error, Result};
use adam::{Moments, schedule};
use ctsn_core::device::Device;
use ctsn_core::model::{HostModel, Storage};
use ctsn_core::network::{DeviceModel, Streams};
pub(crate) use curve::write_curve;
pub use fit::{End, Files, Row};
pub use initial::{Architecture, initial};
pub(crate) use initial::{layer, mlp};
use item::Item;
use penetration::Unlabelled;
use recording::Recording;

pub use slice::{Slices, slices};
use smooth::Smoother;
use std::time::{Duration, Instant};
use step::Worker;
use tape::{Id, Shared, Tape};
pub use variant::{Part, Variant, is_mesh_silent};

/// Shares a batch is dealt in.
const SHARES: usize = 4;

/// A gradient per parameter array.
type Sums = Vec<Vec<f32>>;

/// How to train.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Passes over the training samples.
    pub epochs: usize,
    /// Training time to spend instead of `epochs`: the learning rate decays with time, whatever the machine does meanwhile.
    pub budget: Option<Duration>,
    /// Epochs without a better validation error after which training ends.
    pub patience: usize,
    /// Samples per step.
    pub batch: usize,
    /// Adam's learning rate at the start.
    pub rate: f32,
    /// Seed of initial weights, shuffling and unlabelled poses.
    pub seed: u64,
    /// The parts that learn.
    pub variant: Variant,
}

impl Default for Settings {
    fn default() -> Self {
        Self { epochs: 100, budget: None, patience: 50, batch: 8, rate: 1e-3, seed: 1, variant: Variant::FULL }
    }
}

/// Mean losses of one epoch, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loss {
    /// Coarse prediction against the smoothed truth.
    pub coarse: f32,
    /// Whole prediction against the truth: E_dist on the training samples.
    pub fine: f32,
    /// What predictions lack to the gap around the body: the whole ones of samples, the coarse ones of unlabelled poses.
    pub penetration: f32,
}

/// Training in progress: parameters, moments and the recorded network.
pub struct Trainer {
    model: HostModel,
    settings: Settings,
    /// Tells the model before the first step from any other.
    start: u64,
    /// [`fingerprint`] of the samples.
    data: u64,
    items: Vec<Item>,
    /// The network, as it learns from samples.
    recording: Recording,
    /// None where there is no body, nothing to make poses of, or no skeleton stream to learn.
    unlabelled: Option<Unlabelled>,
    shared: Shared,
    parameters: Vec<Id>,
    /// Per parameter array, the entries that stay zero: between the parts of Φ, [`limbs`].
    silent: Vec<Vec<usize>>,
    moments: Vec<Moments>,
    /// One per thread.
    workers: Vec<Worker>,
    /// Gradients of `parameters`, summed over the poses of each share.
    sums: Vec<Sums>,
    curve: Vec<Row>,
    /// E_dist on the validation slice before the first epoch, metres.
    pub untrained: Option<f32>,
    /// Values of `parameters` at the best epoch; empty before the first.
    best: Vec<Vec<f32>>,
    /// When this process began to train, and the seconds spent before.
    started: (Instant, f64),
    /// Epochs done.
    pub epoch: usize,
}

impl Trainer {
    /// Prepares training of `model` on `samples`.
    pub fn new(mut model: HostModel, setup: &Setup, samples: &[&Sample], settings: Settings) -> Result<Self> {
        if samples.is_empty() {
            return Err(Error::Training("the training split is empty".to_owned()));
        }
        let Settings { batch, rate, variant, .. } = settings;
        if batch == 0 || rate.is_nan() || rate <= 0.0 {
            return Err(Error::Training(format!("batch and learning rate must be positive, found {batch} and {rate}")));
        }
        variant.silence(&mut model);
        let start = digest(&model.to_bytes(Storage::F32));
        let smoother = Smoother::new(model.sizes.vertices, &setup.triangles);
        let items = samples.iter().map(|sample| Item::new(&model, sample, Some(&smoother))).collect::<Result<_>>()?;
        let streams = if variant.mesh { Streams::Both } else { Streams::Skeleton };
        let (recording, shared, learning) = Recording::new(&model, variant, streams);
        let (silent, parameters): (Vec<_>, Vec<Id>) =
            learning.into_iter().map(|(i, id)| (silent(&model, i), id)).unzip();
        let unlabelled = Unlabelled::new(&model, setup, samples, &settings)?;
        let shares = SHARES.min(batch);
        let worker = || Worker::new(&model, &recording, unlabelled.as_ref(), &shared);
        let workers = (0..shares.min(rayon::current_num_threads())).map(|_| worker()).collect();
        let lengths = || parameters.iter().map(|id| shared.get(*id).len());
        let sums = vec![lengths().map(|length| vec![0.0; length]).collect(); shares];
        let moments = lengths().map(Moments::new).collect();
        Ok(Self {
            model,
            settings,
            start,
            data: fingerprint(setup, samples),
            items,
            recording,
            unlabelled,
            shared,
            parameters,
            silent,
            moments,
            workers,
            sums,
            curve: Vec::new(),
            untrained: None,
            best: Vec::new(),
            started: (Instant::now(), 0.0),
            epoch: 0,
        })
    }

    /// One pass over the samples, shuffled by seed and epoch; `progress(step, steps, loss)` after every step.
    pub fn epoch(&mut self, mut progress: impl FnMut(usize, usize, Loss)) -> Result<Loss> {
        let mut order: Vec<usize> = (0..self.items.len()).collect();
        fastrand::Rng::with_seed(self.settings.seed.wrapping_add(self.epoch as u64)).shuffle(&mut order);
        let steps = self.steps();
        let mut total = Loss::default();
        for (i, batch) in order.chunks(self.settings.batch).enumerate() {
            let loss = self.step(batch, self.epoch * steps + i)?;
            if [loss.fine, loss.coarse, loss.penetration].iter().any(|part| !part.is_finite()) {
                return Err(Error::Diverged(format!("epoch {} step {}: {loss:?}", self.epoch + 1, i + 1)));
            }
            let share = batch.len() as f32 / order.len() as f32;
            total.coarse += share * loss.coarse;
            total.fine += share * loss.fine;
            total.penetration += share * loss.penetration;
            progress(i + 1, steps, loss);
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

    /// Share of the training that is over: of its time where that is given, else of its epochs.
    pub fn progress(&self) -> f64 {
        self.progress_at(self.epoch * self.steps())
    }

    fn progress_at(&self, step: usize) -> f64 {
        match self.settings.budget {
            Some(budget) => self.seconds() / budget.as_secs_f64(),
            None => step as f64 / (self.settings.epochs * self.steps()).max(1) as f64,
        }
    }

    /// Learning rate of optimisation step `step`.
    fn rate(&self, step: usize) -> f32 {
        schedule(self.settings.rate, self.progress_at(step) as f32)
    }

    /// The model as trained so far.
    pub fn model(&self) -> HostModel {
        self.filled(self.parameters.iter().map(|id| self.shared.get(*id)))
    }

    /// The epoch with the least validation error and its model; `None` before the first.
    pub fn best(&self) -> Option<(Row, HostModel)> {
        Some((self.best_epoch()?, self.filled(self.best.iter().map(Vec::as_slice))))
    }

    fn filled<'a>(&self, parameters: impl Iterator<Item = &'a [f32]>) -> HostModel {
        let mut model = self.model.clone();
        let arrays = model.parameters_mut().into_iter().enumerate();
        let learning = arrays.filter(|(i, _)| self.settings.variant.learns(*i));
        learning.zip(parameters).for_each(|((_, array), values)| array.copy_from_slice(values));
        model
    }
}

/// The entries of array `i` of [`Model::parameters`](ctsn_core::model::Model::parameters) that stay zero.
fn silent(model: &HostModel, i: usize) -> Vec<usize> {
    // W_C, B and M, then weight and bias of each layer of Φ.
    let layer = i.checked_sub(3).filter(|i| i.is_multiple_of(2)).and_then(|i| model.embedding.get(i / 2));
    let weights = layer.map_or(&[][..], |layer| &layer.weight);
    (0..weights.len()).filter(|entry| weights[*entry] == 0.0).collect()
}

pub(crate) fn upload(model: &HostModel, tape: &mut Tape) -> DeviceModel<Tape> {
    let tape = std::cell::RefCell::new(tape);
    model.map(|values| tape.borrow_mut().buffer(values), |indices| tape.borrow_mut().indices(indices))
}
