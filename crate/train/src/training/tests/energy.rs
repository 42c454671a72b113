//! The list is open: the cloth's own elastic energy as a loss, on simulated and on unsimulated poses.

use super::unsimulated::scene;
use super::*;
use crate::loss::{Loss, Term};
use ctsn_cloth::simulate::Elastic;
use ctsn_rig::{numbers, vertices};
use glam::DVec3;

const ENERGY: Term = Term {
    name: "energy",
    title: "stretch and bending",
    unit: "J",
    weight: 0.1,
    constants: &[],
    simulated: &[Prediction::Whole],
    unsimulated: &[Prediction::Whole],
    new: |scene| Ok(Some(Box::new(Energy(scene.setup.elastic()?)))),
};

struct Energy(Elastic);

impl Loss for Energy {
    fn value(&mut self, predicted: &[f32], _: &[f32], scale: f32, gradient: &mut [f32]) -> f32 {
        let x = vertices(predicted);
        let mut forces = vec![DVec3::ZERO; x.len()];
        let energy = self.0.stretch(&x, &mut forces) + self.0.bend(&x, &mut forces);
        gradient.iter_mut().zip(numbers(&forces)).for_each(|(gradient, force)| *gradient += scale * force);
        energy as f32
    }
}

#[test]
fn cloth_learns_from_its_energy_alone() {
    let (model, setup, samples) = scene();
    let samples: Vec<&Sample> = samples.iter().take(3).collect();
    let settings = Settings { epochs: 40, batch: 3, ..Settings::default() };
    let mut trainer = Trainer::with(model, None, &[ENERGY], &setup, &samples, settings).unwrap();
    assert!(trainer.unsimulated.is_some(), "limbs to mix");
    assert!(trainer.key().contains("energy 0.1"), "{}", trainer.key());
    let energies: Vec<f32> = (0..settings.epochs).map(|_| trainer.round(&samples).unwrap().losses[0].1).collect();
    assert_eq!(trainer.curve[0].losses[0].0, "energy");
    let [first, last] = [energies[0], energies[settings.epochs - 1]];
    assert!(last < 0.8 * first, "from {first} J to {last} J");
}
