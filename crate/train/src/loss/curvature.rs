//! How the whole prediction bends against how the truth does: the umbrella Laplacian of both. Cloth that is a
//! millimetre off at every second vertex is near, and puckered. What it brings: docs/decisions/training.md.

use super::distance::distance;
use super::{Loss, Prediction, Scene, Term};
use crate::smoother::Smoother;

pub(super) const CURVATURE: Term = Term {
    name: "curvature",
    title: "curvature, poses learned from",
    unit: "m",
    weight: 2.0,
    constants: &[],
    simulated: &[Prediction::Whole],
    unsimulated: &[],
    new: |Scene { setup, .. }| Ok(Some(Box::new(Curvature(Smoother::new(setup.template.len() / 3, &setup.triangles))))),
};

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
