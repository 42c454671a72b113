//! Quality that changes without a jump: shares of the residuals, and a mesh stream that is computed now and then.

use ctsn_core::cpu::Level;
use ctsn_core::{Folds, Predictor, Shares, Streams};
use ctsn_tests::finite::largest;
use ctsn_tests::golden;
use ctsn_tests::random::column_major;
#[cfg(target_arch = "wasm32")]
use wasm_bindgen_test::{wasm_bindgen_test as test, wasm_bindgen_test_configure};

#[cfg(target_arch = "wasm32")]
wasm_bindgen_test_configure!(run_in_browser);

/// Metres: sums of the same numbers in another order.
const SAME: f32 = 1e-6;

/// A golden model and its poses.
fn scene() -> (Predictor, Vec<Vec<f32>>) {
    let small = &golden::ALL[1];
    let poses = small.read().poses.iter().map(|pose| column_major(pose)).collect();
    (Predictor::from_model(small.host_model(), Level::new()), poses)
}

fn predict(predictor: &mut Predictor, pose: &[f32], streams: Streams, shares: Shares) -> Vec<f32> {
    predictor.predict_faded(pose, streams, shares).expect("a golden pose");
    predictor.positions().to_vec()
}

/// The middle of two predictions of one pose.
fn middle(a: &[f32], b: &[f32]) -> Vec<f32> {
    a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect()
}

#[test]
fn shares_lead_from_one_quality_to_the_next() {
    let (mut predictor, poses) = scene();
    let share = |skeleton: f32, mesh: f32| Shares { skeleton, mesh };
    for pose in &poses {
        let mut of = |streams, shares| predict(&mut predictor, pose, streams, shares);
        let full = of(Streams::Both, Shares::ALL);
        let (coarse, plain) = (of(Streams::Skeleton, Shares::ALL), of(Streams::None, Shares::ALL));
        assert!(largest(&full, &coarse) > 1e-3 && largest(&coarse, &plain) > 1e-3, "three qualities");
        assert!(largest(&of(Streams::Both, share(1.0, 0.0)), &coarse) <= SAME);
        assert!(largest(&of(Streams::Skeleton, share(0.0, 0.0)), &plain) <= SAME);
        assert!(largest(&of(Streams::Both, share(1.0, 0.5)), &middle(&full, &coarse)) <= SAME);
        assert!(largest(&of(Streams::Skeleton, share(0.5, 0.0)), &middle(&coarse, &plain)) <= SAME);
        assert!(largest(&of(Streams::Both, share(0.5, 1.0)), &middle(&full, &plain)) <= SAME);
    }
}

#[test]
fn folds_computed_now_and_then_go_from_one_aim_to_the_next() {
    let (mut predictor, poses) = scene();
    let mut folds = Folds::new(predictor.sizes().vertices);
    let [first, second] = [&poses[0], &poses[1]];
    let mut show = |predictor: &mut Predictor, pose: &[f32], aim: bool, step: f32| {
        predictor.predict_folds(pose, &mut folds, (aim, step), Shares::ALL).expect("a golden pose");
        predictor.positions().to_vec()
    };
    // In every frame: the whole network.
    for pose in &poses {
        let whole = predict(&mut predictor, pose, Streams::Both, Shares::ALL);
        assert!(largest(&show(&mut predictor, pose, true, 1.0), &whole) <= SAME);
    }
    // In every second one: at first half way from the folds of the pose before, then there, then they stay.
    show(&mut predictor, first, true, 1.0);
    let old = show(&mut predictor, second, false, 1.0);
    let whole = predict(&mut predictor, second, Streams::Both, Shares::ALL);
    assert!(largest(&old, &whole) > 1e-3, "the folds of another pose");
    assert!(largest(&show(&mut predictor, second, true, 0.5), &middle(&old, &whole)) <= SAME);
    assert!(largest(&show(&mut predictor, second, false, 0.5), &whole) <= SAME);
    assert!(largest(&show(&mut predictor, second, false, 0.5), &whole) <= SAME);
}
