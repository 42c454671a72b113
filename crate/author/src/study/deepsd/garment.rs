//! DeePSD's form, the half that knows the garment alone: vertices at rest -> descriptors -> blend shapes and skin weights.

use super::{Half, SHAPES};
use crate::dataset::Setup;
use crate::rig::{Mesh, numbers, vertices};
use crate::train::tape::{Id, IndexId, Tape};
use crate::train::{layer, mlp};
use ctsn_core::device::{Activation, Device};
use ctsn_core::model::{HostModel, Layer, Linear, Sizes};
use ctsn_core::topology::Graph;

/// Graph layers, heads and features of the descriptors.
const LAYERS: usize = 2;
const HEADS: usize = 4;
const FEATURES: usize = 64;
/// Hidden widths of the MLPs: blend shapes, weights.
const BLEND: [usize; 2] = [256; 2];
const WEIGHTS: [usize; 1] = [128];
/// Of the last layers' initial weights, so that training starts near plain skinning.
const SMALL: f32 = 0.01;

/// Descriptors and the MLP that reads them. Blend shapes and weights have descriptors each: the tape takes back one gradient a buffer.
struct Branch {
    layers: Vec<Layer<Id>>,
    mlp: Vec<Linear<Id>>,
}

impl Branch {
    fn new(tape: &mut Tape, widths: &[usize], rng: &mut fastrand::Rng) -> Self {
        let inputs = |l: usize| if l == 0 { 6 } else { FEATURES };
        let layers = (0..LAYERS).map(|l| upload_layer(tape, &layer(inputs(l), FEATURES, rng))).collect();
        let mut mlp = mlp(&[&[FEATURES], widths].concat(), rng);
        if let Some(last) = mlp.last_mut() {
            last.weight.iter_mut().chain(&mut last.bias).for_each(|value| *value *= SMALL);
        }
        Self { layers, mlp: mlp.iter().map(|layer| upload_linear(tape, layer)).collect() }
    }

    fn parameters(&self) -> Vec<Id> {
        let dense = self.mlp.iter().chain(self.layers.iter().map(|layer| &layer.project));
        let mut parameters: Vec<Id> = dense.flat_map(|layer| [layer.weight, layer.bias]).collect();
        let rest = |layer: &Layer<Id>| [layer.edge, layer.gate, layer.norm_weight, layer.norm_bias];
        parameters.extend(self.layers.iter().flat_map(rest));
        parameters
    }
}

/// Records garment at rest -> descriptors -> blend shapes [n, 3, SHAPES] and weights [n, J].
pub(super) fn record(model: &HostModel, setup: &Setup, rng: &mut fastrand::Rng) -> (Half, (Id, Id)) {
    let (n, joints) = (model.sizes.vertices, model.sizes.joints);
    let mut tape = Tape::default();
    let (inputs, potentials) = rest_features(model, setup);
    let (inputs, potentials) = (tape.buffer(&inputs), tape.buffer(&potentials));
    let initial = tape.buffer(&model.skin.weights);
    let graph =
        Graph { offsets: tape.indices(&model.graph.offsets), neighbours: tape.indices(&model.graph.neighbours) };
    let blend = Branch::new(&mut tape, &[&BLEND[..], &[3 * SHAPES]].concat(), rng);
    let weights = Branch::new(&mut tape, &[&WEIGHTS[..], &[joints]].concat(), rng);
    let mut half = Half::new(tape, [blend.parameters(), weights.parameters()].concat());
    let tape = &mut half.tape;
    let sizes = Sizes { heads: HEADS, features: FEATURES, ..model.sizes };
    let mut run = |branch: &Branch| {
        let descriptors = record_graph(tape, &graph, sizes, &branch.layers, inputs, &potentials);
        record_mlp(tape, &branch.mlp, descriptors, n)
    };
    let (shapes, change) = (run(&blend), run(&weights));
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
        tape.attend(graph, sizes, &mut projected, potentials, layer, &mut attended, &mut output);
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
