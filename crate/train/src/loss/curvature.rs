//! How the whole prediction bends against how the truth does: the umbrella Laplacian of both. Cloth that is a
//! millimetre off at every second vertex is near, and puckered. What it brings: docs/decisions/training.md.

use super::distance::distance;
use super::{Loss, Prediction, Scene, Term};
use crate::smoother::Smoother;

/// Power of the bending ratio by which an epoch changes the emphasis, and the greatest emphasis.
const GAIN: i32 = 2;
const MOST: f32 = 4.0;

pub(crate) const CURVATURE: Term = Term {
    name: "curvature",
    title: "curvature, poses learned from",
    unit: "m",
    weight: 2.0,
    constants: &[GAIN as f32, MOST],
    simulated: &[Prediction::Whole],
    unsimulated: &[],
    new: |Scene { setup, .. }| Ok(Some(Box::new(Curvature(Smoother::new(setup.template.len() / 3, &setup.triangles))))),
};

/// How much more than its weight curvature counts, after epochs that watched such bending ratios: more and more while
/// predictions bend more than the truth, and never less than its weight. What it brings: docs/decisions/training.md.
pub(crate) fn emphasis(bending: impl Iterator<Item = f32>) -> f32 {
    bending.fold(1.0, |emphasis, bending| (emphasis * bending.powi(GAIN)).clamp(1.0, MOST))
}

pub(super) struct Curvature(pub Smoother);

impl Loss for Curvature {
    /// What one step of smoothing takes away: half of the umbrella Laplacian.
    fn target(&self, truth: &[f32]) -> Vec<f32> {
        let smooth = self.0.smooth(truth, 1);
        truth.iter().zip(smooth).map(|(x, smooth)| x - smooth).collect()
    }

    fn value(&mut self, predicted: &[f32], curved: &[f32], scale: f32, gradient: &mut [f32]) -> f32 {
        let mut ours = vec![0.0; predicted.len()];
        let value = distance(&self.target(predicted), curved, scale, &mut ours);
        let smooth = self.0.spread(&ours, 1);
        gradient
            .iter_mut()
            .zip(ours.iter().zip(smooth))
            .for_each(|(gradient, (ours, smooth))| *gradient += ours - smooth);
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crumpled_predictions_make_curvature_count_more_and_smooth_ones_never_less() {
        let after = |bending: &[f32]| emphasis(bending.iter().copied());
        assert_eq!([after(&[]), after(&[0.5, 0.9]), after(&[1.5])], [1.0, 1.0, 2.25]);
        assert_eq!([after(&[3.0; 9]), after(&[3.0, 0.75])], [MOST, 2.25]);
        // Not a debt: what was smooth for long counts more as soon as it crumples.
        assert_eq!(after(&[0.2, 0.2, 1.5]), 2.25);
    }
}
