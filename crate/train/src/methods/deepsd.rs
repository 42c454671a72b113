//! DeePSD's form (Bertiche et al. 2021), its supervised part. A graph network computes descriptors of the garment's
//! vertices at rest. From them, one MLP makes the blend shapes of each vertex, another its skin weights. An MLP of the
//! pose weighs the blend shapes. The graph layers are of the same kind as our own network's. DeePSD's descriptor of the
//! garment as a whole is left out: for one garment it is a constant. Weights are added to smoothed `W_C^I`, as ΔW_C is,
//! and not normalised.

use crate::Result;
use crate::dataset::Setup;
use crate::training::hypernetwork::Hypernetwork;
use crate::training::parameters::Parameters;
use crate::training::tape::{Id, IndexId, Tape};
use crate::training::{layer, mlp};
use ctsn_core::device::Device;
use ctsn_core::model::{CLOTH_WEIGHTS, HostModel, Layer, Linear, SKELETON_BASIS, Skinning};
use ctsn_core::network::{Workings, graph_layer};
use ctsn_core::operation::{self, Activation};
use ctsn_core::topology::Graph;
use ctsn_rig::{Mesh, numbers, vertices};

/// Blend shapes, and hidden widths of the pose's MLP.
const SHAPES: usize = 128;
const POSE: [usize; 3] = [256; 3];
/// Graph layers, heads and features of the descriptors.
const LAYERS: usize = 2;
const HEADS: usize = 4;
const FEATURES: usize = 64;
/// Hidden widths of the MLPs: blend shapes, weights.
const BLEND: [usize; 2] = [256; 2];
const WEIGHTS: [usize; 1] = [128];
/// Factor on the initial weights of the last layers, so that training starts near plain skinning.
const SMALL: f32 = 0.01;

/// Descriptors and the MLP that reads them. Blend shapes and weights have descriptors of their own: the tape takes one
/// gradient per buffer.
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

    /// Its arrays, by name.
    fn parameters(&self, name: &str) -> Vec<(String, Id)> {
        let dense = |part: &str, i: usize, layer: &Linear<Id>| {
            [("weight", layer.weight), ("bias", layer.bias)]
                .map(|(array, id)| (format!("{name}.{part}.{i}.{array}"), id))
        };
        let mut list: Vec<_> = self.mlp.iter().enumerate().flat_map(|(i, layer)| dense("mlp", i, layer)).collect();
        list.extend(self.layers.iter().enumerate().flat_map(|(l, layer)| dense("graph", l, &layer.project)));
        for (l, Layer { edge, gate, norm_weight, norm_bias, .. }) in self.layers.iter().enumerate() {
            let parts = [("edge", edge), ("gate", gate), ("norm_weight", norm_weight), ("norm_bias", norm_bias)];
            list.extend(parts.map(|(part, id)| (format!("{name}.graph.{l}.{part}"), *id)));
        }
        list
    }
}

/// Makes the form out of a model with a skeleton stream: its pose MLP, basis and weights become the form's. The network
/// that is returned makes the basis (blend shapes [n, 3, SHAPES]) and the weights [n, J] from the garment.
pub(super) fn deepsd(mut model: HostModel, setup: &Setup, seed: u64) -> Result<(HostModel, Hypernetwork)> {
    let (n, joints) = (model.sizes.vertices, model.sizes.joints);
    let mut rng = fastrand::Rng::with_seed(seed);
    model.sizes.embedding = SHAPES;
    model.embedding = mlp(&[&[12 * joints], &POSE[..], &[SHAPES]].concat(), &mut rng);
    model.skeleton_basis = vec![0.0; 3 * n * SHAPES];
    let weights = model.skinning.to_dense(joints);
    let dense = (0..n * joints).map(|slot| (slot % joints) as u32).collect();
    model.skinning = Skinning { joints: dense, weights, width: joints };
    let network = record(&model, setup, &mut rng)?;
    Ok((model, network))
}

/// Number of learned parameters: those of the garment's network and of the pose's MLP.
pub(super) fn size(model: &HostModel, network: &Hypernetwork) -> usize {
    let of_pose = model.embedding.iter().map(|layer| layer.weight.len() + layer.bias.len());
    network.parameters.count() + of_pose.sum::<usize>()
}

/// Garment at rest -> descriptors -> blend shapes and weights.
fn record(model: &HostModel, setup: &Setup, rng: &mut fastrand::Rng) -> Result<Hypernetwork> {
    let (n, joints) = (model.sizes.vertices, model.sizes.joints);
    let mut tape = Tape::default();
    let (inputs, potentials) = rest_features(model, setup);
    let (inputs, potentials) = (tape.buffer(&inputs), tape.buffer(&potentials));
    let initial = tape.buffer(&model.skinning.weights);
    let graph =
        Graph { offsets: tape.indices(&model.graph.offsets), neighbours: tape.indices(&model.graph.neighbours) };
    let blend = Branch::new(&mut tape, &[&BLEND[..], &[3 * SHAPES]].concat(), rng);
    let weights = Branch::new(&mut tape, &[&WEIGHTS[..], &[joints]].concat(), rng);
    let learning = [blend.parameters("blend"), weights.parameters("weights")].concat();
    let shared = tape.seal(&learning.iter().map(|(_, id)| id).collect::<Vec<_>>());
    let mut run = |branch: &Branch| {
        let descriptors = record_graph(&mut tape, &graph, n, &branch.layers, inputs, &potentials);
        record_mlp(&mut tape, &branch.mlp, descriptors, n)
    };
    let (shapes, change) = (run(&blend), run(&weights));
    let mut total = tape.buffer(&vec![0.0; n * joints]);
    tape.add(&initial, &change, &mut total);
    let outputs = [(shapes, SKELETON_BASIS), (total, CLOTH_WEIGHTS)].map(|(id, name)| (id, name.to_owned()));
    Hypernetwork::new(tape, Parameters::new(shared, learning), outputs.into())
}

/// Position and normal at rest [n, 6], standardised: the inputs. The same in mean edge lengths: the potentials, whose
/// difference along an edge is its feature.
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
    n: usize,
    layers: &[Layer<Id>],
    inputs: Id,
    potentials: &Id,
) -> Id {
    let mut h = inputs;
    for layer in layers {
        let [projected, attended, mut output] =
            [4 * FEATURES, FEATURES, FEATURES].map(|width| tape.buffer(&vec![0.0; n * width]));
        let room = (&mut Workings { projected, attended }, &mut output);
        graph_layer(tape, (graph, HEADS), layer, [&h, potentials], room);
        h = output;
    }
    h
}

/// ReLU between the layers, none after the last.
fn record_mlp(tape: &mut Tape, layers: &[Linear<Id>], input: Id, rows: usize) -> Id {
    let mut x = input;
    for (i, layer) in layers.iter().enumerate() {
        let mut y = tape.buffer(&vec![0.0; rows * layer.outputs]);
        let activation = if i + 1 == layers.len() { Activation::None } else { Activation::Relu };
        let (weight, bias) = (&layer.weight, &layer.bias);
        tape.run(operation::Linear { x: &x, weight, bias, activation, y: &mut y }.into());
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
