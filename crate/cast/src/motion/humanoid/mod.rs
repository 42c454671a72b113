//! Motion of a body with two arms and two legs: gaits, moves, seeded wanderings, the showcase.
//! Feet stay on the floor by inverse kinematics; the root stays within a metre.

mod calm;
mod clear;
mod exercises;
mod gait;
mod moves;
mod posture;
mod showcase;
mod skeleton;
mod sport;
mod wander;

pub use posture::Posture;
pub use skeleton::Humanoid;

use super::curve::through;
use super::sample;
use crate::Result;
use ctsn_rig::{Character, Clip};

/// Every clip for `character` at `rate` poses per second.
pub fn clips(character: &Character, rate: f64) -> Result<Vec<Clip>> {
    let humanoid = Humanoid::new(character)?;
    let play = |name: &str, period: f64, posture: &dyn Fn(f64) -> Posture| {
        sample(name, period, rate, |time| humanoid.pose(&posture(time)))
    };
    let moves = moves::moves();
    let mut clips = vec![
        play("showcase", showcase::PERIOD, &|time| showcase::at(&moves, time)),
        play("walk", 4.0 * gait::WALK.stride, &|time| gait::WALK.at(time)),
    ];
    let gaits = [
        ("jog", gait::JOG, 6.0),
        ("run", gait::RUN, 6.0),
        ("crouch walk", gait::CROUCH, 3.0),
        ("march", gait::MARCH, 4.0),
    ];
    for (name, gait, strides) in gaits {
        clips.push(play(name, strides * gait.stride, &|time| gait.at(time)));
    }
    // Wanderings go first: a trained model is tested on the last clips of a character.
    for which in 0..wander::COUNT {
        let keys = wander::keys(which);
        let name = format!("wander {}", which + 1);
        clips.push(play(&name, wander::PERIOD, &|time| through(&keys, wander::PERIOD, time)));
    }
    for each in &moves {
        clips.push(play(each.name, each.period, &|time| through(&each.keys, each.period, time)));
    }
    Ok(clips)
}

#[cfg(test)]
mod tests;
