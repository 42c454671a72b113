//! The form of DeePSD (Bertiche et al. 2021), its supervised part: descriptors of the garment's vertices at rest, from a graph network;
//! from them an MLP per vertex makes blend shapes and another one the skin weights; an MLP of the pose weighs the blend shapes.
//! Descriptors come from graph transformer layers as the network's own. DeePSD's descriptor of the garment as a whole is left out: for
//! one garment it is a constant. Weights are added to smoothed `W_C^I`, as ΔW_C is, not normalised.

mod garment;

use crate::dataset::{Sample, Setup};
use crate::evaluate::{Judge, differences, predictions};
use crate::rig::vertices;
use crate::train::adam::{Moments, schedule};
use crate::train::gradient::distance::distance;
use crate::train::item::Item;
use crate::train::tape::{Id, Lane, Shared, Tape};
use crate::train::{Row, Settings, Slices, mlp, upload, write_curve};
use crate::{Error, Result};
use ctsn_core::Streams;
use ctsn_core::device::{Device, Space};
use ctsn_core::model::{HostModel, Skin};
use ctsn_core::network::{Activations, forward};
use rayon::prelude::*;
use std::path::Path;
use std::time::Instant;

/// Blend shapes, and hidden widths of the pose's MLP.
const SHAPES: usize = 128;
const POSE: [usize; 3] = [256; 3];
/// Lanes that share a batch.
const LANES: usize = 4;

/// A recorded half of the network: what depends on the garment alone, or what depends on the pose.
struct Half {
    tape: Tape,
    shared: Shared,
    parameters: Vec<Id>,
    moments: Vec<Moments>,
}

/// Training in progress.
pub(super) struct Deepsd {
    /// What predicts: the blend shapes are its skeleton basis.
    model: HostModel,
    garment: Half,
    garment_lane: Lane,
    /// Blend shapes [n, 3, SHAPES] and weights [n, J] in the garment's half, then in the pose's.
    outputs: [(Id, Id); 2],
    pose: Half,
    activations: Activations<Id>,
    lanes: Vec<Lane>,
    items: Vec<Item>,
    settings: Settings,
}

/// What came of a training.
pub(super) struct Trained {
    /// The best epoch.
    pub best: Row,
    /// Its model.
    pub model: HostModel,
    /// Numbers that were learned.
    pub parameters: usize,
    /// Seconds of training.
    pub seconds: f64,
}

/// Mean E_dist (metres) and E_norm (degrees) on `samples`.
fn validate(model: &HostModel, judge: &Judge, samples: &[&Sample]) -> Result<(f32, f32)> {
    let predicted = predictions(model, judge, samples, Streams::Skeleton)?;
    let errors = samples
        .iter()
        .zip(&predicted)
        .map(|(sample, predicted)| differences(predicted, &vertices(&sample.truth), &model.triangles));
    let sum = errors.fold((0.0, 0.0), |sum, error| (sum.0 + error.0, sum.1 + error.1));
    let count = samples.len() as f64;
    Ok(((sum.0 / count) as f32, (sum.1 / count) as f32))
}

impl Half {
    fn new(mut tape: Tape, parameters: Vec<Id>) -> Self {
        let shared = tape.seal(&parameters.iter().collect::<Vec<_>>());
        let moments = parameters.iter().map(|id| Moments::new(shared.get(*id).len())).collect();
        Self { tape, shared, parameters, moments }
    }

    /// Adam on the parameters from `first` on, against the sum of the lanes' gradients.
    fn update(&mut self, first: usize, lanes: &[Lane], step: usize, rate: f32) {
        for (id, moments) in self.parameters.iter().zip(&mut self.moments).skip(first) {
            let gradients: Vec<&[f32]> = lanes.iter().map(|lane| lane.gradient(*id)).collect();
            moments.step(step, rate, &gradients, self.shared.get_mut(*id));
        }
    }

    /// Forgets the gradients of the parameters.
    fn clear(parameters: &[Id], lane: &mut Lane) {
        parameters.iter().for_each(|id| lane.gradient_mut(*id).fill(0.0));
    }
}

impl Deepsd {
    /// `model` with a skeleton stream of no importance, whose pose MLP, basis and weights become those of this form.
    pub fn new(mut model: HostModel, setup: &Setup, samples: &[&Sample], settings: Settings) -> Result<Self> {
        let (n, joints) = (model.sizes.vertices, model.sizes.joints);
        let mut rng = fastrand::Rng::with_seed(settings.seed);
        model.sizes.embedding = SHAPES;
        model.embedding = mlp(&[&[12 * joints], &POSE[..], &[SHAPES]].concat(), &mut rng);
        model.skeleton = vec![0.0; 3 * n * SHAPES];
        let weights = model.skin.to_dense(joints);
        let dense = (0..n * joints).map(|slot| (slot % joints) as u32).collect();
        model.skin = Skin { joints: dense, weights, width: joints };
        let items = samples.iter().map(|sample| Item::new(&model, sample, None)).collect::<Result<_>>()?;
        let (garment, of_garment) = garment::record(&model, setup, &mut rng);
        let mut tape = Tape::default();
        let recorded = upload(&model, &mut tape);
        let mut parameters = vec![recorded.skeleton, recorded.skin.weights];
        parameters.extend(recorded.embedding.iter().flat_map(|layer| [layer.weight, layer.bias]));
        let mut pose = Half::new(tape, parameters);
        let mut activations = Activations::new(&model, |_, length| pose.tape.buffer(&vec![0.0; length]));
        forward(&mut pose.tape, &recorded, Streams::Skeleton, Space::Body, &mut activations);
        let lanes = (0..LANES.min(settings.batch)).map(|_| pose.tape.lane(&pose.shared)).collect();
        let garment_lane = garment.tape.lane(&garment.shared);
        let outputs = [of_garment, (recorded.skeleton, recorded.skin.weights)];
        Ok(Self { model, garment, garment_lane, outputs, pose, activations, lanes, items, settings })
    }

    /// Trains to the end, or until it diverges; the epoch of the least validation error. Without checkpoints: it begins anew.
    pub fn fit(
        mut self,
        slices: &Slices,
        judge: &Judge,
        curve: &Path,
        mut progress: impl FnMut(&Row),
    ) -> Result<Trained> {
        let start = Instant::now();
        let learned = self.garment.parameters.iter().map(|id| self.garment.shared.get(*id).len()).sum::<usize>();
        let of_pose = self.pose.parameters.iter().skip(2).map(|id| self.pose.shared.get(*id).len()).sum::<usize>();
        let (mut best, mut rows): (Option<(Row, HostModel)>, Vec<Row>) = (None, Vec::new());
        for epoch in 1..=self.settings.epochs {
            if best.as_ref().is_some_and(|(row, _)| epoch - row.epoch > self.settings.patience) {
                break;
            }
            let fine = self.epoch(epoch - 1);
            let model = self.model();
            let (distance, normal) = validate(&model, judge, &slices.validation)?;
            if !fine.is_finite() || !distance.is_finite() {
                if best.is_some() {
                    break;
                }
                return Err(Error::Diverged(format!("epoch {epoch}: loss {fine}")));
            }
            let row = Row { epoch, fine, distance, normal, seconds: start.elapsed().as_secs_f64(), ..Row::default() };
            rows.push(row);
            write_curve(curve, &rows)?;
            progress(&row);
            if best.as_ref().is_none_or(|(best, _)| distance < best.distance) {
                best = Some((row, model));
            }
        }
        let (best, model) = best.ok_or_else(|| Error::Training("wanted at least one epoch, found 0".to_owned()))?;
        Ok(Trained { best, model, parameters: learned + of_pose, seconds: start.elapsed().as_secs_f64() })
    }

    /// One pass over the samples, in the order of seed and epoch; the mean loss, metres.
    fn epoch(&mut self, done: usize) -> f32 {
        let Settings { epochs, batch, rate, seed, .. } = self.settings;
        let mut order: Vec<usize> = (0..self.items.len()).collect();
        fastrand::Rng::with_seed(seed.wrapping_add(done as u64)).shuffle(&mut order);
        let steps = order.len().div_ceil(batch);
        let mut total = 0.0;
        for (i, batch) in order.chunks(batch).enumerate() {
            let step = done * steps + i;
            let rate = schedule(rate, step as f32 / (epochs * steps) as f32);
            total += self.step(batch, step + 1, rate);
        }
        total / order.len() as f32
    }

    /// One optimisation step; the sum of the losses.
    fn step(&mut self, batch: &[usize], step: usize, rate: f32) -> f32 {
        self.pass_on();
        let Half { tape, shared, parameters, .. } = &self.pose;
        let (items, a) = (&self.items, &self.activations);
        let lanes = self.lanes.len();
        let run = |(number, lane): (usize, &mut Lane)| {
            Half::clear(parameters, lane);
            let mut loss = 0.0;
            for item in batch.iter().skip(number).step_by(lanes).map(|item| &items[*item]) {
                lane.value_mut(a.pose).copy_from_slice(&item.frame.vector);
                lane.value_mut(a.body_frame).copy_from_slice(&item.frame.transforms);
                tape.run(shared, lane);
                let mut g = std::mem::take(lane.gradient_mut(a.positions));
                loss += distance(lane.value(shared, a.positions), &item.truth, 1.0 / batch.len() as f32, &mut g);
                *lane.gradient_mut(a.positions) = g;
                tape.backward(shared, lane);
            }
            loss
        };
        let losses: Vec<f32> = self.lanes.par_iter_mut().enumerate().map(run).collect();
        self.learn(step, rate);
        losses.iter().sum()
    }

    /// The garment's half forwards: its blend shapes and weights become those of the pose's half.
    fn pass_on(&mut self) {
        let Self { garment, garment_lane, outputs: [(shapes, weights), (to_shapes, to_weights)], pose, .. } = self;
        garment.tape.run(&garment.shared, garment_lane);
        for (from, to) in [(shapes, to_shapes), (weights, to_weights)] {
            pose.shared.get_mut(*to).copy_from_slice(garment_lane.value(&garment.shared, *from));
        }
    }

    /// Runs the garment's half backwards from the lanes' gradients, and steps every parameter.
    fn learn(&mut self, step: usize, rate: f32) {
        let Self { garment, garment_lane, outputs: [(shapes, weights), (of_shapes, of_weights)], pose, lanes, .. } =
            self;
        Half::clear(&garment.parameters, garment_lane);
        for (to, from) in [(shapes, of_shapes), (weights, of_weights)] {
            let sum = garment_lane.gradient_mut(*to);
            sum.fill(0.0);
            lanes.iter().for_each(|lane| sum.iter_mut().zip(lane.gradient(*from)).for_each(|(sum, g)| *sum += g));
        }
        garment.tape.backward(&garment.shared, garment_lane);
        garment.update(0, std::slice::from_ref(garment_lane), step, rate);
        // Blend shapes and weights come first there, and follow from the garment's half.
        pose.update(2, lanes, step, rate);
    }

    /// The model as trained so far.
    fn model(&mut self) -> HostModel {
        self.pass_on();
        let mut model = self.model.clone();
        let [shapes, weights, ..] = self.pose.parameters[..] else { return model };
        model.skeleton.copy_from_slice(self.pose.shared.get(shapes));
        model.skin.weights.copy_from_slice(self.pose.shared.get(weights));
        let of_pose = model.embedding.iter_mut().flat_map(|layer| [&mut layer.weight, &mut layer.bias]);
        for (array, id) in of_pose.zip(&self.pose.parameters[2..]) {
            array.copy_from_slice(self.pose.shared.get(*id));
        }
        model
    }
}
