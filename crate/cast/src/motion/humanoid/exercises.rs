//! Moves that take a garment to its limits: reaching, squatting, kicking, turning, lunging, as key postures.

use super::posture::{FOOT, Move, Posture, STAND, wide};
use crate::motion::curve::Channels;

/// The moves of this file.
pub fn exercises() -> Vec<Move> {
    vec![reach(), squat(), kick(), turn(), lunge()]
}

/// Stretches up, to either side and back.
fn reach() -> Move {
    let up = Posture {
        hips: [0.0, 0.020, 0.0],
        spine: [-10.0, 0.0, 0.0],
        head: [-16.0, 0.0, 0.0],
        arms: [[160.0, 4.0, 20.0, 12.0, 0.0]; 2],
        feet: [[0.02, 0.0, 0.0, 8.0, 26.0]; 2],
        ..STAND
    };
    let side = Posture {
        hips: [-0.045, -0.020, 0.0],
        tilt: [0.0, 0.0, 3.0],
        spine: [2.0, 0.0, 32.0],
        head: [0.0, 0.0, 12.0],
        arms: [[62.0, 4.0, 0.0, 24.0, 0.0], [158.0, 4.0, 20.0, 22.0, 0.0]],
        feet: wide(0.05),
        ..STAND
    };
    let forward = Posture {
        hips: [0.0, -0.03, -0.06],
        tilt: [16.0, 0.0, 0.0],
        spine: [34.0, 0.0, 0.0],
        head: [6.0, 0.0, 0.0],
        arms: [[18.0, 92.0, 0.0, 14.0, 0.0]; 2],
        ..STAND
    };
    let keys = vec![
        (0.0, STAND),
        (1.3, up),
        (2.0, up),
        (3.1, side),
        (3.8, side),
        (4.9, side.mirrored()),
        (5.6, side.mirrored()),
        (6.7, forward),
    ];
    Move { name: "reach", period: 7.8, keys }
}

/// A squat with arms in front, then a bend to the floor.
fn squat() -> Move {
    let low = Posture {
        hips: [0.0, -0.40, -0.16],
        tilt: [26.0, 0.0, 0.0],
        spine: [16.0, 0.0, 0.0],
        head: [-26.0, 0.0, 0.0],
        arms: [[24.0, 88.0, 0.0, 14.0, 0.0]; 2],
        feet: [[0.09, 0.0, 0.0, 20.0, 0.0]; 2],
        ..STAND
    };
    let half = Posture {
        hips: [0.0, -0.13, -0.05],
        tilt: [12.0, 0.0, 0.0],
        spine: [8.0, 0.0, 0.0],
        arms: [[28.0, 40.0, 0.0, 24.0, 0.0]; 2],
        feet: wide(0.07),
        ..STAND
    };
    let bend = Posture {
        hips: [0.0, -0.05, -0.13],
        tilt: [42.0, 0.0, 0.0],
        spine: [44.0, 0.0, 0.0],
        head: [10.0, 0.0, 0.0],
        arms: [[22.0, 70.0, 0.0, 10.0, 0.0]; 2],
        ..STAND
    };
    let keys =
        vec![(0.0, STAND), (0.7, half), (1.5, low), (2.1, low), (2.9, half), (3.7, STAND), (4.8, bend), (5.4, bend)];
    Move { name: "squat and bend", period: 6.6, keys }
}

/// A front kick with either leg.
fn kick() -> Move {
    let ready = Posture {
        hips: [0.0, -0.060, 0.0],
        tilt: [4.0, -12.0, 0.0],
        spine: [6.0, 6.0, 0.0],
        arms: [[34.0, 42.0, 6.0, 92.0, 0.0], [36.0, 34.0, 6.0, 92.0, 0.0]],
        feet: [[0.04, 0.0, 0.08, 10.0, 0.0], [0.05, 0.0, -0.12, 22.0, 12.0]],
        ..STAND
    };
    let knee = Posture {
        hips: [0.060, -0.030, 0.02],
        tilt: [-6.0, 4.0, 2.0],
        spine: [10.0, 0.0, 0.0],
        arms: [[46.0, 44.0, 6.0, 84.0, 0.0], [50.0, 6.0, 6.0, 62.0, 0.0]],
        feet: [ready.feet[0], [0.0, 0.42, 0.16, 6.0, 40.0]],
        ..STAND
    };
    let out = Posture {
        hips: [0.060, -0.022, 0.05],
        tilt: [-14.0, 14.0, 3.0],
        spine: [8.0, -6.0, 2.0],
        arms: [[52.0, 52.0, 6.0, 70.0, 0.0], [56.0, -16.0, 6.0, 34.0, 0.0]],
        feet: [ready.feet[0], [-0.01, 0.74, 0.95, 4.0, 14.0]],
        ..STAND
    };
    let half = [(0.0, ready), (0.75, knee), (1.15, out), (1.55, knee), (2.2, ready)];
    let centre = Posture { feet: [[0.05, 0.0, 0.0, 10.0, 0.0]; 2], ..ready.blend(&ready.mirrored(), 0.5) };
    let mut keys: Vec<(f64, Posture)> = half.to_vec();
    keys.push((2.8, centre));
    keys.extend(half.iter().map(|&(time, posture)| (3.4 + time, posture.mirrored())));
    keys.push((6.2, centre));
    Move { name: "kick", period: 6.8, keys }
}

/// Turns to either side in small steps and back.
fn turn() -> Move {
    let step = |heading: f64, lifted: usize| {
        let mut posture = Posture {
            heading,
            hips: [if lifted == 0 { -0.045 } else { 0.045 }, -0.028, 0.0],
            spine: [2.0, 10.0, 0.0],
            head: [0.0, 22.0, 0.0],
            ..STAND
        };
        posture.feet[lifted] = [0.03, 0.085, 0.0, 16.0, 18.0];
        posture.arms[lifted][1] = 18.0;
        posture.arms[1 - lifted][1] = -8.0;
        posture
    };
    let planted = |heading: f64| Posture {
        heading,
        hips: [0.0, -0.024, 0.0],
        spine: [2.0, 8.0, 0.0],
        head: [0.0, 16.0, 0.0],
        ..STAND
    };
    let looking = Posture { head: [0.0, -10.0, 0.0], heading: 75.0, ..STAND };
    let mut left = vec![(0.0, STAND)];
    let outwards = [(14.0, 0), (34.0, 1), (54.0, 0), (70.0, 1)];
    for (i, (heading, lifted)) in outwards.into_iter().enumerate() {
        left.extend([(0.3 + 0.6 * i as f64, step(heading, lifted)), (0.6 + 0.6 * i as f64, planted(heading + 5.0))]);
    }
    left.extend([(3.0, looking), (3.6, looking)]);
    let homewards = [(60.0, 1), (38.0, 0), (14.0, 1)];
    for (i, (heading, lifted)) in homewards.into_iter().enumerate() {
        let back = |posture: Posture| Posture { heading, ..posture.mirrored() };
        left.push((3.9 + 0.6 * i as f64, back(step(heading, 1 - lifted))));
        left.push((4.2 + 0.6 * i as f64, Posture { heading: heading - 8.0, ..planted(0.0).mirrored() }));
    }
    let right: Vec<(f64, Posture)> = left.iter().map(|&(time, posture)| (time + 5.7, posture.mirrored())).collect();
    left.extend(right);
    Move { name: "turn", period: 11.4, keys: left }
}

/// Lunges to the front with either leg, arms stretched out.
fn lunge() -> Move {
    let front = Posture {
        hips: [0.0, -0.20, 0.10],
        tilt: [3.0, -6.0, 0.0],
        spine: [4.0, 6.0, 0.0],
        arms: [[84.0, 30.0, 10.0, 12.0, 0.0], [86.0, -18.0, 10.0, 12.0, 0.0]],
        feet: [[0.02, 0.0, 0.42, 4.0, 0.0], [0.03, 0.0, -0.54, 14.0, 42.0]],
        ..STAND
    };
    let lifted = Posture {
        hips: [-0.055, -0.02, 0.0],
        arms: [[50.0, 20.0, 4.0, 30.0, 0.0]; 2],
        feet: [[0.0, 0.12, 0.10, 4.0, 10.0], FOOT],
        ..STAND
    };
    let half = [(0.0, STAND), (0.6, lifted), (1.3, front), (1.9, front), (2.6, lifted)];
    let right = half.iter().map(|&(time, posture)| (time + 3.3, posture.mirrored()));
    Move { name: "lunge", period: 6.6, keys: half.iter().copied().chain(right).collect() }
}
