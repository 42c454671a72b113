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

struct Smooth(Smoother);

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_gradient_is_that_of_central_differences() {
        let mut rng = fastrand::Rng::with_seed(5);
        // A strip of 12 triangles, which has a hem.
        let triangles: Vec<u32> = (0..12).flat_map(|i| [i, i + 1 + i % 2, i + 2 - i % 2]).collect();
        let mut loss = Smooth(Smoother::new(14, &triangles));
        let [predicted, truth, direction] =
            [0; 3].map(|_| (0..42).map(|_| rng.f32() * 2.0 - 1.0).collect::<Vec<f32>>());
        let target = loss.target(&truth);
        let mut g = vec![0.0; 42];
        loss.value(&predicted, &target, 1.0, &mut g);
        let mut at = |step: f32| {
            let moved: Vec<f32> = predicted.iter().zip(&direction).map(|(x, d)| x + step * d).collect();
            f64::from(loss.value(&moved, &target, 1.0, &mut [0.0; 42]))
        };
        let difference = (at(1e-3) - at(-1e-3)) / 2e-3;
        let analytic: f64 = g.iter().zip(&direction).map(|(g, d)| f64::from(g * d)).sum();
        assert!((difference - analytic).abs() <= 1e-2 * difference.abs(), "{difference} against {analytic}");
    }
}
