//! Moves as key postures: (seconds, posture), closed and C¹ by [`through`](crate::motion::curve::through).
//! Arms stay clear of the trunk: cloth caught in an armpit has no unique rest state.

use super::calm::calm;
use super::exercises::exercises;
use super::posture::{FOOT, Move, Posture, STAND, wide};
use super::sport::sport;

/// Every move made of key postures.
pub fn moves() -> Vec<Move> {
    let mut all = vec![look_around(), dance(), groove(), wave()];
    all.extend(exercises());
    all.extend(calm());
    all.extend(sport());
    all
}

fn look_around() -> Move {
    let left = Posture {
        hips: [0.035, -0.016, 0.0],
        tilt: [0.0, 6.0, -3.0],
        spine: [0.0, 14.0, 4.0],
        head: [3.0, 42.0, 3.0],
        ..STAND
    };
    let down = Posture { spine: [10.0, 0.0, 0.0], head: [24.0, 0.0, 0.0], hips: [0.0, -0.02, -0.01], ..STAND };
    let up =
        Posture { spine: [-9.0, 0.0, 0.0], head: [-22.0, 0.0, 0.0], arms: [[28.0, -4.0, 10.0, 14.0, 0.0]; 2], ..STAND };
    let keys = vec![
        (0.0, STAND),
        (1.2, left),
        (2.0, left),
        (3.1, left.mirrored()),
        (3.9, left.mirrored()),
        (4.9, down),
        (6.0, up),
    ];
    Move { name: "look around", period: 7.0, keys }
}

/// Side steps with arms that rise and cross over the head.
fn dance() -> Move {
    let feet = |lifted: f64| {
        [[0.09, 0.0, 0.0, 12.0, 0.0], [0.09 - 0.05 * lifted, 0.07 * lifted, 0.03 * lifted, 12.0, 18.0 * lifted]]
    };
    let low = Posture {
        hips: [0.075, -0.060, 0.0],
        tilt: [2.0, 14.0, 7.0],
        spine: [3.0, -18.0, -13.0],
        head: [2.0, 16.0, 6.0],
        arms: [[62.0, 28.0, 10.0, 62.0, 8.0], [54.0, -14.0, 20.0, 38.0, 0.0]],
        feet: feet(1.0),
        ..STAND
    };
    let high = Posture {
        hips: [0.055, -0.030, 0.0],
        tilt: [0.0, -12.0, 5.0],
        spine: [-6.0, 20.0, 9.0],
        head: [-8.0, -12.0, 4.0],
        arms: [[142.0, 8.0, 38.0, 34.0, 6.0], [112.0, 18.0, 60.0, 56.0, 8.0]],
        feet: feet(0.6),
        ..STAND
    };
    let open = Posture {
        hips: [0.0, -0.075, 0.0],
        tilt: [4.0, 0.0, 0.0],
        spine: [4.0, 0.0, 0.0],
        arms: [[88.0, 6.0, 46.0, 40.0, 0.0]; 2],
        feet: feet(0.0),
        ..STAND
    };
    let turned =
        Posture { tilt: [2.0, 26.0, 0.0], spine: [2.0, 26.0, 0.0], head: [0.0, -18.0, 0.0], heading: 16.0, ..open };
    let flip = |posture: &Posture| posture.mirrored();
    let keys = [
        open,
        low,
        open,
        flip(&low),
        open,
        high,
        open,
        flip(&high),
        open,
        turned,
        low,
        flip(&turned),
        open,
        flip(&low),
        high,
        flip(&high),
    ];
    Move {
        name: "dance",
        period: 8.0,
        keys: keys.iter().enumerate().map(|(i, &posture)| (0.5 * i as f64, posture)).collect(),
    }
}

/// Hips in circles against the chest, elbows out.
fn groove() -> Move {
    let at = |i: i32| {
        let angle = f64::from(i) * std::f64::consts::FRAC_PI_4;
        let (s, c) = angle.sin_cos();
        let lift = 0.5 + 0.5 * (0.5 * angle).sin();
        Posture {
            hips: [0.060 * c, -0.050 - 0.012 * (2.0 * angle).cos(), 0.035 * s],
            tilt: [-7.0 * s, 10.0 * s, 9.0 * c],
            spine: [9.0 * s, -22.0 * s, -14.0 * c],
            head: [-4.0 * s, 10.0 * s, 7.0 * c],
            arms: [
                [48.0 + 40.0 * lift, 18.0 - 16.0 * s, 24.0 * lift, 66.0 + 14.0 * c, 0.0],
                [88.0 - 40.0 * lift, 18.0 + 16.0 * s, 24.0 - 24.0 * lift, 66.0 - 14.0 * c, 0.0],
            ],
            feet: wide(0.075),
            ..STAND
        }
    };
    Move { name: "groove", period: 6.4, keys: (0..16).map(|i| (0.4 * f64::from(i), at(i))).collect() }
}

/// Waves with one arm, the weight on the other leg, then with both.
fn wave() -> Move {
    let hand = |twist: f64, elbow: f64| Posture {
        hips: [-0.040, -0.018, 0.0],
        tilt: [0.0, 4.0, -4.0],
        spine: [-2.0, 8.0, -2.0],
        head: [-2.0, 10.0, 6.0],
        arms: [[98.0, 14.0, twist, elbow, -6.0], [24.0, -6.0, 0.0, 24.0, 5.0]],
        feet: [[0.03, 0.0, 0.02, 14.0, 0.0], FOOT],
        ..STAND
    };
    let both = |twist: f64, elbow: f64| Posture {
        hips: [0.0, -0.015, 0.0],
        spine: [-5.0, 0.0, 0.0],
        head: [-8.0, 0.0, 0.0],
        arms: [[126.0, 10.0, twist, elbow, -4.0]; 2],
        ..STAND
    };
    let (open, shut) = (hand(84.0, 42.0), hand(78.0, 88.0));
    let (wide, near) = (both(62.0, 22.0), both(62.0, 62.0));
    let mut keys = vec![
        (0.0, STAND),
        (0.9, open),
        (1.25, shut),
        (1.6, open),
        (1.95, shut),
        (2.3, open),
        (2.65, shut),
        (3.6, STAND),
    ];
    keys.extend([(4.6, wide), (5.0, near), (5.4, wide), (5.8, near), (6.2, wide)]);
    Move { name: "wave", period: 7.2, keys }
}
