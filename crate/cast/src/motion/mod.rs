//! Generated motion for the skeletons the project knows: posture(t) -> G_j(t). Each clip is closed and C¹.
//! simulation.md §5.

mod bones;
pub(crate) mod curve;
pub mod humanoid;
pub mod quadruped;
pub mod reading;
pub mod retarget;
mod rigid;
pub mod swimmer;

use crate::{Error, Result};
use ctsn_rig::{Character, Clip, Pose};
use glam::DAffine3;
use reading::Reading;

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

/// A body turned by less than this faces ahead, radians: no skeleton is quite straight.
const STRAIGHT: f64 = 0.3;

/// Every clip for `character` at `rate` poses per second, of the first kind of body its skeleton fits.
/// Each clip ends with the posture it began with, up to rounding.
pub fn clips(character: &Character, rate: f64) -> Result<Vec<Clip>> {
    if !(rate > 0.0 && rate <= 1000.0) {
        return Err(Error::Character(format!("wanted up to 1000 poses per second, found {rate}")));
    }
    let (kind, reading) = Reading::nearest(character);
    let forward = reading.forward(character).filter(|_| reading.missing().is_empty());
    let heading = forward.map(|forward| forward.x.atan2(forward.z)).filter(|heading| heading.abs() > STRAIGHT);
    let mut lacks = Vec::new();
    for (name, clips) in KINDS {
        let moved = match heading {
            Some(heading) => ahead(character, heading, rate, clips),
            None => clips(character, rate),
        };
        match moved {
            Err(Error::Character(reason)) => lacks.push(format!("as a body with {name}: {reason}")),
            moved => return moved,
        }
    }
    let lacks = lacks.join("; ");
    Err(Error::Character(format!(
        "no motion fits this skeleton. It is nearest to a body with {kind}, without {}; a map of joints can tell them \
         (--joints). Found: {reading}. Tried: {lacks}",
        reading.missing().join(", ")
    )))
}

/// Clips of a body that faces elsewhere than +Z: those of the body turned to face there, turned back.
fn ahead(
    character: &Character,
    heading: f64,
    rate: f64,
    clips: &impl Fn(&Character, f64) -> Result<Vec<Clip>>,
) -> Result<Vec<Clip>> {
    let turn = DAffine3::from_rotation_y(heading);
    let mut turned = character.clone();
    turned.joints.iter_mut().for_each(|joint| joint.inverse_bind *= turn);
    let back = turn.inverse();
    turned.body.mesh.positions.iter_mut().for_each(|point| *point = back.transform_point3(*point));
    let mut clips = clips(&turned, rate)?;
    let poses = clips.iter_mut().flat_map(|clip| &mut clip.poses);
    poses.flatten().for_each(|joint| *joint = turn * *joint);
    Ok(clips)
}

/// Frames from second 0 to `period`, both included. The rate is adjusted so that the last frame falls on the period.
fn sample(name: &str, period: f64, rate: f64, pose: impl Fn(f64) -> Pose) -> Clip {
    let frames = (period * rate).round().max(1.0);
    let poses = (0..=frames as usize).map(|frame| pose(period * frame as f64 / frames)).collect();
    Clip { name: name.to_string(), rate: frames / period, poses }
}

#[cfg(test)]
mod tests;
