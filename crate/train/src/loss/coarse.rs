//! The skeleton stream against the truth smoothed by the Laplacian. network.md §6, paper § Two-stream.

use super::distance::distance;
use super::{Loss, Prediction, Scene, Term};
use crate::smoother::Smoother;

/// Where one stream is left out, the other learns the truth itself.
pub(super) const COARSE: Term = Term {
    name: "coarse",
    title: "skeleton stream against the smoothed truth",
    unit: "m",
    weight: 1.0,
    constants: &[STEPS as f32],
    simulated: &[Prediction::Coarse],
    unsimulated: &[],
    new: |Scene { setup, variant, .. }| {
        let smoother = || Smoother::new(setup.template.len() / 3, &setup.triangles);
        Ok((variant.skeleton && variant.mesh).then(|| Box::new(Coarse { smoother: smoother() }) as Box<dyn Loss>))
    },
};

struct Coarse {
    smoother: Smoother,
}

impl Loss for Coarse {
    fn target(&self, truth: &[f32]) -> Vec<f32> {
        self.smoother.smooth(truth, STEPS)
    }

    fn value(&mut self, predicted: &[f32], smooth: &[f32], scale: f32, gradient: &mut [f32]) -> f32 {
        distance(predicted, smooth, scale, gradient)
    }
}

/// Steps of smoothing: waves shorter than about 3 edges lose 90 %. The paper names no number. With 10 (6 edges), the
/// mesh stream had to make anew what the skeleton stream tells well: on validation poses a skirt had 9.8 mm, 9.0° (now
/// 9.5 mm, 8.7°), a T-shirt 8.1 mm, 11.0° (now 8.3 mm, 10.4°; 15 epochs), a robe 12.3 mm, 12.7° (now 12.0 mm, 11.6°).
/// Of a cape so little is left that the mesh stream died.
const STEPS: usize = 2;
