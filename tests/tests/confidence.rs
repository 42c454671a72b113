//! Poses outside the range seen in training: the cloth goes over from the network's to the garment at rest, skinned,
//! without a jump.

use ctsn_core::cpu::{Cpu, Level};
use ctsn_core::model::{HostModel, Storage};
use ctsn_core::network::skin;
use ctsn_core::operation::Space;
use ctsn_core::pose::{BodyFrame, Range};
use ctsn_core::{Error, Predictor, Streams};
use ctsn_tests::finite::largest;
use ctsn_tests::golden;
use std::sync::Arc;
#[cfg(target_arch = "wasm32")]
use wasm_bindgen_test::{wasm_bindgen_test as test, wasm_bindgen_test_configure};

#[cfg(target_arch = "wasm32")]
wasm_bindgen_test_configure!(run_in_browser);

/// A golden model that has seen its golden poses, and these.
fn seen(golden: &golden::Golden) -> (HostModel, Vec<Vec<f32>>) {
    let (mut model, poses) = (golden.host_model(), golden.read().poses);
    let frames: Vec<BodyFrame> = poses.iter().map(|pose| frame(&model, pose)).collect();
    let rig = Arc::make_mut(&mut model.rig);
    rig.range = Range::of(&rig.inverse_bind, &frames);
    (model, poses)
}

fn frame(model: &HostModel, pose: &[f32]) -> BodyFrame {
    let mut frame = BodyFrame::new(model.sizes.joints);
    model.rig.body_frame(pose, &mut frame).expect("a pose");
    frame
}

/// `pose` with every joint but the root carried `metres` along x.
fn moved(model: &HostModel, pose: &[f32], metres: f32) -> Vec<f32> {
    let mut pose = pose.to_vec();
    let joints = pose.as_chunks_mut::<12>().0.iter_mut().enumerate();
    joints.filter(|(j, _)| *j != model.rig.root).for_each(|(_, joint)| joint[3] += metres);
    pose
}

#[test]
fn among_the_poses_seen_the_network_counts_in_full() {
    for golden in &golden::ALL {
        let (model, poses) = seen(golden);
        let mut plain = Predictor::from_model(golden.host_model(), Level::new());
        let mut predictor = Predictor::from_model(model, Level::new());
        for pose in &poses {
            plain.predict_row_major(pose, Streams::Both).expect("a golden pose");
            predictor.predict_row_major(pose, Streams::Both).expect("a golden pose");
            assert_eq!((predictor.confidence(), plain.confidence()), (1.0, 1.0));
            assert_eq!(predictor.positions(), plain.positions(), "{}", golden.name);
        }
    }
}

#[test]
fn far_from_them_the_garment_at_rest_is_skinned() {
    for golden in &golden::ALL {
        let (model, poses) = seen(golden);
        let mut predictor = Predictor::from_model(model.clone(), Level::new());
        for metres in [100.0, -1e4] {
            let wild = moved(&model, &poses[0], metres);
            predictor.predict_row_major(&wild, Streams::Both).expect("a finite prediction");
            assert_eq!(predictor.confidence(), 0.0);
            let (mut plain, transforms) = (vec![0.0; model.rest.len()], frame(&model, &wild).transforms);
            skin(&mut Cpu::new(), &model.rest, &model.skinning, &transforms, Space::World, &mut plain);
            let error = largest(predictor.positions(), &plain);
            assert!(error <= 1e-6 * metres.abs(), "{} {metres}: {error} m", golden.name);
        }
    }
}

#[test]
fn on_the_way_out_confidence_falls_steadily_and_nothing_jumps() {
    let (model, poses) = seen(&golden::ALL[1]);
    let mut predictor = Predictor::from_model(model.clone(), Level::new());
    let mut on_the_way = |step: i32| {
        predictor.predict_row_major(&moved(&model, &poses[0], 0.002 * step as f32), Streams::Both).expect("a pose");
        (predictor.confidence(), predictor.positions().to_vec())
    };
    let path: Vec<_> = (0..1000).map(&mut on_the_way).collect();
    assert_eq!((path[0].0, path[999].0), (1.0, 0.0));
    assert!(path.iter().filter(|(confidence, _)| (0.1..0.9).contains(confidence)).count() > 20, "a way, no step");
    for pair in path.windows(2) {
        assert!(pair[1].0 <= pair[0].0 && pair[0].0 - pair[1].0 < 0.05, "{} to {}", pair[0].0, pair[1].0);
        let step = largest(&pair[0].1, &pair[1].1);
        assert!(step < 0.015, "{step} m in a step of 2 mm");
    }
}

#[test]
fn a_range_is_written_and_read_and_one_that_is_none_is_refused() {
    let (mut model, _) = seen(&golden::ALL[0]);
    let read = HostModel::parse(&model.to_bytes(Storage::F16)).expect("a model");
    assert_eq!(read.rig.range, model.rig.range);
    if let Some(range) = &mut Arc::make_mut(&mut model.rig).range {
        range.min[7] = range.max[7] + 1.0;
    }
    let error = HostModel::parse(&model.to_bytes(Storage::F32)).expect_err("wanted a refusal");
    assert!(
        matches!(&error, Error::NotModel(text) if text.contains("pose.min") && text.contains("element 7")),
        "{error}"
    );
}
