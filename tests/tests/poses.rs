//! Poses that are none, and extreme ones: refused or finite; none panics, none yields NaN.

use ctsn_core::{Error, Predictor, Streams};
use ctsn_tests::finite::{pose, predict};
use ctsn_tests::golden;
#[cfg(target_arch = "wasm32")]
use wasm_bindgen_test::{wasm_bindgen_test as test, wasm_bindgen_test_configure};

#[cfg(target_arch = "wasm32")]
wasm_bindgen_test_configure!(run_in_browser);

#[test]
fn poses_that_are_none_are_refused() {
    let mut predictor = Predictor::new(golden::ALL[0].model).expect("golden model");
    let whole = pose(3);
    predictor.predict_row_major(&whole, Streams::Both).expect("a golden pose");
    let before = predictor.positions().to_vec();
    for length in [0, 12, 35, 37, 47, 49] {
        let error = predictor.predict_row_major(&vec![0.0; length], Streams::Both).expect_err("wanted a refusal");
        assert_eq!(error, Error::JointCount { wanted: 36, joints: 3, found: length });
        let error = predictor.predict(&vec![0.0; length], Streams::Both).expect_err("wanted a refusal");
        assert_eq!(error, Error::JointCount { wanted: 48, joints: 3, found: length });
    }
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut pose = whole.clone();
        pose[17] = value;
        let error = predictor.predict_row_major(&pose, Streams::Both).expect_err("wanted a refusal").to_string();
        assert!(error.contains("pose") && error.contains("element 17"), "{error}");
    }
    assert_eq!(predictor.positions(), before, "a refused pose leaves the last prediction");
}

#[test]
fn extreme_poses_are_finite_or_refused() {
    for golden in &golden::ALL[..2] {
        let mut predictor = Predictor::new(golden.model).expect("golden model");
        let joints = predictor.sizes().joints;
        let plain = pose(joints);
        let scaled = |factor: f32| plain.iter().map(|value| value * factor).collect::<Vec<f32>>();
        for factor in [0.0, 1e-30, 1e-6, 1e6, -1e6] {
            assert!(predict(&mut predictor, &scaled(factor)), "{}: a pose times {factor:e}", golden.name);
        }
        // Triangles whose normals f32 cannot hold: the normals stay unit vectors.
        for factor in [1e12, 1e20] {
            predictor.predict_row_major(&scaled(factor), Streams::None).expect("a finite prediction");
            for normal in predictor.normals().chunks_exact(3) {
                let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
                assert!((0.999..1.001).contains(&length), "{}: a normal {length} long", golden.name);
            }
        }
        assert!(!predict(&mut predictor, &vec![f32::MAX; 12 * joints]), "what overflows is refused");
        assert!(predict(&mut predictor, &plain), "and the model lives on");
    }
}
