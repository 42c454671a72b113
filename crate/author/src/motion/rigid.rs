//! Motion of a rigid prop, a skeleton of one joint: rest, slow slides and turns.

use super::bones::{Bones, euler};
use super::sample;
use crate::rig::{Character, Clip};
use crate::{Error, Result};
use glam::DVec3;
use std::f64::consts::TAU;

/// A clip: its name, how far it swings to the left, up and forward (metres), and how far it turns (up, left, roll; degrees).
const CLIPS: &[(&str, [f64; 3], [f64; 3])] = &[
    ("still", [0.0; 3], [0.0; 3]),
    ("slide", [0.25, 0.0, 0.0], [0.0; 3]),
    ("lift", [0.0, 0.2, 0.0], [0.0; 3]),
    ("push", [0.0, 0.0, 0.25], [0.0; 3]),
    ("turn", [0.0; 3], [0.0, 90.0, 0.0]),
    ("tilt", [0.0, 0.05, 0.0], [30.0, 0.0, 0.0]),
    ("roll", [0.1, 0.0, 0.0], [0.0, 0.0, 30.0]),
];
/// Seconds until a clip repeats.
const PERIOD: f64 = 4.0;

/// Every clip for `character` at `rate` poses per second.
pub fn clips(character: &Character, rate: f64) -> Result<Vec<Clip>> {
    if character.joints.len() != 1 {
        return Err(Error::Character(format!("wanted a single joint, found {}", character.joints.len())));
    }
    let bones = Bones::new(character);
    let clip = |&(name, far, turned): &(&str, [f64; 3], [f64; 3])| {
        sample(name, PERIOD, rate, |time| {
            let share = (TAU * time / PERIOD).sin();
            let mut turns = bones.turns();
            turns.local[0] = euler(turned.map(|angle| angle * share));
            bones.assemble(0, bones.place(0) + DVec3::from_array(far) * share, &turns)
        })
    };
    Ok(CLIPS.iter().map(clip).collect())
}
