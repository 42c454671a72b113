//! Low-discrepancy stances within joint limits, joined smoothly: they cover what lies between the authored moves.

use super::stance::Stance;
use crate::motion::curve::{Channels, halton};
use std::cell::Cell;

/// Seconds until it repeats.
pub const PERIOD: f64 = 12.0;
/// Key stances per period.
const KEYS: usize = 12;

/// Bounds of the stances.
const LEAST: Stance = Stance {
    heading: -15.0,
    hips: [-0.07, -0.24, -0.08],
    trunk: [-12.0, -8.0, -8.0],
    spine: [-14.0, -28.0, -12.0],
    neck: [-50.0, -38.0, -12.0],
    head: [-30.0, -55.0, -18.0],
    tail: [10.0, -30.0, -8.0, -55.0],
    ears: 0.0,
    paws: [[-0.03, 0.0, -0.16, 0.0]; 4],
};
const MOST: Stance = Stance {
    heading: 15.0,
    hips: [0.07, 0.0, 0.08],
    trunk: [16.0, 8.0, 8.0],
    spine: [28.0, 28.0, 12.0],
    neck: [16.0, 38.0, 12.0],
    head: [24.0, 55.0, 18.0],
    tail: [62.0, 30.0, 40.0, 55.0],
    ears: 35.0,
    paws: [[0.08, 0.0, 0.16, 14.0]; 4],
};

/// Key stances of wandering `seed`, from the Halton sequence. Every third one lifts a paw.
pub fn keys(seed: usize) -> Vec<(f64, Stance)> {
    let key = |i: usize| {
        let index = 1 + seed * KEYS + i;
        let dimension = Cell::new(0);
        let draw = |least: f64, most: f64| {
            dimension.set(dimension.get() + 1);
            least + (most - least) * halton(index, dimension.get() - 1)
        };
        let mut stance = LEAST.zip(&MOST, draw);
        // The head turns with the neck, which may turn further than a head against a neck.
        stance.head = std::array::from_fn(|axis| 0.5 * stance.head[axis] + 0.6 * stance.neck[axis]);
        if i % 3 == 1 {
            let paw = (seed + i / 3) % 4;
            stance.paws[paw] = [0.04, 0.10 + 0.35 * halton(index, 2), 0.05 + 0.3 * halton(index, 3), 24.0];
        }
        (PERIOD * i as f64 / KEYS as f64, stance)
    };
    (0..KEYS).map(key).collect()
}
