//! The whole prediction against the truth: the paper's E_dist on the poses learned from. network.md §6.

use super::distance::distance;
use super::{Loss, Prediction, Term};

pub(super) const FINE: Term = Term {
    name: "fine",
    title: "E_dist, poses learned from",
    unit: "m",
    weight: 1.0,
    constants: &[],
    simulated: &[Prediction::Whole],
    unsimulated: &[],
    new: |_| Ok(Some(Box::new(Fine))),
};

pub(super) struct Fine;

impl Loss for Fine {
    fn target(&self, truth: &[f32]) -> Vec<f32> {
        truth.to_vec()
    }

    fn value(&mut self, predicted: &[f32], truth: &[f32], scale: f32, gradient: &mut [f32]) -> f32 {
        distance(predicted, truth, scale, gradient)
    }
}
