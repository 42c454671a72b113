//! Slow moves: standing about, sitting down, bowing, stretching, twisting, balancing, picking up, as key postures.

use super::posture::{FOOT, Move, Posture, STAND, wide};

/// The moves of this file.
pub fn calm() -> Vec<Move> {
    vec![idle(), sit(), bow(), stretch(), twist(), balance(), pick_up()]
}

/// Breathes, shifts the weight, looks aside.
fn idle() -> Move {
    let breath = |weight: f64, chest: f64, look: f64| Posture {
        hips: [0.030 * weight, -0.013, 0.0],
        tilt: [0.0, 3.0 * weight, -3.0 * weight],
        spine: [-2.5 * chest, -3.0 * weight, 3.5 * weight],
        head: [2.0 * chest, look, 1.5 * weight],
        arms: [
            [21.0 + 3.0 * chest, 3.0 + 4.0 * weight, 0.0, 18.0, 5.0],
            [21.0 + 3.0 * chest, 3.0 - 4.0 * weight, 0.0, 18.0, 5.0],
        ],
        ..STAND
    };
    let path = [(0.0, 0.0, 0.0), (0.6, 1.0, 8.0), (1.0, 0.0, 14.0), (0.8, 1.0, 4.0), (0.0, 0.0, -4.0)];
    let back = [(-0.7, 1.0, -14.0), (-1.0, 0.0, -6.0), (-0.5, 1.0, 2.0)];
    let keys = path.into_iter().chain(back).enumerate();
    let keys = keys.map(|(i, (weight, chest, look))| (1.1 * i as f64, breath(weight, chest, look)));
    Move { name: "idle", period: 8.8, keys: keys.collect() }
}

/// Sits down on an unseen chair, leans to either side, rises.
fn sit() -> Move {
    let feet = [[0.06, 0.0, 0.10, 8.0, 0.0]; 2];
    let lowering = Posture {
        hips: [0.0, -0.240, -0.20],
        tilt: [30.0, 0.0, 0.0],
        spine: [22.0, 0.0, 0.0],
        head: [-20.0, 0.0, 0.0],
        arms: [[26.0, 62.0, 0.0, 24.0, 0.0]; 2],
        feet,
        ..STAND
    };
    let seated = Posture {
        hips: [0.0, -0.450, -0.30],
        tilt: [-4.0, 0.0, 0.0],
        spine: [8.0, 0.0, 0.0],
        arms: [[30.0, 34.0, -6.0, 44.0, 0.0]; 2],
        feet,
        ..STAND
    };
    let aside = Posture {
        tilt: [0.0, 4.0, 2.0],
        spine: [10.0, 26.0, 14.0],
        head: [4.0, 28.0, 4.0],
        arms: [[56.0, 20.0, 0.0, 30.0, 0.0], [36.0, 56.0, -6.0, 40.0, 0.0]],
        ..seated
    };
    let stands = Posture { feet: [[0.04, 0.0, 0.06, 8.0, 0.0]; 2], ..STAND };
    let keys = [stands, lowering, seated, seated, aside, aside.mirrored(), seated, lowering];
    let times = [0.0, 1.0, 1.8, 2.6, 3.8, 5.4, 6.6, 7.4];
    Move { name: "sit", period: 8.4, keys: times.into_iter().zip(keys).collect() }
}

/// A deep bow with one arm swept aside, then a short nod of the trunk.
fn bow() -> Move {
    let deep = Posture {
        hips: [0.0, -0.045, -0.10],
        tilt: [38.0, 0.0, 0.0],
        spine: [34.0, 0.0, 0.0],
        head: [12.0, 0.0, 0.0],
        arms: [[66.0, 10.0, 20.0, 20.0, -8.0], [40.0, 40.0, -10.0, 72.0, 0.0]],
        feet: [[0.01, 0.0, 0.10, 8.0, 0.0], [0.02, 0.0, -0.08, 18.0, 8.0]],
        ..STAND
    };
    let open = Posture {
        spine: [-4.0, 10.0, 0.0],
        arms: [[78.0, 20.0, 24.0, 24.0, -6.0], [36.0, 30.0, 0.0, 60.0, 0.0]],
        feet: deep.feet,
        ..STAND
    };
    let short = Posture {
        hips: [0.0, -0.020, -0.05],
        tilt: [20.0, 0.0, 0.0],
        spine: [18.0, 0.0, 0.0],
        head: [8.0, 0.0, 0.0],
        arms: [[22.0, 10.0, 0.0, 16.0, 0.0]; 2],
        ..STAND
    };
    let keys = [STAND, open, deep, deep, open, STAND, short, short];
    let times = [0.0, 0.9, 2.0, 2.7, 3.8, 4.8, 5.6, 6.1];
    Move { name: "bow", period: 7.0, keys: times.into_iter().zip(keys).collect() }
}

/// Arms high and out, chest open, to the side, down to the toes.
fn stretch() -> Move {
    let high = Posture {
        hips: [0.0, 0.022, 0.0],
        spine: [-12.0, 0.0, 0.0],
        head: [-14.0, 0.0, 0.0],
        arms: [[156.0, 0.0, 24.0, 16.0, 0.0]; 2],
        feet: [[0.02, 0.0, 0.0, 8.0, 24.0]; 2],
        ..STAND
    };
    let open = Posture {
        spine: [-14.0, 0.0, 0.0],
        head: [-8.0, 0.0, 0.0],
        arms: [[82.0, -26.0, 40.0, 30.0, -8.0]; 2],
        ..STAND
    };
    let round = Posture {
        hips: [0.0, -0.04, -0.04],
        spine: [32.0, 0.0, 0.0],
        head: [22.0, 0.0, 0.0],
        arms: [[36.0, 78.0, -10.0, 26.0, 0.0]; 2],
        ..STAND
    };
    let over = Posture {
        hips: [-0.035, -0.015, 0.0],
        spine: [0.0, 0.0, 34.0],
        head: [0.0, 0.0, 14.0],
        arms: [[40.0, 4.0, 0.0, 30.0, 0.0], [150.0, 6.0, 20.0, 30.0, 0.0]],
        feet: wide(0.06),
        ..STAND
    };
    let keys = [STAND, high, high, open, round, STAND, over, over, over.mirrored(), over.mirrored()];
    let times = [0.0, 1.1, 1.7, 2.8, 4.0, 5.0, 6.0, 6.6, 7.8, 8.4];
    Move { name: "stretch", period: 9.4, keys: times.into_iter().zip(keys).collect() }
}

/// The trunk to either side over planted feet: arms out, then elbows bent.
fn twist() -> Move {
    let turned = |arms: [[f64; 5]; 2]| Posture {
        hips: [0.0, -0.035, 0.0],
        tilt: [0.0, 14.0, 0.0],
        spine: [2.0, 40.0, 0.0],
        head: [0.0, 24.0, 0.0],
        arms,
        feet: wide(0.07),
        ..STAND
    };
    let out = turned([[84.0, 6.0, 10.0, 10.0, 0.0], [84.0, 10.0, 10.0, 14.0, 0.0]]);
    let bent = turned([[66.0, 34.0, 0.0, 92.0, 0.0], [62.0, 44.0, 0.0, 88.0, 0.0]]);
    let low = turned([[30.0, -16.0, 0.0, 34.0, 0.0], [32.0, 44.0, 0.0, 44.0, 0.0]]);
    let keys = [STAND, out, out.mirrored(), out, out.mirrored(), bent, bent.mirrored(), low, low.mirrored()];
    Move { name: "twist", period: 8.1, keys: keys.iter().enumerate().map(|(i, &key)| (0.9 * i as f64, key)).collect() }
}

/// Stands on one leg like a crane, then like a plane, on either side.
fn balance() -> Move {
    let crane = Posture {
        hips: [0.055, -0.020, 0.0],
        spine: [0.0, 0.0, -2.0],
        arms: [[88.0, 6.0, 10.0, 16.0, -10.0]; 2],
        feet: [FOOT, [0.0, 0.40, 0.14, 8.0, 30.0]],
        ..STAND
    };
    let plane = Posture {
        hips: [0.050, -0.055, -0.04],
        tilt: [44.0, 0.0, 0.0],
        spine: [8.0, 0.0, 0.0],
        head: [-26.0, 0.0, 0.0],
        arms: [[86.0, 12.0, 10.0, 8.0, 0.0]; 2],
        feet: [FOOT, [0.0, 0.34, -0.62, 10.0, 62.0]],
        ..STAND
    };
    let between = Posture { feet: [FOOT, [0.0, 0.26, -0.10, 8.0, 40.0]], tilt: [14.0, 0.0, 0.0], ..crane };
    let half = [(0.0, STAND), (1.0, crane), (1.6, crane), (2.2, between), (3.0, plane), (3.7, plane), (4.3, between)];
    let right = half.iter().map(|&(time, posture)| (time + 5.2, posture.mirrored()));
    Move { name: "balance", period: 10.4, keys: half.iter().copied().chain(right).collect() }
}

/// Goes down on bent knees, takes something from the floor on either side, lifts it overhead.
fn pick_up() -> Move {
    let down = Posture {
        hips: [0.02, -0.330, -0.10],
        tilt: [34.0, 10.0, 0.0],
        spine: [28.0, 14.0, 8.0],
        head: [0.0, 10.0, 0.0],
        arms: [[34.0, 54.0, 0.0, 14.0, 0.0], [36.0, 66.0, 0.0, 34.0, 0.0]],
        feet: [[0.08, 0.0, 0.06, 18.0, 0.0], [0.07, 0.0, -0.10, 18.0, 24.0]],
        ..STAND
    };
    let lift = Posture {
        hips: [0.0, -0.060, -0.01],
        arms: [[34.0, 58.0, 0.0, 70.0, 0.0]; 2],
        feet: [[0.07, 0.0, 0.04, 14.0, 0.0], [0.06, 0.0, -0.06, 14.0, 4.0]],
        ..STAND
    };
    let over = Posture {
        spine: [-8.0, -4.0, 0.0],
        head: [-14.0, 0.0, 0.0],
        arms: [[140.0, 14.0, 20.0, 34.0, 0.0]; 2],
        feet: lift.feet,
        ..STAND
    };
    let half = [(0.0, STAND), (1.2, down), (1.7, down), (2.6, lift), (3.4, over), (3.9, over)];
    let right = half.iter().map(|&(time, posture)| (time + 4.9, posture.mirrored()));
    Move { name: "pick up", period: 9.8, keys: half.iter().copied().chain(right).collect() }
}
