//! Errors of one way to predict, gathered over frames. Units of the network: metres, degrees, seconds.

use super::folds::FoldErrors;
use super::judge::PoseErrors;
use ctsn_rig::statistics::Sorted;
use serde::{Deserialize, Serialize};

/// A figure over frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Statistic {
    /// Mean over frames.
    pub mean: f64,
    /// Standard deviation over frames.
    pub std: f64,
    /// 95 % of the frames lie at or below.
    pub p95: f64,
}

/// Errors of one way to predict.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// E_dist, metres: the mean over vertices of `‖x_p - x_g‖`, over frames.
    pub distance: Statistic,
    /// E_norm, degrees: the mean over vertices of the angle between vertex normals, over frames.
    pub normal: Statistic,
    /// Mean E_dist in millimetres per metre of the figure, to compare characters of different size.
    pub scaled: f64,
    /// Share of vertices inside the body, mean over frames. As in the simulator, a vertex more than 50 mm behind a face
    /// is taken to lie beyond the far side of another part: skinned bodies pass into themselves.
    pub penetrating: f64,
    /// Greatest depth inside the body in any frame, metres.
    pub depth: f64,
    /// Share of the cloth's edges that pass through a face of the body, mean over frames.
    pub crossing: f64,
    /// Share of the frames in which a limb has come out through the cloth; zero in what was written before it was
    /// looked at.
    #[serde(default)]
    pub out: f64,
    /// Mean over edges and frames of `|l_p - l_g| / l_rest`: predicted, true and rest length of an edge.
    pub stretch: f64,
    /// Mean acceleration of vertices, m/s²: see [`super::jitter`]; `None` where no three frames follow each other.
    pub jitter: Option<f64>,
    /// The same in slow motion between the judged poses, see [`super::slow`]; `None` where it was not predicted.
    pub slow_jitter: Option<f64>,
    /// Folds; zeros in what was written before they were measured.
    #[serde(default)]
    pub folds: FoldErrors,
}

impl Statistic {
    /// Over `values`; zero of none.
    pub fn over(values: impl Iterator<Item = f64>) -> Self {
        let values = Sorted::new(values);
        let mean = values.mean();
        let squares = values.values().iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        let variance = squares / values.values().len().max(1) as f64;
        Self { mean, std: variance.sqrt(), p95: values.percentile(95) }
    }
}

impl Errors {
    /// The errors over `frames`, on a figure of `size` metres.
    pub(super) fn over(frames: &[PoseErrors], jitter: Option<f64>, size: f64) -> Self {
        let over = |part: fn(&PoseErrors) -> f64| Statistic::over(frames.iter().map(part));
        let distance = over(|frame| frame.distance);
        Self {
            distance,
            normal: over(|frame| frame.normal),
            scaled: 1e3 * distance.mean / size,
            penetrating: over(|frame| frame.penetrating).mean,
            depth: frames.iter().map(|frame| frame.depth).fold(0.0, f64::max),
            crossing: over(|frame| frame.crossing).mean,
            out: over(|frame| f64::from(u8::from(frame.out))).mean,
            stretch: over(|frame| frame.stretch).mean,
            jitter,
            slow_jitter: None,
            folds: FoldErrors::default(),
        }
    }
}
