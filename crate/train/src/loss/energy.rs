//! The energy of the predicted cloth by the simulator's own elements: it needs no truth (PBNS, SNUG and Neural Cloth
//! Simulation train so). Where there is truth it brought nothing beside the distances: docs/decisions/training.md.

use super::{Loss, Prediction, Term};
use ctsn_cloth::simulate::Elastic;
use ctsn_rig::{numbers, vertices};
use glam::DVec3;

/// Stretch, shear, bending and height; of unsimulated poses that the skeleton stream predicts as well.
pub(super) const ENERGY: Term = Term {
    name: "energy",
    title: "energy of the cloth",
    unit: "J",
    weight: 1.0,
    constants: &[],
    simulated: &[Prediction::Coarse, Prediction::Whole],
    unsimulated: &[Prediction::Coarse],
    new: |scene| Ok(Some(Box::new(Energy(scene.setup.elastic()?)))),
};

struct Energy(Elastic);

impl Loss for Energy {
    /// Joules; negative where the cloth hangs below the origin of the body frame.
    fn value(&mut self, predicted: &[f32], _: &[f32], scale: f32, gradient: &mut [f32]) -> f32 {
        let x = vertices(predicted);
        let mut forces = vec![DVec3::ZERO; x.len()];
        let energy = self.0.stretch(&x, &mut forces) + self.0.bend(&x, &mut forces) + self.0.weigh(&x, &mut forces);
        gradient.iter_mut().zip(numbers(&forces)).for_each(|(gradient, force)| *gradient += scale * force);
        energy as f32
    }
}
