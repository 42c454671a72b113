//! A prediction is finite, or it is refused.

use crate::golden;
use ctsn_core::file::Tensors;
use ctsn_core::{Predictor, Streams};

const STREAMS: [Streams; 3] = [Streams::Both, Streams::Skeleton, Streams::None];

/// The first golden pose [J, 3, 4], repeated or cut to `joints`.
pub fn pose(joints: usize) -> Vec<f32> {
    let file = Tensors::parse(golden::ALL[0].expected).expect("golden file");
    let all = file.tensors["pose.joints"].to_f32().expect("poses");
    all[..36].iter().copied().cycle().take(12 * joints).collect()
}

/// Predicts with every stream: finite everywhere, or refused as not finite. Whether all of it was finite.
pub fn predict(predictor: &mut Predictor, pose: &[f32]) -> bool {
    let one = |streams| match predictor.predict_row_major(pose, streams) {
        Ok(()) => {
            let shown = predictor.shown_positions().iter().chain(predictor.shown_normals());
            let mut results = predictor.positions().iter().chain(predictor.normals()).chain(shown);
            assert!(results.all(|value| value.is_finite()), "{streams:?}: a prediction that is not finite");
            true
        }
        Err(error) => {
            assert_eq!(error.kind(), "not_finite", "{streams:?}: {error}");
            false
        }
    };
    STREAMS.map(one) == [true; 3]
}

/// The largest difference of two results; a NaN wins.
pub fn largest(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    let wider = |largest: f32, d: f32| if d > largest || d.is_nan() { d } else { largest };
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, wider)
}
