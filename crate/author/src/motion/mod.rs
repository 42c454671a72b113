//! Motion of any humanoid, generated: posture(t) -> G_j(t), each clip closed and C¹; simulation.md §5.
//! Feet stay on the floor by inverse kinematics; the root stays within a metre.

mod exercises;
mod gait;
mod humanoid;
mod moves;
mod posture;
mod showcase;
mod wander;

pub use humanoid::Humanoid;
pub use posture::{Posture, through};

use crate::rig::{Character, Clip};
use crate::{Error, Result};

/// Poses per second of the project's own characters.
pub const RATE: f64 = 30.0;

/// Every clip for `character` at `rate` poses per second: gaits, moves, seeded wanderings, the showcase.
/// Each ends with the posture it began with, up to rounding.
pub fn clips(character: &Character, rate: f64) -> Result<Vec<Clip>> {
    if !(rate > 0.0 && rate <= 1000.0) {
        return Err(Error::Character(format!("wanted up to 1000 poses per second, found {rate}")));
    }
    let humanoid = Humanoid::new(character)?;
    let moves = moves::moves();
    let mut clips = vec![
        sample(&humanoid, "showcase", showcase::PERIOD, rate, |time| showcase::at(&moves, time)),
        sample(&humanoid, "walk", 4.0 * gait::WALK.stride, rate, |time| gait::WALK.at(time)),
        sample(&humanoid, "jog", 6.0 * gait::JOG.stride, rate, |time| gait::JOG.at(time)),
    ];
    for each in &moves {
        clips.push(sample(&humanoid, each.name, each.period, rate, |time| through(&each.keys, each.period, time)));
    }
    for seed in 1..=2 {
        let keys = wander::keys(seed);
        clips.push(sample(&humanoid, &format!("wander {seed}"), wander::PERIOD, rate, |time| {
            through(&keys, wander::PERIOD, time)
        }));
    }
    Ok(clips)
}

/// Frames from 0 to `period`, both ends included; the rate is stretched so that the last frame falls on the period.
fn sample(humanoid: &Humanoid, name: &str, period: f64, rate: f64, posture: impl Fn(f64) -> Posture) -> Clip {
    let frames = (period * rate).round().max(1.0);
    let poses = (0..=frames as usize).map(|frame| humanoid.pose(&posture(period * frame as f64 / frames))).collect();
    Clip { name: name.to_string(), rate: frames / period, poses }
}

#[cfg(test)]
mod tests;
