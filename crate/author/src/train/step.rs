//! One optimisation step: the batch dealt to the threads, its gradients summed, Adam.

use super::item::Item;
use super::penetration::{Penetration, Unlabelled};
use super::recording::Recording;
use super::tape::{Lane, Shared};
use super::{Loss, Sums, Trainer};
use crate::Result;
use ctsn_core::model::HostModel;
use rayon::prelude::*;

/// What a thread works with.
pub(super) struct Worker {
    pub lane: Lane,
    /// For unlabelled poses.
    unlabelled: Option<Lane>,
    /// None where the model has no body, and penetration is no loss.
    body: Option<Penetration>,
}

impl Worker {
    pub fn new(model: &HostModel, recording: &Recording, unlabelled: Option<&Unlabelled>, shared: &Shared) -> Self {
        Self {
            lane: recording.tape.lane(shared),
            unlabelled: unlabelled.map(|unlabelled| unlabelled.recording.tape.lane(shared)),
            body: model.body.as_ref().map(|body| Penetration::new(body, model.sizes.vertices)),
        }
    }
}

impl Trainer {
    /// Optimisation step number `done`.
    pub(super) fn step(&mut self, batch: &[usize], done: usize) -> Result<Loss> {
        let rate = self.rate(done);
        let drawn = self.unlabelled.as_ref().map_or(Ok(Vec::new()), |poses| poses.draw(&self.model, done))?;
        let batch: Vec<&Item> = batch.iter().map(|item| &self.items[*item]).collect();
        let (shared, parameters, shares) = (&self.shared, &self.parameters, self.sums.len());
        let (recording, unlabelled) = (&self.recording, self.unlabelled.as_ref().map(|poses| &poses.recording));
        let each = shares.div_ceil(self.workers.len());
        let run = |(thread, (worker, sums)): (usize, (&mut Worker, &mut [Sums]))| {
            let share = |(number, sums): (usize, &mut Sums)| {
                let Worker { lane, unlabelled: coarse_lane, body } = &mut *worker;
                let mut learn = |recording: &Recording, lane: &mut Lane, items: &[&Item]| -> Vec<Loss> {
                    lane.exchange(parameters, sums);
                    let mine = items.iter().skip(thread * each + number).step_by(shares);
                    let losses = mine.map(|item| item.learn(recording, shared, lane, body.as_mut(), items.len()));
                    let losses = losses.collect();
                    lane.exchange(parameters, sums);
                    losses
                };
                let mut losses = learn(recording, lane, &batch);
                if let (Some(recording), Some(lane)) = (unlabelled, coarse_lane) {
                    losses.extend(learn(recording, lane, &drawn.iter().collect::<Vec<_>>()));
                }
                losses
            };
            sums.iter_mut().for_each(|sums| sums.iter_mut().for_each(|sum| sum.fill(0.0)));
            sums.iter_mut().enumerate().flat_map(share).collect()
        };
        let workers = self.workers.par_iter_mut().zip(self.sums.par_chunks_mut(each)).enumerate();
        let losses: Vec<Vec<Loss>> = workers.map(run).collect();
        for (i, (id, moments)) in self.parameters.iter().zip(&mut self.moments).enumerate() {
            let gradients: Vec<&[f32]> = self.sums.iter().map(|sums| sums[i].as_slice()).collect();
            let parameter = self.shared.get_mut(*id);
            moments.step(done + 1, rate, &gradients, parameter);
            self.silent[i].iter().for_each(|entry| parameter[*entry] = 0.0);
        }
        let mean = |part: fn(&Loss) -> f32, count: usize| losses.iter().flatten().map(part).sum::<f32>() / count as f32;
        Ok(Loss {
            coarse: mean(|loss| loss.coarse, batch.len()),
            fine: mean(|loss| loss.fine, batch.len()),
            penetration: mean(|loss| loss.penetration, batch.len() + drawn.len()),
        })
    }
}
