//! Moves as key postures: (seconds, posture), closed and C¹ by [`through`](super::posture::through).
//! Arms stay clear of the trunk: cloth caught in an armpit has no unique rest state.

use super::posture::Posture;

/// A move: its period in seconds and its keys.
pub struct Move {
    /// Name of the clip.
    pub name: &'static str,
    /// Seconds until it repeats.
    pub period: f64,
    /// Key postures in time order.
    pub keys: Vec<(f64, Posture)>,
}

const ARM: [f64; 5] = [21.0, 4.0, 0.0, 20.0, 5.0];
const FOOT: [f64; 5] = [0.01, 0.0, 0.0, 7.0, 0.0];

/// At ease: what every move starts from.
pub const STAND: Posture = Posture {
    heading: 0.0,
    hips: [0.0, -0.011, 0.0],
    tilt: [0.0; 3],
    spine: [0.0; 3],
    head: [0.0; 3],
    arms: [ARM; 2],
    feet: [FOOT; 2],
};

/// Feet apart by `width` more on either side.
fn wide(width: f64) -> [[f64; 5]; 2] {
    [[width, 0.0, 0.0, 14.0, 0.0]; 2]
}

/// Every move made of key postures.
pub fn moves() -> Vec<Move> {
    vec![look_around(), dance(), groove(), reach(), squat(), kick(), turn(), wave(), lunge()]
}

fn look_around() -> Move {
    let left = Posture { hips: [0.035, -0.016, 0.0], tilt: [0.0, 6.0, -3.0], spine: [0.0, 14.0, 4.0], head: [3.0, 42.0, 3.0], ..STAND };
    let down = Posture { spine: [10.0, 0.0, 0.0], head: [24.0, 0.0, 0.0], hips: [0.0, -0.02, -0.01], ..STAND };
    let up = Posture { spine: [-9.0, 0.0, 0.0], head: [-22.0, 0.0, 0.0], arms: [[28.0, -4.0, 10.0, 14.0, 0.0]; 2], ..STAND };
    let keys = vec![(0.0, STAND), (1.2, left), (2.0, left), (3.1, left.mirrored()), (3.9, left.mirrored()), (4.9, down), (6.0, up)];
    Move { name: "look around", period: 7.0, keys }
}

/// Side steps with arms that rise and cross over the head.
fn dance() -> Move {
    let feet = |lifted: f64| [[0.09, 0.0, 0.0, 12.0, 0.0], [0.09 - 0.05 * lifted, 0.07 * lifted, 0.03 * lifted, 12.0, 18.0 * lifted]];
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
    let turned = Posture { tilt: [2.0, 26.0, 0.0], spine: [2.0, 26.0, 0.0], head: [0.0, -18.0, 0.0], heading: 16.0, ..open };
    let flip = |posture: &Posture| posture.mirrored();
    let keys = [open, low, open, flip(&low), open, high, open, flip(&high), open, turned, low, flip(&turned), open, flip(&low), high, flip(&high)];
    Move { name: "dance", period: 8.0, keys: keys.iter().enumerate().map(|(i, &posture)| (0.5 * i as f64, posture)).collect() }
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
            arms: [[48.0 + 40.0 * lift, 18.0 - 16.0 * s, 24.0 * lift, 66.0 + 14.0 * c, 0.0], [88.0 - 40.0 * lift, 18.0 + 16.0 * s, 24.0 - 24.0 * lift, 66.0 - 14.0 * c, 0.0]],
            feet: wide(0.075),
            ..STAND
        }
    };
    Move { name: "groove", period: 6.4, keys: (0..16).map(|i| (0.4 * f64::from(i), at(i))).collect() }
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
        arms: [[44.0, 4.0, 0.0, 24.0, 0.0], [158.0, 4.0, 20.0, 22.0, 0.0]],
        feet: wide(0.05),
        ..STAND
    };
    let forward = Posture { hips: [0.0, -0.03, -0.06], tilt: [16.0, 0.0, 0.0], spine: [34.0, 0.0, 0.0], head: [6.0, 0.0, 0.0], arms: [[18.0, 92.0, 0.0, 14.0, 0.0]; 2], ..STAND };
    let keys = vec![(0.0, STAND), (1.3, up), (2.0, up), (3.1, side), (3.8, side), (4.9, side.mirrored()), (5.6, side.mirrored()), (6.7, forward)];
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
    let half = Posture { hips: [0.0, -0.13, -0.05], tilt: [12.0, 0.0, 0.0], spine: [8.0, 0.0, 0.0], arms: [[28.0, 40.0, 0.0, 24.0, 0.0]; 2], feet: wide(0.07), ..STAND };
    let bend = Posture { hips: [0.0, -0.05, -0.13], tilt: [42.0, 0.0, 0.0], spine: [44.0, 0.0, 0.0], head: [10.0, 0.0, 0.0], arms: [[22.0, 70.0, 0.0, 10.0, 0.0]; 2], ..STAND };
    let keys = vec![(0.0, STAND), (0.7, half), (1.5, low), (2.1, low), (2.9, half), (3.7, STAND), (4.8, bend), (5.4, bend)];
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
        feet: [ready.feet[0], [-0.01, 0.78, 0.76, 4.0, 8.0]],
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
        let mut posture = Posture { heading, hips: [if lifted == 0 { -0.045 } else { 0.045 }, -0.028, 0.0], spine: [2.0, 10.0, 0.0], head: [0.0, 22.0, 0.0], ..STAND };
        posture.feet[lifted] = [0.03, 0.085, 0.0, 16.0, 18.0];
        posture.arms[lifted][1] = 18.0;
        posture.arms[1 - lifted][1] = -8.0;
        posture
    };
    let looking = Posture { head: [0.0, -10.0, 0.0], heading: 75.0, ..STAND };
    let out = [(0.0, STAND), (0.4, step(14.0, 0)), (0.8, step(34.0, 1)), (1.2, step(54.0, 0)), (1.6, step(70.0, 1)), (2.1, looking), (2.7, looking)];
    let back = |heading: f64, lifted: usize| Posture { heading, ..step(-heading, 1 - lifted).mirrored() };
    let home = [(3.1, back(62.0, 1)), (3.5, back(40.0, 0)), (3.9, back(18.0, 1)), (4.4, STAND)];
    let left: Vec<(f64, Posture)> = out.into_iter().chain(home).collect();
    let right = left.iter().map(|&(time, posture)| (time + 4.6, posture.mirrored()));
    Move { name: "turn", period: 9.2, keys: left.iter().copied().chain(right).collect() }
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
    let both = |twist: f64, elbow: f64| Posture { hips: [0.0, -0.015, 0.0], spine: [-5.0, 0.0, 0.0], head: [-8.0, 0.0, 0.0], arms: [[126.0, 10.0, twist, elbow, -4.0]; 2], ..STAND };
    let (open, shut) = (hand(84.0, 42.0), hand(78.0, 88.0));
    let (wide, near) = (both(62.0, 22.0), both(62.0, 62.0));
    let mut keys = vec![(0.0, STAND), (0.9, open), (1.25, shut), (1.6, open), (1.95, shut), (2.3, open), (2.65, shut), (3.6, STAND)];
    keys.extend([(4.6, wide), (5.0, near), (5.4, wide), (5.8, near), (6.2, wide)]);
    Move { name: "wave", period: 7.2, keys }
}

/// Lunges to the front and the side, arms stretched out.
fn lunge() -> Move {
    let front = Posture {
        hips: [0.0, -0.20, 0.10],
        tilt: [3.0, -6.0, 0.0],
        spine: [4.0, 6.0, 0.0],
        arms: [[84.0, 30.0, 10.0, 12.0, 0.0], [86.0, -18.0, 10.0, 12.0, 0.0]],
        feet: [[0.02, 0.0, 0.42, 4.0, 0.0], [0.03, 0.0, -0.40, 14.0, 40.0]],
        ..STAND
    };
    let lifted = Posture { hips: [-0.055, -0.02, 0.0], arms: [[50.0, 20.0, 4.0, 30.0, 0.0]; 2], feet: [[0.0, 0.12, 0.10, 4.0, 10.0], FOOT], ..STAND };
    let half = [(0.0, STAND), (0.6, lifted), (1.3, front), (1.9, front), (2.6, lifted)];
    let right = half.iter().map(|&(time, posture)| (time + 3.3, posture.mirrored()));
    Move { name: "lunge", period: 6.6, keys: half.iter().copied().chain(right).collect() }
}
