//! The prediction without its folds against the truth without its own: where the cloth is, not how it buckles.

use super::distance::distance;
use super::{Loss, Prediction, Scene, Term};
use crate::smoother::Smoother;

/// A metre beside joules: a newton for every metre, shared by the vertices. Their own weight is a hundredth of that.
pub(super) const SMOOTH: Term = Term {
    name: "smooth",
    title: "smoothed prediction against smoothed truth",
    unit: "m",
    weight: 100.0,
    constants: &[STEPS as f32],
    simulated: &[Prediction::Coarse, Prediction::Whole],
    unsimulated: &[],
    new: |Scene { setup, .. }| Ok(Some(Box::new(Smooth(Smoother::new(setup.template.len() / 3, &setup.triangles))))),
};

/// Steps of smoothing: waves shorter than about 6 edges lose 90 %.
const STEPS: usize = 10;

pub(super) struct Smooth(pub Smoother);

impl Loss for Smooth {
    fn target(&self, truth: &[f32]) -> Vec<f32> {
        self.0.smooth(truth, STEPS)
    }

    fn value(&mut self, predicted: &[f32], smooth: &[f32], scale: f32, gradient: &mut [f32]) -> f32 {
        let mut towards = vec![0.0; gradient.len()];
        let value = distance(&self.0.smooth(predicted, STEPS), smooth, scale, &mut towards);
        let spread = self.0.spread(&towards, STEPS);
        gradient.iter_mut().zip(spread).for_each(|(gradient, spread)| *gradient += spread);
        value
    }
}
