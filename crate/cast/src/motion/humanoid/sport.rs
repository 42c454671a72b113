//! Quick moves: punching, jumping, jumping jacks, side steps, throwing, cheering, as key postures.

use super::posture::{FOOT, Move, Posture, STAND, wide};

/// The moves of this file.
pub fn sport() -> Vec<Move> {
    vec![punch(), jump(), jacks(), side_step(), throw(), cheer()]
}

/// Straight punches from a boxer's stance, either hand, then a hook.
fn punch() -> Move {
    let guard = Posture {
        hips: [0.0, -0.070, 0.0],
        tilt: [4.0, -16.0, 0.0],
        spine: [8.0, 6.0, 0.0],
        head: [2.0, 8.0, 0.0],
        arms: [[30.0, 52.0, 4.0, 92.0, 0.0], [34.0, 40.0, 4.0, 96.0, 0.0]],
        feet: [[0.05, 0.0, 0.15, 4.0, 0.0], [0.06, 0.0, -0.17, 28.0, 14.0]],
        ..STAND
    };
    let jab = Posture {
        hips: [0.01, -0.080, 0.05],
        tilt: [6.0, -24.0, 0.0],
        spine: [8.0, -8.0, 0.0],
        arms: [[28.0, 86.0, 0.0, 8.0, 0.0], guard.arms[1]],
        ..guard
    };
    let cross = Posture {
        hips: [0.02, -0.085, 0.07],
        tilt: [6.0, 10.0, 0.0],
        spine: [10.0, 26.0, 0.0],
        head: [2.0, -14.0, 0.0],
        arms: [[34.0, 44.0, 4.0, 94.0, 0.0], [30.0, 88.0, 0.0, 8.0, 0.0]],
        feet: [guard.feet[0], [0.06, 0.0, -0.17, 14.0, 34.0]],
        ..guard
    };
    let hook = Posture {
        hips: [-0.02, -0.080, 0.02],
        tilt: [4.0, -30.0, 0.0],
        spine: [6.0, -24.0, -3.0],
        head: [2.0, 22.0, 0.0],
        arms: [[72.0, 52.0, -20.0, 74.0, 0.0], guard.arms[1]],
        ..guard
    };
    let keys = [guard, jab, guard, cross, guard, jab, cross, guard, hook, guard];
    let times = [0.0, 0.45, 0.9, 1.4, 2.0, 2.5, 3.0, 3.6, 4.2, 4.8];
    Move { name: "punch", period: 5.4, keys: times.into_iter().zip(keys).collect() }
}

/// Two jumps on the spot, the second with knees drawn up.
fn jump() -> Move {
    let feet = |up: f64, heel: f64| [[0.03, up, 0.0, 8.0, heel]; 2];
    let low = Posture {
        hips: [0.0, -0.240, -0.09],
        tilt: [20.0, 0.0, 0.0],
        spine: [16.0, 0.0, 0.0],
        head: [-18.0, 0.0, 0.0],
        arms: [[26.0, -40.0, 0.0, 16.0, 0.0]; 2],
        feet: feet(0.0, 4.0),
        ..STAND
    };
    let off = Posture {
        hips: [0.0, 0.040, 0.0],
        spine: [-4.0, 0.0, 0.0],
        arms: [[112.0, 34.0, 10.0, 14.0, 0.0]; 2],
        feet: feet(0.02, 40.0),
        ..STAND
    };
    let high =
        Posture { hips: [0.0, 0.200, 0.0], arms: [[150.0, 10.0, 16.0, 14.0, 0.0]; 2], feet: feet(0.20, 44.0), ..off };
    let tucked = Posture {
        hips: [0.0, 0.210, -0.02],
        tilt: [8.0, 0.0, 0.0],
        spine: [18.0, 0.0, 0.0],
        arms: [[70.0, 46.0, 0.0, 40.0, 0.0]; 2],
        feet: [[0.05, 0.43, 0.06, 8.0, 24.0]; 2],
        ..STAND
    };
    let soft = Posture { arms: [[46.0, 20.0, 0.0, 30.0, 0.0]; 2], hips: [0.0, -0.180, -0.06], ..low };
    let keys = [STAND, low, off, high, off, soft, STAND, low, off, tucked, off, soft];
    let times = [0.0, 0.8, 1.1, 1.35, 1.6, 1.95, 2.7, 3.5, 3.8, 4.08, 4.36, 4.7];
    Move { name: "jump", period: 5.6, keys: times.into_iter().zip(keys).collect() }
}

/// Jumping jacks: feet together and apart, arms from the sides to overhead.
fn jacks() -> Move {
    let posture = |open: f64, up: f64| Posture {
        hips: [0.0, -0.035 - 0.03 * open + up, 0.0],
        arms: [[22.0 + 126.0 * open, 6.0, 14.0 * open, 14.0, 0.0]; 2],
        feet: [[0.02 + 0.17 * open, up, 0.0, 10.0, 6.0 + 300.0 * up]; 2],
        ..STAND
    };
    let cycle = [posture(0.0, 0.0), posture(0.45, 0.045), posture(1.0, 0.0), posture(0.55, 0.045)];
    Move { name: "jumping jacks", period: 6.4, keys: (0..16).map(|i| (0.4 * i as f64, cycle[i % 4])).collect() }
}

/// Two steps to the left and back, then to the right.
fn side_step() -> Move {
    let step = |hips: f64, down: f64, left: [f64; 2], right: [f64; 2], lean: f64| Posture {
        hips: [hips, down, 0.0],
        tilt: [3.0, 0.0, 0.5 * lean],
        spine: [5.0, 0.0, -lean],
        head: [0.0, 12.0, 0.0],
        arms: [[34.0 + lean, 24.0, 6.0, 50.0, 4.0], [34.0 - lean, 24.0, 6.0, 50.0, 4.0]],
        feet: [[left[0], left[1], 0.0, 10.0, 220.0 * left[1]], [right[0], right[1], 0.0, 10.0, 220.0 * right[1]]],
        ..STAND
    };
    let away = [
        step(0.0, -0.04, [0.01, 0.0], [0.01, 0.0], 0.0),
        step(0.0, -0.05, [0.14, 0.08], [0.02, 0.0], -5.0),
        step(0.13, -0.09, [0.28, 0.0], [0.02, 0.0], 3.0),
        step(0.24, -0.05, [0.28, 0.0], [-0.12, 0.08], 6.0),
        step(0.27, -0.04, [0.28, 0.0], [-0.26, 0.0], 0.0),
    ];
    let mut out: Vec<Posture> = away.to_vec();
    out.extend([
        step(0.27, -0.05, [0.28, 0.0], [-0.13, 0.08], 5.0),
        step(0.15, -0.09, [0.28, 0.0], [0.0, 0.0], -3.0),
        step(0.04, -0.05, [0.14, 0.08], [0.0, 0.0], -6.0),
    ]);
    let both = out.iter().copied().chain(out.iter().map(Posture::mirrored)).enumerate();
    Move { name: "side step", period: 7.2, keys: both.map(|(i, posture)| (0.45 * i as f64, posture)).collect() }
}

/// Winds up, steps and throws, with either hand.
fn throw() -> Move {
    let wound = Posture {
        hips: [-0.035, -0.060, -0.06],
        tilt: [-4.0, -34.0, 0.0],
        spine: [-6.0, -26.0, -8.0],
        head: [0.0, 44.0, 0.0],
        arms: [[72.0, 44.0, 10.0, 30.0, 0.0], [96.0, -14.0, 70.0, 84.0, -6.0]],
        feet: [[0.03, 0.06, 0.10, 4.0, 8.0], [0.04, 0.0, -0.14, 34.0, 0.0]],
        ..STAND
    };
    let thrown = Posture {
        hips: [0.03, -0.110, 0.12],
        tilt: [14.0, 16.0, 0.0],
        spine: [20.0, 24.0, 6.0],
        head: [-8.0, -22.0, 0.0],
        arms: [[46.0, -16.0, 10.0, 40.0, 0.0], [54.0, 84.0, 6.0, 14.0, 10.0]],
        feet: [[0.03, 0.0, 0.30, 4.0, 0.0], [0.03, 0.0, -0.20, 16.0, 44.0]],
        ..STAND
    };
    let half = [(0.0, STAND), (0.9, wound), (1.2, wound), (1.75, thrown), (2.1, thrown)];
    let right = half.iter().map(|&(time, posture)| (time + 3.1, posture.mirrored()));
    Move { name: "throw", period: 6.2, keys: half.iter().copied().chain(right).collect() }
}

/// Both fists in the air, then one after the other, bouncing.
fn cheer() -> Move {
    let up = |left: f64, right: f64, bounce: f64| {
        let arm = |share: f64| [44.0 + 104.0 * share, 26.0 - 18.0 * share, 30.0, 94.0 - 76.0 * share, 0.0];
        Posture {
            hips: [0.02 * (right - left), -0.030 - 0.05 * bounce, 0.0],
            tilt: [0.0, 0.0, 3.0 * (right - left)],
            spine: [-3.0 - 5.0 * left.min(right), 6.0 * (left - right), 7.0 * (right - left)],
            head: [-10.0, 0.0, 4.0 * (right - left)],
            arms: [arm(left), arm(right)],
            feet: [[0.05, 0.0, 0.0, 12.0, 12.0 * (1.0 - bounce)], [0.05, 0.0, 0.0, 12.0, 12.0 * (1.0 - bounce)]],
            ..STAND
        }
    };
    let mut keys = vec![(0.0, STAND), (0.6, up(0.1, 0.1, 1.0))];
    let beats = [(1.0, 1.0), (0.55, 0.55), (1.0, 1.0), (0.3, 0.3), (1.0, 0.1), (0.1, 1.0), (1.0, 0.1), (0.1, 1.0)];
    let beat = |(i, &(left, right)): (usize, &(f64, f64))| (1.1 + 0.5 * i as f64, up(left, right, (i % 2) as f64));
    keys.extend(beats.iter().enumerate().map(beat));
    keys.push((5.3, Posture { feet: [FOOT; 2], ..up(0.0, 0.0, 0.6) }));
    keys.push((5.8, Posture { feet: wide(0.01), ..STAND }));
    Move { name: "cheer", period: 6.4, keys }
}
