//! The form of DeePSD (Bertiche et al. 2021), its supervised part: descriptors of the garment's vertices at rest, from a graph network;
//! from them an MLP per vertex makes blend shapes and another one the skin weights; an MLP of the pose weighs the blend shapes.
//! Descriptors come from graph transformer layers as the network's own. DeePSD's descriptor of the garment as a whole is left out: for
//! one garment it is a constant. Weights are added to `W_C^I`, as ΔW_C is, not normalised.

use crate::dataset::{Sample, Setup};
use crate::evaluate::{Judge, differences, predictions};
use crate::rig::{Mesh, numbers, vertices};
use crate::train::adam::{Moments, cosine};
use crate::train::gradient::distance::distance;
use crate::train::item::Item;
use crate::train::tape::{Id, IndexId, Lane, Shared, Tape};
use crate::train::{Row, Settings, Slices, layer, mlp, upload};
use crate::{Error, Result};
use ctsn_core::Streams;
use ctsn_core::device::{Activation, Device, Space};
use ctsn_core::model::{HostModel, Layer, Linear, Sizes, Skin};
use ctsn_core::network::{Activations, forward};
use ctsn_core::topology::Graph;
use rayon::prelude::*;
use std::time::Instant;

/// Graph layers, heads and features of the descriptors.
const LAYERS: usize = 2;
const HEADS: usize = 4;
const FEATURES: usize = 64;
/// Blend shapes, and hidden widths of the MLPs: pose, blend shapes, weights.
const SHAPES: usize = 128;
const POSE: [usize; 3] = [256; 3];
const BLEND: [usize; 2] = [256; 2];
const WEIGHTS: [usize; 1] = [128];
/// Of the last layers' initial weights, so that training starts near plain skinning.
const SMALL: f32 = 0.01;
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
}

impl Half {
    fn new(mut tape: Tape, parameters: Vec<Id>) -> Self {
        let shared = tape.seal(&parameters.iter().collect::<Vec<_>>());
        let moments = parameters.iter().map(|id| Moments::new(shared.get(*id).len())).collect();
        Self { tape, shared, parameters, moments }
    }

    /// Adam on the parameters from `first` on.
    fn update(&mut self, first: usize, lane: &Lane, step: usize, rate: f32) {
        for (id, moments) in self.parameters.iter().zip(&mut self.moments).skip(first) {
            moments.step(step, rate, lane.gradient(*id), self.shared.get_mut(*id));
        }
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
        let (garment, of_garment) = record_garment(&model, setup, &mut rng);
        let mut tape = Tape::default();
        let recorded = upload(&model, &mut tape);
        let mut parameters = vec![recorded.skeleton, recorded.skin.weights];
        parameters.extend(recorded.embedding.iter().flat_map(|layer| [layer.weight, layer.bias]));
        let mut pose = Half::new(tape, parameters);
        let mut activations = Activations::new(&model, |length| pose.tape.buffer(&vec![0.0; length]));
        forward(&mut pose.tape, &recorded, Streams::Skeleton, Space::Body, &mut activations);
        let lanes = (0..LANES.min(settings.batch)).map(|_| pose.tape.lane(&pose.shared)).collect();
        let garment_lane = garment.tape.lane(&garment.shared);
        let outputs = [of_garment, (recorded.skeleton, recorded.skin.weights)];
        Ok(Self { model, garment, garment_lane, outputs, pose, activations, lanes, items, settings })
    }

    /// Trains to the end; the epoch of the least validation error.
    pub fn fit(mut self, slices: &Slices, judge: &Judge, mut progress: impl FnMut(&Row)) -> Result<Trained> {
        let start = Instant::now();
        let learned = self.garment.parameters.iter().map(|id| self.garment.shared.get(*id).len()).sum::<usize>();
        let of_pose = self.pose.parameters.iter().skip(2).map(|id| self.pose.shared.get(*id).len()).sum::<usize>();
        let mut best: Option<(Row, HostModel)> = None;
        for epoch in 1..=self.settings.epochs {
            if best.as_ref().is_some_and(|(row, _)| epoch - row.epoch > self.settings.patience) {
                break;
            }
            let fine = self.epoch(epoch - 1);
            let model = self.model();
            let predicted = predictions(&model, judge, &slices.validation, Streams::Skeleton)?;
            let errors = slices
                .validation
                .iter()
                .zip(&predicted)
                .map(|(sample, predicted)| differences(predicted, &vertices(&sample.truth), &model.triangles));
            let sum = errors.fold((0.0, 0.0), |sum, error| (sum.0 + error.0, sum.1 + error.1));
            let count = slices.validation.len() as f64;
            let (distance, normal) = ((sum.0 / count) as f32, (sum.1 / count) as f32);
            if !fine.is_finite() || !distance.is_finite() {
                return Err(Error::Diverged(format!("epoch {epoch}: loss {fine}")));
            }
            let row = Row { epoch, fine, distance, normal, seconds: start.elapsed().as_secs_f64(), ..Row::default() };
            progress(&row);
            if best.as_ref().is_none_or(|(best, _)| distance < best.distance) {
                best = Some((row, model));
            }
        }
        let (best, model) = best.ok_or_else(|| Error::Training("wanted at least one epoch, found 0".to_owned()))?;
        Ok(Trained { best, model, parameters: learned + of_pose })
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
            let rate = cosine(rate, step as f32 / (epochs * steps) as f32);
            total += self.step(batch, step + 1, rate);
        }
        total / order.len() as f32
    }

    /// One optimisation step; the sum of the losses.
    fn step(&mut self, batch: &[usize], step: usize, rate: f32) -> f32 {
        self.pass_on();
        let (tape, shared, items, a) = (&self.pose.tape, &self.pose.shared, &self.items, &self.activations);
        let lanes = self.lanes.len();
        let run = |(number, lane): (usize, &mut Lane)| {
            lane.clear(shared, true);
            let mut loss = 0.0;
            for item in batch.iter().skip(number).step_by(lanes).map(|item| &items[*item]) {
                lane.value_mut(a.pose).copy_from_slice(&item.frame.vector);
                lane.value_mut(a.body_frame).copy_from_slice(&item.frame.transforms);
                tape.run(shared, lane);
                lane.clear(shared, false);
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

    /// Sums the lanes' gradients, runs the garment's half backwards and steps every parameter.
    fn learn(&mut self, step: usize, rate: f32) {
        let Self { garment, garment_lane, outputs: [(shapes, weights), (of_shapes, of_weights)], pose, .. } = self;
        let Some((first, others)) = self.lanes.split_first_mut() else { return };
        for id in &pose.parameters {
            let sum = first.gradient_mut(*id);
            others.iter().for_each(|lane| sum.iter_mut().zip(lane.gradient(*id)).for_each(|(sum, g)| *sum += g));
        }
        garment_lane.clear(&garment.shared, true);
        for (to, from) in [(shapes, of_shapes), (weights, of_weights)] {
            garment_lane.gradient_mut(*to).copy_from_slice(first.gradient(*from));
        }
        garment.tape.backward(&garment.shared, garment_lane);
        garment.update(0, garment_lane, step, rate);
        // Blend shapes and weights come first there, and follow from the garment's half.
        pose.update(2, first, step, rate);
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

/// Records garment at rest -> descriptors -> blend shapes [n, 3, SHAPES] and weights [n, J].
fn record_garment(model: &HostModel, setup: &Setup, rng: &mut fastrand::Rng) -> (Half, (Id, Id)) {
    let (n, joints) = (model.sizes.vertices, model.sizes.joints);
    let mut tape = Tape::default();
    let (inputs, potentials) = rest_features(model, setup);
    let (inputs, potentials) = (tape.buffer(&inputs), tape.buffer(&potentials));
    let initial = tape.buffer(&model.skin.weights);
    let graph =
        Graph { offsets: tape.indices(&model.graph.offsets), neighbours: tape.indices(&model.graph.neighbours) };
    let layers: Vec<Layer<Id>> = (0..LAYERS)
        .map(|l| upload_layer(&mut tape, &layer(if l == 0 { 6 } else { FEATURES }, FEATURES, rng)))
        .collect();
    let mut small = |widths: &[usize], tape: &mut Tape| -> Vec<Linear<Id>> {
        let mut layers = mlp(widths, rng);
        if let Some(last) = layers.last_mut() {
            last.weight.iter_mut().chain(&mut last.bias).for_each(|value| *value *= SMALL);
        }
        layers.iter().map(|layer| upload_linear(tape, layer)).collect()
    };
    let blend = small(&[&[FEATURES], &BLEND[..], &[3 * SHAPES]].concat(), &mut tape);
    let weights = small(&[&[FEATURES], &WEIGHTS[..], &[joints]].concat(), &mut tape);
    let dense = blend.iter().chain(&weights).chain(layers.iter().map(|layer| &layer.project));
    let mut parameters: Vec<Id> = dense.flat_map(|layer| [layer.weight, layer.bias]).collect();
    parameters.extend(layers.iter().flat_map(|layer| [layer.edge, layer.gate, layer.norm_weight, layer.norm_bias]));
    let mut half = Half::new(tape, parameters);
    let tape = &mut half.tape;
    let sizes = Sizes { heads: HEADS, features: FEATURES, ..model.sizes };
    let descriptors = record_graph(tape, &graph, sizes, &layers, inputs, &potentials);
    let shapes = record_mlp(tape, &blend, descriptors, n);
    let change = record_mlp(tape, &weights, descriptors, n);
    let mut total = tape.buffer(&vec![0.0; n * joints]);
    tape.add(&initial, &change, &mut total);
    (half, (shapes, total))
}

/// Position and normal at rest [n, 6], standardised; the same per mean edge length, whose differences are the edges' features.
fn rest_features(model: &HostModel, setup: &Setup) -> (Vec<f32>, Vec<f32>) {
    let rest = vertices(&setup.template);
    let mesh = Mesh { positions: rest.clone(), triangles: setup.triangles.as_chunks::<3>().0.to_vec() };
    let normals = numbers(&mesh.normals(&rest));
    let pairs = || setup.template.as_chunks::<3>().0.iter().zip(normals.as_chunks::<3>().0);
    let (mean, std, edge) = (model.reference.mean, model.reference.std, model.reference.edge_scale);
    let centred = |position: &[f32; 3]| -> [f32; 3] { std::array::from_fn(|c| (position[c] - mean[c]) / std[c]) };
    let inputs = pairs().flat_map(|(position, normal)| centred(position).into_iter().chain(*normal));
    let potentials = pairs().flat_map(|(position, normal)| position.map(|x| x / edge).into_iter().chain(*normal));
    (inputs.collect(), potentials.collect())
}

fn record_graph(
    tape: &mut Tape,
    graph: &Graph<IndexId>,
    sizes: Sizes,
    layers: &[Layer<Id>],
    inputs: Id,
    potentials: &Id,
) -> Id {
    let n = sizes.vertices;
    let mut h = inputs;
    for layer in layers {
        let [mut projected, mut attended, mut output] =
            [4 * FEATURES, FEATURES, FEATURES].map(|width| tape.buffer(&vec![0.0; n * width]));
        tape.linear(&h, &layer.project, Activation::None, &mut projected);
        tape.attend(graph, sizes, &mut projected, potentials, layer, &mut attended);
        tape.gate(&attended, &projected, layer, &mut output);
        h = output;
    }
    h
}

/// ReLU between the layers and none after the last.
fn record_mlp(tape: &mut Tape, layers: &[Linear<Id>], input: Id, rows: usize) -> Id {
    let mut x = input;
    for (i, layer) in layers.iter().enumerate() {
        let mut y = tape.buffer(&vec![0.0; rows * layer.outputs]);
        let activation = if i + 1 == layers.len() { Activation::None } else { Activation::Relu };
        tape.linear(&x, layer, activation, &mut y);
        x = y;
    }
    x
}

fn upload_linear(tape: &mut Tape, layer: &Linear<Vec<f32>>) -> Linear<Id> {
    let (weight, bias) = (tape.buffer(&layer.weight), tape.buffer(&layer.bias));
    Linear { weight, bias, inputs: layer.inputs, outputs: layer.outputs }
}

fn upload_layer(tape: &mut Tape, layer: &Layer<Vec<f32>>) -> Layer<Id> {
    Layer {
        project: upload_linear(tape, &layer.project),
        edge: tape.buffer(&layer.edge),
        gate: tape.buffer(&layer.gate),
        norm_weight: tape.buffer(&layer.norm_weight),
        norm_bias: tape.buffer(&layer.norm_bias),
    }
}
