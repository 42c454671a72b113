//! A clip played forwards, backwards and at random gives the same cloth for the same pose, on CPU and GPU, and they
//! agree: the repair of penetration has no memory.
#![cfg(feature = "machine")]

use ctsn_core::cpu::Level;
use ctsn_core::model::HostModel;
use ctsn_core::{Predictor, Streams};
use ctsn_rig as rig;
use ctsn_rig::path::between;
use ctsn_tests::finite::largest;
use ctsn_train::{body, synthetic, training as train};
use fastrand::Rng;
use pollster::block_on;

/// Largest difference allowed, metres.
const TOLERANCE: f32 = 1e-4;
/// Frames of the clip from each of its key poses to the next.
const STEPS: usize = 8;

/// A tube of cloth on a chain of joints that it cuts into, and a clip of it: poses [J, 3, 4].
fn model_and_clip() -> (HostModel, Vec<Vec<f32>>) {
    let (setup, samples) = synthetic::dataset(600, 6, 12);
    let samples: Vec<_> = samples.iter().collect();
    let architecture = train::Architecture { embedding: 3, basis: 3, layers: 1, heads: 1, features: 4 };
    let mut model = train::initial(&setup, &samples, architecture, 1).expect("a model");
    model.body = Some(body::body(&setup, &samples, &[]).expect("a body"));
    // As thick as the body under it: about half of the cloth is inside.
    for vertex in model.rest.as_chunks_mut::<3>().0 {
        (vertex[0], vertex[2]) = (0.9 * vertex[0], 0.9 * vertex[2]);
    }
    let character = setup.character().expect("a character");
    let keys: Vec<_> = samples.iter().map(|sample| rig::pose(&sample.joints)).collect();
    let part = |pair: &[rig::Pose], step: usize| {
        rig::joints(&between(&character, &pair[0], &pair[1], step as f64 / STEPS as f64))
    };
    let clip = keys.windows(2).flat_map(|pair| (0..STEPS).map(move |step| part(pair, step))).collect();
    (model, clip)
}

/// Plays the clip forwards, backwards and at random; the positions of every frame, the same each time.
fn play(clip: &[Vec<f32>], mut predict: impl FnMut(&[f32]) -> Vec<f32>) -> Vec<Vec<f32>> {
    let forwards: Vec<Vec<f32>> = clip.iter().map(|pose| predict(pose)).collect();
    let mut order: Vec<usize> = (0..clip.len()).collect();
    Rng::with_seed(3).shuffle(&mut order);
    for frame in (0..clip.len()).rev().chain(order) {
        let error = largest(&predict(&clip[frame]), &forwards[frame]);
        assert!(error <= TOLERANCE, "frame {frame}: {error} m from what it was forwards");
    }
    forwards
}

#[test]
fn a_clip_is_the_same_in_any_order_and_on_both_devices() {
    let (model, clip) = model_and_clip();
    let cpu = |model: HostModel| {
        let mut predictor = Predictor::from_model(model, Level::new());
        move |pose: &[f32]| {
            predictor.predict_row_major(pose, Streams::Both).expect("a pose");
            predictor.positions().to_vec()
        }
    };
    let on_cpu = play(&clip, cpu(model.clone()));
    let bare = play(&clip, cpu(HostModel { body: None, ..model.clone() }));
    let repaired = on_cpu.iter().zip(&bare).filter(|(with, without)| largest(with, without) > 1e-3).count();
    assert_eq!(repaired, clip.len(), "frames in which anything was repaired");

    let gpu = block_on(ctsn_gpu::Gpu::new()).expect("a Vulkan adapter (Debian: mesa-vulkan-drivers)");
    let on_gpu = block_on(ctsn_gpu::Model::new(&gpu, &model)).expect("a model");
    let mut predictor = block_on(ctsn_gpu::Predictor::new(&on_gpu)).expect("a predictor");
    let on_gpu = play(&clip, |pose| {
        predictor.predict_row_major(pose, Streams::Both).expect("a pose");
        block_on(predictor.read()).expect("a prediction").positions
    });
    for (frame, (on_gpu, on_cpu)) in on_gpu.iter().zip(&on_cpu).enumerate() {
        let error = largest(on_gpu, on_cpu);
        assert!(error <= TOLERANCE, "frame {frame}: the devices are {error} m apart");
    }
}
