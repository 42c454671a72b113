//! Poses that nobody simulated: mixed anew for every step, for losses that need no truth.

use super::Settings;
use super::item::Item;
use super::recording::Recording;
use crate::Result;
use crate::dataset::{Sample, Setup};
use crate::loss::{Prediction, Term};
use ctsn_core::model::HostModel;
use ctsn_core::network::Streams;
use ctsn_rig::mixed::Mixer;
use ctsn_rig::path::is_sound;
use ctsn_rig::{joints, pose};
use rayon::prelude::*;

/// Unsimulated poses for each of a batch. (Of a skirt in unseen poses, one for each leaves 0.96 % inside the body, four
/// leave 0.91 %, with a weight of 1; a step takes 7 % longer.)
pub(super) const EACH: usize = 4;

/// Where they come from.
pub(super) struct Unsimulated {
    pub recording: Recording,
    mixer: Mixer,
    seed: u64,
    /// Poses for each step.
    count: usize,
}

impl Unsimulated {
    /// Mixtures of the poses in `samples`; none where no loss reads what the network makes of them, or there are no
    /// limbs to mix.
    pub fn new(
        model: &HostModel,
        terms: &[Term],
        setup: &Setup,
        samples: &[&Sample],
        settings: &Settings,
    ) -> Result<Option<Self>> {
        let Settings { variant, seed, batch, .. } = *settings;
        let read = |prediction| terms.iter().any(|term| term.unsimulated.contains(&prediction));
        let streams = match (read(Prediction::Whole), read(Prediction::Coarse)) {
            (true, _) => variant.streams(),
            (_, true) if variant.skeleton => Streams::Skeleton,
            _ => return Ok(None),
        };
        let character = setup.character()?;
        let poses = samples.iter().map(|sample| pose(&sample.joints));
        let frames = poses.filter(|pose| is_sound(&character, pose)).collect();
        let made =
            |mixer| Self { recording: Recording::new(model, variant, streams).0, mixer, seed, count: batch * EACH };
        // What was simulated of mixed poses is turned further already.
        Ok(Mixer::new(&character, frames, 0.0).map(made))
    }

    /// The poses for optimisation step `step`, the same ones whenever they are asked for.
    pub fn draw(&self, model: &HostModel, step: usize) -> Result<Vec<Item>> {
        // Other numbers than those of simulated mixtures, which start at nought.
        let first = (self.seed as usize).wrapping_add(1) << 40;
        let item = |i| {
            let pose = self.mixer.pose(first | (step * self.count + i));
            Item::posed(model, &joints(&pose))
        };
        (0..self.count).into_par_iter().map(item).collect()
    }
}
