//! Motion of a body on four legs: gaits, moves, low-discrepancy wanderings.
//! Paws stay on the floor by inverse kinematics; the root stays within a metre.

mod actions;
mod gait;
mod leg;
mod moves;
mod skeleton;
mod stance;
mod wander;

pub use skeleton::Quadruped;
pub use stance::Stance;

use super::curve::through;
use super::sample;
use crate::Result;
use ctsn_rig::{Character, Clip};

/// Number of clips of low-discrepancy stances.
const WANDERINGS: usize = 5;

/// Every clip for `character` at `rate` poses per second.
pub fn clips(character: &Character, rate: f64) -> Result<Vec<Clip>> {
    let animal = Quadruped::new(character)?;
    let mut clips = Vec::new();
    for gait in gait::GAITS {
        let period = gait.stride.0 * gait.stride.1 as f64;
        clips.push(sample(gait.name, period, rate, |time| animal.pose(&gait.at(time))));
    }
    // Wanderings go first: a trained model is tested on the last clips of a character.
    for seed in 0..WANDERINGS {
        let keys = wander::keys(seed);
        let stance = |time| through(&keys, wander::PERIOD, time);
        clips.push(sample(&format!("wander {}", seed + 1), wander::PERIOD, rate, |time| animal.pose(&stance(time))));
    }
    for each in &moves::moves() {
        let stance = |time| through(&each.keys, each.period, time);
        clips.push(sample(each.name, each.period, rate, |time| animal.pose(&stance(time))));
    }
    Ok(clips)
}
