//! The energy of the predicted cloth by the simulator's own elements: it needs no truth (PBNS, SNUG and Neural Cloth
//! Simulation train so). What it brings where there is truth: docs/decisions/training.md.

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

/// Beside distances, of what the polish makes: without it a network that learns through the polish leaves it more
/// tension than it can take out. On 126 unseen frames of a T-shirt: energy 1.27 and strain 1.75 times the simulation's
/// in place of 1.46 and 1.91, for 0.07 mm and 0.2°; with 0.003 more of both, with 0.03 single vertices stretch.
///
/// Tried beside it and rejected: the vectors of the edges against the truth's, a metre beside a metre (5.1 mm, 6.6°,
/// in place of 5.0 and 6.7; energy 1.31, strain 1.78).
pub(super) const TENSION: Term = Term {
    weight: 0.0015,
    simulated: &[Prediction::Whole],
    unsimulated: &[],
    new: |scene| scene.model.cut.as_ref().map_or(Ok(None), |_| (ENERGY.new)(scene)),
    ..ENERGY
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
