//! Gradients of the losses against central differences.

use super::curvature::Curvature;
use super::fine::Fine;
use super::smooth::Smooth;
use super::*;
use crate::smoother::Smoother;

/// A strip of 12 triangles, which has a hem.
fn strip() -> Smoother {
    let triangles: Vec<u32> = (0..12).flat_map(|i| [i, i + 1 + i % 2, i + 2 - i % 2]).collect();
    Smoother::new(14, &triangles)
}

#[test]
fn gradients_are_those_of_central_differences() {
    let losses: [(&str, Box<dyn Loss>); 3] =
        [("fine", Box::new(Fine)), ("smooth", Box::new(Smooth(strip()))), ("curvature", Box::new(Curvature(strip())))];
    for (name, mut loss) in losses {
        let mut rng = fastrand::Rng::with_seed(5);
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
        let wrong = (difference - analytic).abs();
        assert!(wrong <= 1e-2 * difference.abs(), "{name}: {difference} against {analytic}");
    }
}
