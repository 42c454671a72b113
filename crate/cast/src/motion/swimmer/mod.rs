//! Motion of a body that swims by its spine, with a pair of fins: strokes, turns, leaps, low-discrepancy wanderings.
//! The wave's phase grows evenly; only its strength and the bends are keyed. So every clip is closed and C¹.

mod moves;
mod skeleton;
mod stroke;

pub use skeleton::Swimmer;
pub use stroke::Stroke;

use super::curve::{Channels, halton, through};
use super::sample;
use crate::Result;
use ctsn_rig::{Character, Clip};
use std::cell::Cell;
use std::f64::consts::TAU;

/// Number of clips of low-discrepancy strokes; seconds, beats and keys of each.
const WANDERINGS: usize = 4;
const WANDER: (f64, usize, usize) = (14.0, 11, 10);

/// Bounds of the strokes of a wandering.
const LEAST: Stroke = Stroke {
    beat: 0.0,
    place: [-0.1, -0.1, -0.1],
    turn: [-30.0, -15.0, -40.0],
    fore: [-36.0, -34.0, -16.0],
    tail: [-46.0, -44.0, -16.0],
    fluke: -12.0,
    fins: [[-20.0, -20.0, -20.0]; 2],
};
const MOST: Stroke = Stroke {
    beat: 1.1,
    place: [0.1, 0.1, 0.1],
    turn: [30.0, 15.0, 40.0],
    fore: [30.0, 34.0, 16.0],
    tail: [40.0, 44.0, 16.0],
    fluke: 12.0,
    fins: [[30.0, 36.0, 25.0]; 2],
};

/// Every clip for `character` at `rate` poses per second.
pub fn clips(character: &Character, rate: f64) -> Result<Vec<Clip>> {
    let swimmer = Swimmer::new(character)?;
    let play = |name: &str, period: f64, beats: usize, keys: &[(f64, Stroke)]| {
        let phase = TAU * beats as f64 / period;
        sample(name, period, rate, |time| swimmer.pose(&through(keys, period, time), phase * time))
    };
    let (period, beats, _) = WANDER;
    let wanderings = (0..WANDERINGS).map(|seed| play(&format!("wander {}", seed + 1), period, beats, &wander(seed)));
    // Wanderings go first: a trained model is tested on the last clips of a character.
    let mut clips: Vec<Clip> = wanderings.collect();
    clips.extend(moves::moves().iter().map(|each| play(each.name, each.period, each.beats, &each.keys)));
    Ok(clips)
}

/// Key strokes of wandering `seed`, from the Halton sequence.
fn wander(seed: usize) -> Vec<(f64, Stroke)> {
    let (period, _, count) = WANDER;
    let key = |i: usize| {
        let dimension = Cell::new(0);
        let draw = |least: f64, most: f64| {
            dimension.set(dimension.get() + 1);
            least + (most - least) * halton(1 + seed * count + i, dimension.get() - 1)
        };
        (period * i as f64 / count as f64, LEAST.zip(&MOST, draw))
    };
    (0..count).map(key).collect()
}
