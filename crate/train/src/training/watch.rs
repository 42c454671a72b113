//! What is watched after every epoch: poses that are not learned from. By them the best epoch is chosen, and how much
//! curvature counts.

use super::Trainer;
use super::item::Item;
use super::step::Worker;
use crate::Result;
use crate::dataset::Sample;
use crate::judging::differences;
use crate::loss::{CURVATURE, emphasis};
use rayon::prelude::*;

/// Errors on the poses that are watched, means over them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watched {
    /// E_dist, metres.
    pub distance: f32,
    /// E_norm, degrees.
    pub normal: f32,
    /// How much the prediction bends, over how much the truth does; `None` where that does not bend.
    pub bending: Option<f32>,
}

/// Of one pose: E_dist, E_norm, how much the prediction and the truth bend.
type Errors = [f64; 4];

impl Trainer {
    /// Errors of the model as it stands, polished and not repaired, on `samples`. network.md §7.
    pub fn validate(&mut self, samples: &[&Sample]) -> Result<Watched> {
        let (recording, model, workers, bending) = (&self.recording, &self.model, self.workers.len(), &self.bending);
        let shared = &self.parameters.shared;
        let run = |(number, worker): (usize, &mut Worker)| {
            let errors = |sample: &&Sample| {
                let [predicted, truth] = Item::compared(model, sample, recording, shared, &mut worker.lane)?;
                let (distance, normal) = differences(&predicted, &truth, &model.triangles);
                Ok([distance, normal, bending.of(&predicted), bending.of(&truth)])
            };
            samples.iter().skip(number).step_by(workers).map(errors).collect()
        };
        let errors = self.workers.par_iter_mut().enumerate().map(run).collect::<Result<Vec<Vec<Errors>>>>()?;
        // Summed in the samples' order, whatever the number of threads.
        let ordered = || (0..samples.len()).map(|i| errors[i % workers][i / workers]);
        let [distance, normal, predicted, truth] =
            std::array::from_fn(|part| ordered().map(|errors| errors[part]).sum::<f64>() / samples.len() as f64);
        let bending = (truth > 0.0).then_some((predicted / truth) as f32);
        Ok(Watched { distance: distance as f32, normal: normal as f32, bending })
    }

    /// Makes curvature count as much as the epochs so far tell.
    pub(super) fn emphasise(&mut self) {
        let weight = CURVATURE.weight * emphasis(self.curve.iter().filter_map(|row| row.bending));
        self.workers.iter_mut().for_each(|worker| worker.losses.weigh(CURVATURE.name, weight));
    }
}
