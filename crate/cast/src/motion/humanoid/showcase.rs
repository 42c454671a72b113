//! The demo page's clip: moves one after another, cross-faded over a second in posture space, so C¹ throughout.

use super::gait::WALK;
use super::posture::{Move, Posture, STAND};
use crate::motion::curve::{Channels, smoothstep, through};

/// Seconds until it repeats.
pub const PERIOD: f64 = 30.0;
/// Seconds of a cross-fade.
const FADE: f64 = 1.1;

/// What is shown: second at which it begins to fade in, name of the move, second of the move to begin at.
const PROGRAMME: &[(f64, &str, f64)] = &[
    (0.0, "walk", 0.0),
    (5.6, "dance", 0.0),
    (13.6, "wave", 0.2),
    (17.0, "groove", 0.0),
    (21.6, "reach", 0.6),
    (26.6, "lunge", 0.2),
];

/// Posture at `time` seconds.
pub fn at(moves: &[Move], time: f64) -> Posture {
    let time = time.rem_euclid(PERIOD);
    let count = PROGRAMME.len();
    let now = PROGRAMME.partition_point(|(begin, ..)| *begin <= time).max(1) - 1;
    let before = (now + count - 1) % count;
    let elapsed = |index: usize| (time - PROGRAMME[index].0).rem_euclid(PERIOD);
    let share = smoothstep(elapsed(now) / FADE);
    let posture = |index: usize| play(moves, PROGRAMME[index].1, PROGRAMME[index].2 + elapsed(index));
    let mut shown = if share < 1.0 { posture(before).blend(&posture(now), share) } else { posture(now) };
    // A slow turn shows the garment from both sides.
    shown.heading += 38.0 * (std::f64::consts::TAU * time / 15.0).sin();
    shown
}

fn play(moves: &[Move], name: &str, time: f64) -> Posture {
    if name == "walk" {
        return WALK.at(time);
    }
    moves.iter().find(|each| each.name == name).map_or(STAND, |each| through(&each.keys, each.period, time))
}
