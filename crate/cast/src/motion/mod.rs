//! Generated motion for the skeletons the project knows: posture(t) -> G_j(t). Each clip is closed and C¹.
//! simulation.md §5.

mod bones;
pub(crate) mod curve;
pub mod humanoid;
pub mod quadruped;
mod rigid;
pub mod swimmer;

use crate::{Error, Result};
use ctsn_rig::{Character, Clip, Pose};

/// Poses per second of the project's own characters.
pub const RATE: f64 = 30.0;

/// A kind of body: its name, and what makes its clips at a rate or says what the skeleton lacks to be of this kind.
type Kind = (&'static str, fn(&Character, f64) -> Result<Vec<Clip>>);

/// Tried in turn.
const KINDS: &[Kind] = &[
    ("two arms and two legs", humanoid::clips),
    ("four legs", quadruped::clips),
    ("fins and flukes", swimmer::clips),
    ("a fixed root and one obstacle", rigid::clips),
];

/// Every clip for `character` at `rate` poses per second, of the first kind of body its skeleton fits.
/// Each clip ends with the posture it began with, up to rounding.
pub fn clips(character: &Character, rate: f64) -> Result<Vec<Clip>> {
    if !(rate > 0.0 && rate <= 1000.0) {
        return Err(Error::Character(format!("wanted up to 1000 poses per second, found {rate}")));
    }
    let mut lacks = Vec::new();
    for (kind, clips) in KINDS {
        match clips(character, rate) {
            Err(Error::Character(reason)) => lacks.push(format!("as a body with {kind}: {reason}")),
            moved => return moved,
        }
    }
    Err(Error::Character(format!("no motion fits this skeleton; {}", lacks.join("; "))))
}

/// Frames from second 0 to `period`, both included. The rate is adjusted so that the last frame falls on the period.
fn sample(name: &str, period: f64, rate: f64, pose: impl Fn(f64) -> Pose) -> Clip {
    let frames = (period * rate).round().max(1.0);
    let poses = (0..=frames as usize).map(|frame| pose(period * frame as f64 / frames)).collect();
    Clip { name: name.to_string(), rate: frames / period, poses }
}

#[cfg(test)]
mod tests;
