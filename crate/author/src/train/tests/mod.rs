//! Gradients against central differences, per operation and for the whole network; the loss falls.

mod fit;
mod penetration;
mod weights;

use super::*;
use crate::dataset::{Dataset, Description, Record};
use ctsn_core::cpu::{self, Level};
use ctsn_core::device::{Activation, Space};
use ctsn_core::model::{Layer, Linear, Sizes, Skin};
use ctsn_core::pose::BodyFrame;
use ctsn_core::topology::Graph;

/// Relative disagreement allowed between a gradient and a central difference: both are f32, steps of 1e-3 at values of order one
/// leave about 1e-3 of rounding; ReLU kinks within a step add as much again.
const TOLERANCE: f64 = 1e-2;
const STEP: f32 = 1e-3;

fn random(rng: &mut fastrand::Rng, length: usize) -> Vec<f32> {
    (0..length).map(|_| rng.f32() * 2.0 - 1.0).collect()
}

fn product(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
}

/// Builds one operation on random inputs, the first ones trainable and the last `constants` not, and checks the gradient of
/// `probe · output` towards each trainable one.
fn check_operation(lengths: &[usize], constants: usize, output: usize, build: impl Fn(&mut Tape, &[Id], &mut Id)) {
    let mut rng = fastrand::Rng::with_seed(7);
    let mut tape = Tape::default();
    let ids: Vec<Id> = lengths.iter().map(|length| tape.buffer(&random(&mut rng, *length))).collect();
    let inputs = &ids[..ids.len() - constants];
    let mut shared = tape.seal(&inputs.iter().collect::<Vec<_>>());
    let mut output = tape.buffer(&vec![0.0; output]);
    build(&mut tape, &ids, &mut output);
    let mut lane = tape.lane(&shared);
    let probe = random(&mut rng, lane.value(&shared, output).len());
    tape.run(&shared, &mut lane);
    lane.gradient_mut(output).copy_from_slice(&probe);
    tape.backward(&shared, &mut lane);
    for (i, id) in inputs.iter().enumerate() {
        let gradient = lane.gradient_mut(*id).clone();
        let direction = random(&mut rng, gradient.len());
        let start = shared.get(*id).to_vec();
        let mut at = |step: f32| {
            let moved = start.iter().zip(&direction).map(|(x, d)| x + step * d);
            shared.get_mut(*id).iter_mut().zip(moved).for_each(|(x, moved)| *x = moved);
            tape.run(&shared, &mut lane);
            product(lane.value(&shared, output), &probe)
        };
        let difference = (at(STEP) - at(-STEP)) / f64::from(2.0 * STEP);
        at(0.0);
        let analytic = product(&gradient, &direction);
        let scale = analytic.abs().max(0.1 * product(&gradient, &gradient).sqrt());
        assert!(scale > 0.0, "input {i} gets no gradient");
        assert!((difference - analytic).abs() <= TOLERANCE * scale, "input {i}: {difference} against {analytic}");
    }
}

/// Five vertices, two triangles; vertex 4 has no neighbour.
fn strip() -> Graph<Vec<u32>> {
    Graph::new(5, &[0, 1, 2, 1, 3, 2])
}

/// A layer of 8 features whose arrays are those given: edge, gate, norm weight, norm bias; no projection.
fn layer(edge: Id, gate: Id, norm_weight: Id, norm_bias: Id) -> Layer<Id> {
    let project = Linear { weight: edge, bias: edge, inputs: 0, outputs: 0 };
    Layer { project, edge, gate, norm_weight, norm_bias }
}

#[test]
fn linear() {
    for activation in [Activation::None, Activation::Relu] {
        check_operation(&[7 * 5, 5 * 9, 9], 0, 7 * 9, |tape, ids, y| {
            tape.linear(&ids[0], &Linear { weight: ids[1], bias: ids[2], inputs: 5, outputs: 9 }, activation, y);
        });
    }
}

#[test]
fn blend() {
    for weights in [6, 5 * 6] {
        // The rest is constant to the gradient by design: network.md §6.
        check_operation(&[weights, 5 * 3 * 6, 15], 1, 15, |tape, ids, y| {
            let (confidence, mut residual) = (tape.buffer(&[1.0]), tape.buffer(&[0.0; 15]));
            tape.blend(&ids[0], &ids[1], &ids[2], &confidence, &mut residual, y);
        });
    }
}

#[test]
fn skin() {
    check_operation(&[15, 10, 4 * 12], 1, 15, |tape, ids, y| {
        let joints = tape.indices(&[0, 1, 1, 2, 0, 2, 0, 1, 2, 2]);
        tape.skin(&ids[0], &Skin { joints, weights: ids[1], width: 2 }, &ids[2], Space::Body, y);
    });
}

#[test]
fn attend() {
    let sizes = Sizes { vertices: 5, joints: 3, embedding: 4, basis: 6, features: 8, heads: 2 };
    let lengths = [5 * 4, 4 * 32, 32, 6 * 8, 24, 8, 8, 5 * 6];
    check_operation(&lengths, 1, 5 * 8, |tape, ids, y| {
        let graph = strip();
        let graph = Graph { offsets: tape.indices(&graph.offsets), neighbours: tape.indices(&graph.neighbours) };
        // Attention changes its input, so that must be an activation.
        let mut projected = tape.buffer(&[0.0; 5 * 32]);
        let project = Linear { weight: ids[1], bias: ids[2], inputs: 4, outputs: 32 };
        tape.linear(&ids[0], &project, Activation::None, &mut projected);
        let mut attended = tape.buffer(&[0.0; 5 * 8]);
        let layer = layer(ids[3], ids[4], ids[5], ids[6]);
        tape.attend(&graph, sizes, &mut projected, &ids[7], &layer, &mut attended, y);
    });
}

#[test]
fn distance() {
    let mut rng = fastrand::Rng::with_seed(5);
    let [predicted, truth, direction] = [0; 3].map(|_| random(&mut rng, 30));
    let mut g = vec![0.0; 30];
    gradient::distance::distance(&predicted, &truth, 1.0, &mut g);
    let mut unused = vec![0.0; 30];
    let mut at = |step: f32| {
        let moved: Vec<f32> = predicted.iter().zip(&direction).map(|(x, d)| x + step * d).collect();
        f64::from(gradient::distance::distance(&moved, &truth, 1.0, &mut unused))
    };
    let difference = (at(STEP) - at(-STEP)) / f64::from(2.0 * STEP);
    assert!((difference - product(&g, &direction)).abs() <= TOLERANCE * difference.abs());
}

/// A golden model with a made-up truth: plain skinning, every vertex moved by up to 5 cm along each axis, differently in each pose.
fn tiny() -> (HostModel, Setup, Vec<Sample>) {
    let model = HostModel::parse(include_bytes!("../../../../../tests/golden/tiny.safetensors")).unwrap();
    let golden = include_bytes!("../../../../../tests/golden/tiny.golden.safetensors");
    let golden = ctsn_core::file::Tensors::parse(golden).unwrap();
    let poses = golden.tensors["pose.joints"].to_f32().unwrap();
    let mut rng = fastrand::Rng::with_seed(11);
    let sample = |(frame, joints): (usize, &[f32])| {
        let (skin, mut body) = (&model.reference.skin, BodyFrame::new(model.sizes.joints));
        model.rig.body_frame(joints, &mut body).unwrap();
        let mut truth = vec![0.0; model.rest.len()];
        let transforms = &body.transforms;
        cpu::skin::skin(Level::new(), &model.rest, &skin.joints, &skin.weights, transforms, Space::Body, &mut truth);
        truth.iter_mut().for_each(|x| *x += 0.1 * (rng.f32() - 0.5));
        let record = Record { frame, ..Record::default() };
        Sample { record, joints: joints.to_vec(), truth }
    };
    let samples = poses.chunks_exact(36).enumerate().map(sample).collect();
    let description = Description {
        character: "tiny".to_owned(),
        garment: "tiny".to_owned(),
        rate: 1.0,
        clips: vec!["only".to_owned()],
        joints: model.rig.joints.clone(),
        root: model.rig.root,
        inverse_bind: model.rig.inverse_bind.iter().map(|transform| transform.to_vec()).collect(),
        ..Description::default()
    };
    let setup = Setup {
        description,
        garment: model.rest.clone(),
        template: model.rest.clone(),
        triangles: model.triangles.clone(),
        surface: Default::default(),
        body: model.reference.rest.clone(),
        body_triangles: Vec::new(),
        body_weights: vec![vec![(0, 0.5), (1, 0.3), (2, 0.2)]; model.sizes.vertices],
    };
    (model, setup, samples)
}

/// Both losses of distance of one sample and their gradients, as training takes them.
#[test]
fn whole_network() {
    let (model, setup, samples) = tiny();
    let mut trainer = Trainer::new(model, &setup, &[&samples[0]], Settings::default()).unwrap();
    let mut rng = fastrand::Rng::with_seed(13);
    let Trainer { recording, shared, workers, items, parameters, .. } = &mut trainer;
    let Recording { tape, activations, coarse } = &*recording;
    let lane = &mut workers[0].lane;
    items[0].learn(recording, shared, lane, None, 1);
    // The coarse loss alone for what only the skeleton stream trains, the sum for the skin weights, the fine loss for the rest:
    // the fine loss does not reach the skeleton stream, by design.
    let skeleton: Vec<bool> = (0..parameters.len()).map(|i| i == 1 || (3..3 + 2 * 2).contains(&i)).collect();
    for (i, id) in parameters.iter().enumerate() {
        let gradient = lane.gradient_mut(*id).clone();
        let norm = product(&gradient, &gradient).sqrt();
        assert!(norm > 0.0, "parameter {i} gets no gradient");
        let noise = random(&mut rng, gradient.len());
        let length = product(&noise, &noise).sqrt();
        let mix = |(g, noise): (&f32, &f32)| g / norm as f32 + noise / length as f32;
        let direction: Vec<f32> = gradient.iter().zip(&noise).map(mix).collect();
        let start = shared.get(*id).to_vec();
        let mut at = |step: f32| {
            let moved = start.iter().zip(&direction).map(|(x, d)| x + step * d);
            shared.get_mut(*id).iter_mut().zip(moved).for_each(|(x, moved)| *x = moved);
            tape.run(shared, lane);
            let mut unused = vec![0.0; items[0].truth.len()];
            let mut loss =
                |id: Id, truth: &[f32]| gradient::distance::distance(lane.value(shared, id), truth, 1.0, &mut unused);
            let (coarse, fine) =
                (loss(coarse.unwrap(), &items[0].smooth), loss(activations.positions, &items[0].truth));
            f64::from(coarse) + if skeleton[i] { 0.0 } else { f64::from(fine) }
        };
        let analytic = product(&gradient, &direction);
        // Rounding spoils short steps, ReLU kinks long ones; which of the two suits depends on the parameter.
        let differences = [2e-3, 5e-4].map(|step: f32| (at(step) - at(-step)) / f64::from(2.0 * step));
        at(0.0);
        let close = differences.iter().any(|difference| (difference - analytic).abs() <= TOLERANCE * analytic.abs());
        assert!(close, "parameter {i}: differences {differences:?}, gradient {analytic}");
    }
}

#[test]
fn overfits_to_below_a_millimetre() {
    let (_, setup, samples) = tiny();
    let samples: Vec<&Sample> = samples.iter().collect();
    let architecture = Architecture { embedding: 8, basis: 32, layers: 2, heads: 2, features: 16 };
    let model = initial(&setup, &samples, architecture, 1).unwrap();
    let settings = Settings { epochs: 1500, batch: 4, ..Settings::default() };
    let mut trainer = Trainer::new(model, &setup, &samples, settings).unwrap();
    let first = trainer.epoch(|_, _, _| {}).unwrap();
    let mut last = first;
    while trainer.epoch < settings.epochs {
        last = trainer.epoch(|_, _, _| {}).unwrap();
    }
    assert!(first.fine > 0.02, "starts at {first:?}");
    assert!(last.fine < 1e-3, "ends at {last:?}");
}
