//! Training: the network's forward pass recorded on the [`Tape`], its gradients, Adam. network.md §6.
//! Each step's batch is dealt to a fixed number of lanes and summed in their order, so the result does not depend on threads.

mod adam;
mod checkpoint;
pub mod gradient;
mod initial;
mod smooth;
mod tape;
#[cfg(test)]
mod tests;

use crate::dataset::{Sample, Setup};
use crate::{Error, Result};
use adam::{Moments, cosine};
use ctsn_core::device::{Device, Space};
use ctsn_core::model::HostModel;
use ctsn_core::network::{Activations, DeviceModel, Streams, forward};
use ctsn_core::pose::BodyFrame;
pub use initial::{Architecture, initial};
use rayon::prelude::*;
use smooth::Smoother;
use tape::{Id, Lane, Shared, Tape};

/// Lanes that share a batch.
const LANES: usize = 4;

/// How to train.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Passes over the training samples.
    pub epochs: usize,
    /// Samples per step.
    pub batch: usize,
    /// Adam's learning rate at the start.
    pub rate: f32,
    /// Seed of initial weights and shuffling.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { epochs: 60, batch: 8, rate: 1e-3, seed: 1 }
    }
}

/// Mean losses of one epoch, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loss {
    /// Coarse prediction against the smoothed truth.
    pub coarse: f32,
    /// Whole prediction against the truth: E_dist on the training samples.
    pub fine: f32,
}

/// One sample as the tape sees it.
struct Item {
    frame: BodyFrame,
    truth: Vec<f32>,
    smooth: Vec<f32>,
}

/// Training in progress: parameters, moments and the recorded network.
pub struct Trainer {
    model: HostModel,
    settings: Settings,
    items: Vec<Item>,
    tape: Tape,
    shared: Shared,
    parameters: Vec<Id>,
    moments: Vec<Moments>,
    activations: Activations<Id>,
    coarse: Id,
    lanes: Vec<Lane>,
    /// Epochs done.
    pub epoch: usize,
}

impl Trainer {
    /// Prepares training of `model` on `samples`.
    pub fn new(model: HostModel, setup: &Setup, samples: &[&Sample], settings: Settings) -> Result<Self> {
        if samples.is_empty() {
            return Err(Error::Training("the training split is empty".to_owned()));
        }
        if settings.batch == 0 || settings.rate <= 0.0 {
            return Err(Error::Training(format!("batch and learning rate must be positive, found {settings:?}")));
        }
        let smoother = Smoother::new(model.sizes.vertices, &setup.triangles);
        let items = samples.iter().map(|sample| Item::new(&model, sample, &smoother)).collect::<Result<_>>()?;
        let mut tape = Tape::default();
        let recorded = upload(&model, &mut tape);
        let parameters: Vec<Id> = recorded.parameters().into_iter().copied().collect();
        let shared = tape.seal(&recorded.parameters());
        let mut activations = Activations::new(&model, |_, length| tape.buffer(&vec![0.0; length]));
        forward(&mut tape, &recorded, Streams::Both, Space::Body, &mut activations);
        let mut coarse = tape.buffer(&vec![0.0; model.sizes.vertices * 3]);
        tape.skin(&activations.coarse, &recorded.skin, &activations.body_frame, Space::Body, &mut coarse);
        let lanes = (0..LANES.min(settings.batch)).map(|_| tape.lane(&shared)).collect();
        let moments = parameters.iter().map(|id| Moments::new(shared.get(*id).len())).collect();
        Ok(Self { model, settings, items, tape, shared, parameters, moments, activations, coarse, lanes, epoch: 0 })
    }

    /// One pass over the samples, shuffled by seed and epoch; `progress(step, steps, loss)` after every step.
    pub fn epoch(&mut self, mut progress: impl FnMut(usize, usize, Loss)) -> Result<Loss> {
        let mut order: Vec<usize> = (0..self.items.len()).collect();
        fastrand::Rng::with_seed(self.settings.seed.wrapping_add(self.epoch as u64)).shuffle(&mut order);
        let steps = order.len().div_ceil(self.settings.batch);
        let mut total = Loss::default();
        for (i, batch) in order.chunks(self.settings.batch).enumerate() {
            let loss = self.step(batch, self.epoch * steps + i, self.settings.epochs * steps);
            if !(loss.fine.is_finite() && loss.coarse.is_finite()) {
                let place = format!("epoch {} step {i}", self.epoch);
                return Err(Error::Training(format!(
                    "diverged at {place}: loss {}; try a lower learning rate",
                    loss.fine
                )));
            }
            let share = batch.len() as f32 / order.len() as f32;
            total.coarse += share * loss.coarse;
            total.fine += share * loss.fine;
            progress(i + 1, steps, loss);
        }
        self.epoch += 1;
        Ok(total)
    }

    /// One optimisation step, number `done` of `all`.
    fn step(&mut self, batch: &[usize], done: usize, all: usize) -> Loss {
        let (tape, shared, items) = (&self.tape, &self.shared, &self.items);
        let (activations, coarse) = (&self.activations, self.coarse);
        let lanes = self.lanes.len();
        let run = |(number, lane): (usize, &mut Lane)| {
            lane.clear(shared, true);
            let mut loss = Loss::default();
            for item in batch.iter().skip(number).step_by(lanes) {
                let sample = sample(tape, shared, lane, activations, coarse, &items[*item], batch.len());
                loss.coarse += sample.coarse;
                loss.fine += sample.fine;
            }
            loss
        };
        let losses: Vec<Loss> = self.lanes.par_iter_mut().enumerate().map(run).collect();
        let rate = cosine(self.settings.rate, done as f32 / all as f32);
        self.update(done + 1, rate);
        let count = batch.len() as f32;
        let sum = |part: fn(&Loss) -> f32| losses.iter().map(part).sum::<f32>() / count;
        Loss { coarse: sum(|loss| loss.coarse), fine: sum(|loss| loss.fine) }
    }

    /// Sums the lanes' gradients in order and steps every parameter.
    fn update(&mut self, step: usize, rate: f32) {
        let Some((first, others)) = self.lanes.split_first_mut() else { return };
        for (id, moments) in self.parameters.iter().zip(&mut self.moments) {
            let gradient = first.gradient_mut(*id);
            for lane in &*others {
                gradient.iter_mut().zip(lane.gradient(*id)).for_each(|(sum, g)| *sum += g);
            }
            moments.step(step, rate, gradient, self.shared.get_mut(*id));
        }
    }

    /// The model as trained so far.
    pub fn model(&self) -> HostModel {
        let mut model = self.model.clone();
        for (values, id) in model.parameters_mut().into_iter().zip(&self.parameters) {
            values.copy_from_slice(self.shared.get(*id));
        }
        model
    }
}

fn upload(model: &HostModel, tape: &mut Tape) -> DeviceModel<Tape> {
    let tape = std::cell::RefCell::new(tape);
    model.map(|values| tape.borrow_mut().buffer(values), |indices| tape.borrow_mut().indices(indices))
}

/// Forward and backward pass of one sample; gradients are those of the batch's mean loss.
fn sample(
    tape: &Tape,
    shared: &Shared,
    lane: &mut Lane,
    a: &Activations<Id>,
    coarse: Id,
    item: &Item,
    batch: usize,
) -> Loss {
    lane.value_mut(a.pose).copy_from_slice(&item.frame.vector);
    lane.value_mut(a.body_frame).copy_from_slice(&item.frame.transforms);
    tape.run(shared, lane);
    lane.clear(shared, false);
    let scale = 1.0 / batch as f32;
    let mut against = |predicted: Id, truth: &[f32]| {
        let mut g = lane.take_gradient(predicted);
        let loss = gradient::distance::distance(lane.value(shared, predicted), truth, scale, &mut g);
        *lane.gradient_mut(predicted) = g;
        loss
    };
    let loss = Loss { coarse: against(coarse, &item.smooth), fine: against(a.positions, &item.truth) };
    tape.backward(shared, lane);
    loss
}

impl Item {
    fn new(model: &HostModel, sample: &Sample, smoother: &Smoother) -> Result<Self> {
        if sample.truth.len() != model.sizes.vertices * 3 {
            let (wanted, found) = (model.sizes.vertices, sample.truth.len() / 3);
            return Err(Error::Training(format!("a sample has {found} vertices, the model {wanted}")));
        }
        let mut frame = BodyFrame::new(model.sizes.joints);
        model.rig.body_frame(&sample.joints, &mut frame)?;
        Ok(Self { frame, truth: sample.truth.clone(), smooth: smoother.smooth(&sample.truth) })
    }
}
