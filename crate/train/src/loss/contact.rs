//! The energy of springs that push cloth out of the body, for a training without truth: what carries the cloth's weight
//! and tension there.

use super::penetration::Penetration;
use super::{Loss, Prediction, Term};
use ctsn_core::pose::BodyFrame;

/// Stiffness of the spring at a vertex, N/m. The tension of an edge stretched by a hundredth, a quarter of a newton,
/// presses cloth half a millimetre into the gap around the body.
const STIFFNESS: f32 = 500.0;

pub(super) const CONTACT: Term = Term {
    name: "contact",
    title: "contact with the body",
    unit: "J",
    weight: 1.0,
    constants: &[STIFFNESS],
    simulated: &[Prediction::Coarse, Prediction::Whole],
    unsimulated: &[Prediction::Coarse],
    new: |scene| Ok(Penetration::of(scene.model).map(|body| Box::new(Contact(body)) as Box<dyn Loss>)),
};

struct Contact(Penetration);

impl Loss for Contact {
    fn pose(&mut self, body_frame: &BodyFrame) {
        self.0.pose(body_frame);
    }

    /// `Σ ½ k d²` of what the vertices lack to the gap around the body, joules.
    fn value(&mut self, predicted: &[f32], _: &[f32], scale: f32, gradient: &mut [f32]) -> f32 {
        let lacks = self.0.lacks(predicted);
        gradient.iter_mut().zip(lacks).for_each(|(gradient, lacks)| *gradient -= scale * STIFFNESS * lacks);
        0.5 * STIFFNESS * lacks.iter().map(|lacks| lacks * lacks).sum::<f32>()
    }
}

#[cfg(test)]
mod tests {
    use super::super::penetration::tests::ball;
    use super::*;

    #[test]
    fn the_springs_push_with_what_pressing_them_costs() {
        let (body, at) = ball();
        let mut contact = Contact(body);
        let mut press = |radius: f32| {
            let mut g = vec![0.0; at(1.0).len()];
            (contact.value(&at(radius), &[], 1.0, &mut g), g)
        };
        assert_eq!(press(1.01).0, 0.0, "outside, nothing pushes");
        let ((before, _), (_, g), (after, _)) = (press(0.951), press(0.95), press(0.949));
        let slope: f32 = g.iter().zip(at(0.949).iter().zip(at(0.951))).map(|(g, (b, a))| g * (b - a)).sum();
        // Corners are lifted along their own normals, as in the loss of penetration.
        let share = (after - before) / slope;
        assert!(after > before && (0.7..1.01).contains(&share), "{before} J, {after} J, by its gradient {slope}");
    }
}
