//! Gradients against central differences; what the tape refuses; the loss falls.

mod coarse;
mod energy;
mod fit;
mod operation;
mod start;
mod unsimulated;
mod weights;

use super::*;
use crate::dataset::{Dataset, Description, Record};
use crate::loss::{LOSSES, Prediction, Term};
use ctsn_core::cpu::Cpu;
use ctsn_core::device::Device;
use ctsn_core::network::{Streams, skin as skinned};
use ctsn_core::operation::{Activation, Collide, Linear, Normals, Skin, Space};
use ctsn_core::pose::BodyFrame;
use ctsn_core::topology::Graph;
use tape::Id;

/// Relative disagreement allowed between a gradient and a central difference: both are f32, steps of 1e-3 at values of
/// order one leave about 1e-3 of rounding; ReLU kinks within a step add as much again.
const TOLERANCE: f64 = 1e-2;
const STEP: f32 = 1e-3;

fn random(rng: &mut fastrand::Rng, length: usize) -> Vec<f32> {
    (0..length).map(|_| rng.f32() * 2.0 - 1.0).collect()
}

fn product(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
}

/// What the tape says to a loss behind what `build` makes of positions that learn [5, 3]; and that it says nothing
/// where nothing learns.
fn refusal(build: impl Fn(&mut Tape, &Id, &mut Id)) -> String {
    let lane = |learns: bool| {
        let mut tape = Tape::default();
        let positions = tape.buffer(&[0.5; 15]);
        let learning: Vec<&Id> = learns.then_some(&positions).into_iter().collect();
        let shared = tape.seal(&learning);
        let mut output = tape.buffer(&[0.0; 15]);
        build(&mut tape, &positions, &mut output);
        tape.lane(&shared, &[output]).map(drop)
    };
    lane(false).expect("where nothing learns, a loss has nothing to teach");
    lane(true).expect_err("a gradient of zero").to_string()
}

#[test]
fn a_loss_behind_what_has_no_gradient_is_refused() {
    let normals = |tape: &mut Tape, positions: &Id, normals: &mut Id| {
        let triangles = &tape.indices(&[0, 1, 2, 1, 3, 2]);
        tape.run(Normals { positions, triangles, normals }.into());
    };
    assert!(refusal(normals).contains("Normals"));
    let collide = |tape: &mut Tape, positions: &Id, push: &mut Id| {
        let (posed, normals) = (&tape.buffer(&[0.0; 9]), &tape.buffer(&[0.0; 9]));
        let [offsets, corners, seeds] = &[&[0, 2, 4, 6][..], &[1, 2, 2, 0, 0, 1], &[0; 5]].map(|it| tape.indices(it));
        tape.run(Collide { reach: 0.002, posed, normals, offsets, corners, seeds, positions, push }.into());
    };
    assert!(refusal(collide).contains("Collide"));
    let skin_to = |tape: &mut Tape, rest: &Id, space: Space, positions: &mut Id| {
        let (joints, weights, transforms) = (&tape.indices(&[0; 5]), &tape.buffer(&[1.0; 5]), &tape.buffer(&[0.0; 24]));
        tape.run(Skin { rest, joints, weights, transforms, space, positions }.into());
    };
    assert!(refusal(|tape, rest, positions| skin_to(tape, rest, Space::World, positions)).contains("Skin"));
    // And behind any operation after it.
    let after = |tape: &mut Tape, positions: &Id, output: &mut Id| {
        let mut between = tape.buffer(&[0.0; 15]);
        normals(tape, positions, &mut between);
        skin_to(tape, &between, Space::Body, output);
    };
    assert!(refusal(after).contains("Normals"));
}

/// A golden model with a made-up truth: plain skinning, every vertex moved by up to 5 cm along each axis, differently
/// in each pose.
fn tiny() -> (HostModel, Setup, Vec<Sample>) {
    let model = HostModel::parse(include_bytes!("../../../../../tests/golden/tiny.safetensors")).unwrap();
    let golden = include_bytes!("../../../../../tests/golden/tiny.golden.safetensors");
    let golden = ctsn_core::file::Tensors::parse(golden).unwrap();
    let poses = golden.tensors["pose.joints"].to_f32().unwrap();
    let mut rng = fastrand::Rng::with_seed(11);
    let sample = |(frame, joints): (usize, &[f32])| {
        let (skin, mut body) = (&model.reference.skinning, BodyFrame::new(model.sizes.joints));
        model.rig.body_frame(joints, &mut body).unwrap();
        let mut truth = vec![0.0; model.rest.len()];
        let transforms = &body.transforms;
        skinned(&mut Cpu::new(), &model.rest, skin, transforms, Space::Body, &mut truth);
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
        drawn: None,
        body: model.reference.rest.clone(),
        body_triangles: Vec::new(),
        body_weights: vec![vec![(0, 0.5), (1, 0.3), (2, 0.2)]; model.sizes.vertices],
    };
    (model, setup, samples)
}

/// Losses by name, whatever else is in the list.
fn named(names: &[&str]) -> Vec<Term> {
    names.iter().map(|name| *LOSSES.iter().find(|term| term.name == *name).unwrap()).collect()
}

/// Both losses of distance of one sample and their gradients, as training takes them.
#[test]
fn whole_network() {
    let (model, setup, samples) = tiny();
    let distances = named(&["coarse", "fine"]);
    let mut trainer = Trainer::with(model, None, &distances, &setup, &[&samples[0]], Settings::default()).unwrap();
    let mut rng = fastrand::Rng::with_seed(13);
    let Trainer { recording, workers, items, parameters, .. } = &mut trainer;
    let Worker { lane, losses, .. } = &mut workers[0];
    items[0].learn(recording, &parameters.shared, lane, losses, 1);
    let targets = &items[0].targets;
    // The coarse loss alone for what only the skeleton stream trains, the sum for the skin weights, the fine loss for
    // the rest: the fine loss does not reach the skeleton stream, by design.
    let is_skeleton = |name: &str| name == ctsn_core::model::SKELETON_BASIS || name.starts_with("embedding.");
    let names: Vec<String> = parameters.each().map(|(name, _)| name.to_owned()).collect();
    assert_eq!(names.iter().filter(|name| is_skeleton(name)).count(), 1 + 2 * 2);
    for (name, id) in names.iter().zip(parameters.ids()) {
        let shared = &mut parameters.shared;
        let gradient = lane.gradient_mut(id).clone();
        let norm = product(&gradient, &gradient).sqrt();
        assert!(norm > 0.0, "{name} gets no gradient");
        let noise = random(&mut rng, gradient.len());
        let length = product(&noise, &noise).sqrt();
        let mix = |(g, noise): (&f32, &f32)| g / norm as f32 + noise / length as f32;
        let direction: Vec<f32> = gradient.iter().zip(&noise).map(mix).collect();
        let start = shared.get(id).to_vec();
        let mut at = |step: f32| {
            let moved = start.iter().zip(&direction).map(|(x, d)| x + step * d);
            shared.get_mut(id).iter_mut().zip(moved).for_each(|(x, moved)| *x = moved);
            recording.tape.forward(shared, lane);
            let mut loss = |name: &str, prediction: Prediction| {
                let (i, _, loss) = losses.each().find(|(_, term, _)| term.name == name).unwrap();
                let predicted = lane.value(shared, recording.prediction(prediction));
                f64::from(loss.value(predicted, &targets[i], 1.0, &mut vec![0.0; predicted.len()]))
            };
            let [coarse, fine] = [("coarse", Prediction::Coarse), ("fine", Prediction::Whole)].map(|(a, b)| loss(a, b));
            coarse + if is_skeleton(name) { 0.0 } else { fine }
        };
        let analytic = product(&gradient, &direction);
        // Rounding spoils short steps, ReLU kinks long ones; which of the two suits depends on the parameter.
        let differences = [2e-3, 5e-4].map(|step: f32| (at(step) - at(-step)) / f64::from(2.0 * step));
        at(0.0);
        let close = differences.iter().any(|difference| (difference - analytic).abs() <= TOLERANCE * analytic.abs());
        assert!(close, "{name}: differences {differences:?}, gradient {analytic}");
    }
}

/// Trains as long as `settings` say, once in one go, once interrupted, once by three threads and interrupted: the same
/// bytes. `start` makes the trainer anew; a checkpoint of it is left at `path`.
fn assert_same_after_interruption(
    start: impl Fn() -> Trainer + Sync,
    samples: &[&Sample],
    settings: Settings,
    path: &std::path::Path,
) {
    let train = |threads: usize, stop: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut trainer = start();
            (0..stop).for_each(|_| _ = trainer.round(samples).unwrap());
            trainer.save(path).unwrap();
            let mut resumed = start();
            resumed.resume(path).unwrap();
            (stop..settings.epochs()).for_each(|_| _ = resumed.round(samples).unwrap());
            resumed.model().to_bytes(Storage::F32)
        })
    };
    let whole = train(1, settings.epochs());
    assert!(whole == train(1, 2), "interrupted");
    assert!(whole == train(3, 1), "by three threads");
}

/// Trains for an epoch; the mean loss of the whole prediction, metres.
fn fine(trainer: &mut Trainer) -> f32 {
    let losses = trainer.epoch(|_, _, _| {}).unwrap();
    losses[trainer.terms.iter().position(|term| term.name == "fine").unwrap()]
}

#[test]
fn overfits_to_below_a_millimetre() {
    let (_, setup, samples) = tiny();
    let samples: Vec<&Sample> = samples.iter().collect();
    let architecture = Architecture { embedding: 8, basis: 32, layers: 2, heads: 2, features: 16 };
    let model = initial(&setup, &samples, architecture, 1).unwrap();
    let settings = Settings { epochs: Some(2500), batch: 4, ..Settings::default() };
    let distances = named(&["coarse", "fine"]);
    let mut trainer = Trainer::with(model, None, &distances, &setup, &samples, settings).unwrap();
    let first = fine(&mut trainer);
    let mut last = first;
    while trainer.epoch < settings.epochs() {
        last = fine(&mut trainer);
    }
    assert!(first > 0.02, "starts at {first} m");
    assert!(last < 1e-3, "ends at {last} m");
}
