//! Poses whose cloth was simulated coarsely: where it lies, without its fine folds. They cost a sixth of others and
//! teach the skeleton stream, whose target is smooth anyhow, how cloth lies where there is no fine truth.

use super::item::Item;
use super::recording::Recording;
use super::{Losses, Settings};
use crate::Result;
use crate::dataset::{Sample, Setup, fingerprint};
use crate::loss::Known;
use ctsn_core::model::HostModel;
use ctsn_core::network::Streams;

/// Coarse poses for each of a batch, at most. A pass of the skeleton stream takes a twentieth of that of both.
pub(super) const EACH: usize = 4;

/// Coarse poses, and how they are learned from.
pub(super) struct Coarse {
    pub recording: Recording,
    items: Vec<Item>,
    /// [`fingerprint`] of the samples.
    pub data: u64,
    seed: u64,
    /// Poses for each step.
    count: usize,
}

impl Coarse {
    /// Of `samples`, beside a training that takes `steps` steps an epoch: in one, a pose is met once on average, or
    /// more rarely where they are many. None where there are none, or one of the streams does not learn: what is left
    /// then learns the truth itself.
    pub fn new(
        model: &HostModel,
        setup: &Setup,
        samples: &[&Sample],
        losses: &Losses,
        settings: &Settings,
        steps: usize,
    ) -> Result<Option<Self>> {
        let Settings { variant, seed, batch, .. } = *settings;
        if samples.is_empty() || !variant.skeleton || !variant.mesh {
            return Ok(None);
        }
        let item = |sample: &&Sample| Item::new(model, sample, losses, Known::Coarse);
        Ok(Some(Self {
            recording: Recording::new(model, variant, Streams::Skeleton).0,
            items: samples.iter().map(item).collect::<Result<_>>()?,
            data: fingerprint(setup, samples)?,
            seed,
            count: samples.len().div_ceil(steps).min(EACH * batch),
        }))
    }

    /// Those of optimisation step `step`, the same ones whenever they are asked for.
    pub fn draw(&self, step: usize) -> Vec<&Item> {
        let mut rng = fastrand::Rng::with_seed(self.seed ^ ((step as u64) << 20));
        (0..self.count).map(|_| &self.items[rng.usize(..self.items.len())]).collect()
    }
}
