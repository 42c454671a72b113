//! One optimisation step: the batch dealt to the threads, its gradients summed, Adam.

use super::item::Item;
use super::recording::Recording;
use super::tape::{Lane, Shared};
use super::unsimulated::Unsimulated;
use super::{Sums, Trainer};
use crate::Result;
use crate::loss::{Known, Losses};
use rayon::prelude::*;

/// What a thread works with.
pub(super) struct Worker {
    pub lane: Lane,
    /// For unsimulated poses.
    unsimulated: Option<Lane>,
    /// For coarsely simulated ones.
    pub coarse: Option<Lane>,
    pub losses: Losses,
}

impl Worker {
    pub fn new(
        recording: &Recording,
        unsimulated: Option<&Unsimulated>,
        shared: &Shared,
        losses: Losses,
    ) -> Result<Self> {
        let unsimulated = unsimulated.map(|poses| poses.recording.lane(shared)).transpose()?;
        Ok(Self { lane: recording.lane(shared)?, unsimulated, coarse: None, losses })
    }
}

impl Trainer {
    /// Optimisation step number `done`; the mean of each loss over the poses that it reads.
    pub(super) fn step(&mut self, batch: &[usize], done: usize) -> Result<Vec<f32>> {
        let rate = self.rate(done);
        let drawn = self.unsimulated.as_ref().map_or(Ok(Vec::new()), |poses| poses.draw(&self.model, done))?;
        let batch: Vec<&Item> = batch.iter().map(|item| &self.items[*item]).collect();
        let drawn: Vec<&Item> = drawn.iter().collect();
        let coarse = self.coarse.as_ref().map_or(Vec::new(), |poses| poses.draw(done));
        let (shared, parameters, shares) = (&self.parameters.shared, self.parameters.ids(), self.sums.len());
        let unsimulated = self.unsimulated.as_ref().map(|poses| &poses.recording);
        let coarsely = self.coarse.as_ref().map(|poses| &poses.recording);
        let each = shares.div_ceil(self.workers.len());
        let run = |(thread, (worker, sums)): (usize, (&mut Worker, &mut [Sums]))| {
            let share = |(number, sums): (usize, &mut Sums)| {
                let Worker { lane, unsimulated: other_lane, coarse: coarse_lane, losses } = &mut *worker;
                let mut learn = |recording: Option<&Recording>, lane: Option<&mut Lane>, items: &[&Item]| {
                    let (Some(recording), Some(lane)) = (recording, lane) else { return Vec::new() };
                    lane.exchange(&parameters, sums);
                    let mine = items.iter().skip(thread * each + number).step_by(shares);
                    let values = mine.map(|item| item.learn(recording, shared, lane, losses, items.len()));
                    let values = values.collect::<Vec<_>>();
                    lane.exchange(&parameters, sums);
                    values
                };
                let mut values = learn(Some(&self.recording), Some(lane), &batch);
                values.extend(learn(unsimulated, other_lane.as_mut(), &drawn));
                values.extend(learn(coarsely, coarse_lane.as_mut(), &coarse));
                values
            };
            sums.iter_mut().for_each(|sums| sums.iter_mut().for_each(|sum| sum.fill(0.0)));
            sums.iter_mut().enumerate().flat_map(share).collect()
        };
        let workers = self.workers.par_iter_mut().zip(self.sums.par_chunks_mut(each)).enumerate();
        let values: Vec<Vec<Vec<f32>>> = workers.map(run).collect();
        let poses = [(Known::Truth, batch.len()), (Known::Nothing, drawn.len()), (Known::Coarse, coarse.len())];
        self.descend(done + 1, rate);
        let mean = |(i, term): (usize, &crate::loss::Term)| {
            let read = poses.iter().filter(|(known, _)| term.reads_any(*known));
            let count: usize = read.map(|(_, count)| count).sum();
            values.iter().flatten().map(|values| values[i]).sum::<f32>() / count.max(1) as f32
        };
        Ok(self.terms.iter().enumerate().map(mean).collect())
    }

    /// Step number `step` (from 1) of Adam against the sums of the gradients.
    fn descend(&mut self, step: usize, rate: f32) {
        let Self { parameters, hypernetwork, sums, .. } = self;
        let parts = |i: usize| sums.iter().map(|sums| sums[i].as_slice()).collect::<Vec<_>>();
        if let Some(network) = hypernetwork {
            let names: Vec<String> = parameters.each().map(|(name, _)| name.to_owned()).collect();
            let of = |name: &str| names.iter().position(|known| known == name).map_or_else(Vec::new, parts);
            network.step(step, rate, of);
        }
        let is_made = |name: &str| hypernetwork.as_ref().is_some_and(|network| network.makes(name));
        parameters.step(step, rate, |i, name| (!is_made(name)).then(|| parts(i)));
        if let Some(network) = hypernetwork {
            network.make(parameters);
        }
    }
}
