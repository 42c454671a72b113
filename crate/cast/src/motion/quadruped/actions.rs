//! Quick moves: shake, pounce, jump, rear up, wag, roll the shoulders, swat, turn on the spot, lean.
//! Lengths in leg lengths, angles in degrees; see [`Stance`] for the channels.

use super::stance::{LIE, Move, STAND, Stance, even};

/// The moves of this file. Scratching behind the ear was tried and dropped: the hock passes the hip, folded past 150°.
pub fn actions() -> Vec<Move> {
    vec![shake(), pounce(), jump(), rear(), wag(), shoulders(), swat(), turn(), sway(), creep()]
}

const PLANTED: [f64; 4] = [0.0; 4];

/// Shakes water off: a twist that runs from the head to the tail.
fn shake() -> Move {
    let at = |i: i32| {
        let angle = f64::from(i) * std::f64::consts::FRAC_PI_2;
        let strength = [0.3, 0.8, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.9, 0.7, 0.4, 0.2][i as usize];
        let wave = |lag: f64| strength * (angle - lag).sin();
        Stance {
            hips: [0.02 * wave(1.2), -0.07, 0.0],
            trunk: [-2.0, 3.0 * wave(0.6), 13.0 * wave(0.9)],
            spine: [6.0, 8.0 * wave(0.4), 22.0 * wave(0.3)],
            neck: [-24.0, 12.0 * wave(0.2), 20.0 * wave(0.2)],
            head: [-26.0, 16.0 * wave(0.0), 40.0 * wave(0.0)],
            tail: [16.0, 20.0 * wave(1.8), 10.0, 40.0 * wave(2.4)],
            ears: 14.0,
            paws: [[0.05, 0.0, -0.03, 0.0], [0.05, 0.0, -0.03, 0.0], [0.06, 0.0, 0.0, 0.0], [0.06, 0.0, 0.0, 0.0]],
            ..STAND
        }
    };
    let mut keys: Vec<_> = (0..12).map(|i| (0.6 + 0.16 * f64::from(i), at(i))).collect();
    keys.insert(0, (0.0, STAND));
    keys.push((3.2, STAND));
    Move { name: "shake", period: 4.0, keys }
}

/// Low with a wriggle of the rump, then a high leap onto the forepaws.
fn pounce() -> Move {
    let low = |side: f64| Stance {
        hips: [0.05 * side, -0.30, -0.06],
        trunk: [-3.0, 5.0 * side, 0.0],
        spine: [16.0, -8.0 * side, 0.0],
        neck: [-24.0, 0.0, 0.0],
        head: [-6.0, 0.0, 0.0],
        tail: [24.0, 16.0 * side, 14.0, 40.0 * side],
        paws: [[0.03, 0.0, 0.02, -22.0], [0.03, 0.0, 0.02, -22.0], [0.02, 0.0, 0.10, -4.0], [0.02, 0.0, 0.10, -4.0]],
        ..STAND
    };
    let off = Stance {
        hips: [0.0, 0.10, 0.16],
        trunk: [30.0, 0.0, 0.0],
        spine: [-8.0, 0.0, 0.0],
        neck: [-16.0, 0.0, 0.0],
        head: [-18.0, 0.0, 0.0],
        tail: [10.0, 0.0, 10.0, 0.0],
        paws: [[0.0, 0.0, 0.0, 34.0], [0.0, 0.0, 0.0, 34.0], [0.0, 0.52, 0.26, 66.0], [0.0, 0.52, 0.26, 66.0]],
        ..STAND
    };
    let high = Stance {
        hips: [0.0, 0.55, 0.28],
        trunk: [-8.0, 0.0, 0.0],
        spine: [32.0, 0.0, 0.0],
        neck: [-44.0, 0.0, 0.0],
        head: [-46.0, 0.0, 0.0],
        tail: [40.0, 0.0, 20.0, 0.0],
        paws: [[0.0, 0.52, 0.34, 40.0], [0.0, 0.52, 0.34, 40.0], [-0.02, 0.46, 0.40, 40.0], [-0.02, 0.46, 0.40, 40.0]],
        ..STAND
    };
    let down = Stance {
        hips: [0.0, 0.18, 0.20],
        trunk: [-34.0, 0.0, 0.0],
        spine: [24.0, 0.0, 0.0],
        neck: [-46.0, 0.0, 0.0],
        head: [-58.0, 0.0, 0.0],
        tail: [70.0, 0.0, 26.0, 0.0],
        paws: [[0.0, 0.26, 0.26, 46.0], [0.0, 0.20, 0.22, 46.0], [-0.02, 0.0, 0.34, 0.0], [-0.02, 0.0, 0.34, 0.0]],
        ..STAND
    };
    let keys = vec![
        (0.0, STAND),
        (0.8, low(0.0)),
        (1.1, low(1.0)),
        (1.4, low(-1.0)),
        (1.7, low(1.0)),
        (2.0, low(-1.0)),
        (2.4, low(0.0)),
        (2.62, off),
        (2.90, high),
        (3.18, down),
        (3.6, Stance { hips: [0.0, -0.10, 0.04], neck: [-60.0, 0.0, 0.0], head: [-50.0, 0.0, 0.0], ..STAND }),
    ];
    Move { name: "pounce", period: 4.6, keys }
}

/// Straight up, legs gathered.
fn jump() -> Move {
    let low = Stance {
        hips: [0.0, -0.30, 0.0],
        trunk: [3.0, 0.0, 0.0],
        spine: [18.0, 0.0, 0.0],
        head: [12.0, 0.0, 0.0],
        tail: [26.0, 0.0, 10.0, 0.0],
        paws: [[0.0, 0.0, 0.08, -14.0], [0.0, 0.0, 0.08, -14.0], PLANTED, PLANTED],
        ..STAND
    };
    let off = Stance {
        hips: [0.0, 0.14, 0.02],
        trunk: [22.0, 0.0, 0.0],
        spine: [-10.0, 0.0, 0.0],
        neck: [6.0, 0.0, 0.0],
        head: [24.0, 0.0, 0.0],
        tail: [40.0, 0.0, 12.0, 0.0],
        paws: [[0.0, 0.0, 0.0, 30.0], [0.0, 0.0, 0.0, 30.0], [0.0, 0.42, 0.06, 60.0], [0.0, 0.42, 0.06, 60.0]],
        ..STAND
    };
    let high = Stance {
        hips: [0.0, 0.62, 0.04],
        trunk: [6.0, 0.0, 0.0],
        spine: [22.0, 0.0, 0.0],
        head: [4.0, 0.0, 0.0],
        tail: [44.0, 0.0, 16.0, 0.0],
        paws: [[0.0, 0.78, 0.14, 44.0], [0.0, 0.78, 0.14, 44.0], [0.0, 0.80, 0.10, 62.0], [0.0, 0.80, 0.10, 62.0]],
        ..STAND
    };
    let land = Stance {
        hips: [0.0, 0.06, 0.0],
        trunk: [-10.0, 0.0, 0.0],
        spine: [4.0, 0.0, 0.0],
        tail: [44.0, 0.0, 16.0, 0.0],
        paws: [[0.0, 0.14, 0.06, 14.0], [0.0, 0.14, 0.06, 14.0], [0.0, 0.0, 0.08, 0.0], [0.0, 0.0, 0.08, 0.0]],
        ..STAND
    };
    let keys = vec![(0.0, STAND), (0.6, low), (0.9, low), (1.16, off), (1.46, high), (1.78, land), (2.12, low)];
    Move { name: "jump", period: 3.2, keys }
}

/// Up on the hind legs, forepaws at play.
fn rear() -> Move {
    let up = Stance {
        hips: [0.0, -0.16, -0.06],
        trunk: [58.0, 0.0, 0.0],
        spine: [-4.0, 0.0, 0.0],
        neck: [-14.0, 0.0, 0.0],
        head: [4.0, 0.0, 0.0],
        tail: [36.0, 0.0, 14.0, 0.0],
        paws: [
            [0.07, 0.0, 0.22, -8.0],
            [0.07, 0.0, 0.22, -8.0],
            [-0.02, 0.74, -0.02, 70.0],
            [-0.02, 0.74, -0.02, 70.0],
        ],
        ..STAND
    };
    let begin = Stance {
        hips: [0.0, -0.28, -0.04],
        trunk: [22.0, 0.0, 0.0],
        spine: [8.0, 0.0, 0.0],
        tail: [34.0, 0.0, 12.0, 0.0],
        paws: [[0.04, 0.0, 0.12, -18.0], [0.04, 0.0, 0.12, -18.0], [0.0, 0.18, 0.06, 40.0], [0.0, 0.18, 0.06, 40.0]],
        ..STAND
    };
    let mut bat = Stance { head: [0.0, 22.0, 8.0], spine: [-4.0, 12.0, 0.0], tail: [36.0, 14.0, 14.0, 26.0], ..up };
    bat.paws[2] = [0.02, 0.96, 0.22, 40.0];
    bat.paws[3] = [-0.02, 0.70, 0.02, 74.0];
    even("rear up", 0.6, &[STAND, begin, up, bat, bat.mirrored(), bat, bat.mirrored(), up, begin])
}

/// Wags with the whole hindquarters.
fn wag() -> Move {
    let at = |i: usize| {
        let side = if i % 4 < 2 { 1.0 } else { -1.0 } * if i.is_multiple_of(2) { 1.0 } else { 0.45 };
        let lift = [20.0, 30.0, 44.0, 52.0, 58.0, 52.0, 40.0, 28.0][i / 2 % 8];
        Stance {
            hips: [-0.03 * side, -0.04, 0.0],
            trunk: [0.0, -4.0 * side, 0.0],
            spine: [4.0, 12.0 * side, 4.0 * side],
            neck: [8.0, 6.0 * side, 0.0],
            head: [10.0, 8.0 * side, 6.0 * side],
            tail: [lift, 34.0 * side, 12.0, 44.0 * side],
            ears: 16.0,
            ..STAND
        }
    };
    let stances: Vec<Stance> = (0..16).map(at).collect();
    even("wag", 0.24, &stances)
}

/// Shoulder blades by turns, as before a leap.
fn shoulders() -> Move {
    let left = Stance {
        hips: [0.05, -0.10, 0.0],
        trunk: [-9.0, 5.0, 9.0],
        spine: [4.0, 10.0, 8.0],
        neck: [-10.0, -12.0, 0.0],
        head: [0.0, -8.0, 0.0],
        tail: [20.0, -14.0, 14.0, -26.0],
        paws: [[0.02, 0.0, 0.06, -8.0], PLANTED, [0.0, 0.0, 0.14, -6.0], [0.0, 0.0, -0.10, 6.0]],
        ..STAND
    };
    let low = Stance { hips: [0.0, -0.14, 0.0], trunk: [-12.0, 0.0, 0.0], head: [4.0, 0.0, 0.0], ..STAND };
    even("roll shoulders", 0.65, &[STAND, left, low, left.mirrored(), low, left, low, left.mirrored()])
}

/// Bats with either forepaw.
fn swat() -> Move {
    let raised = Stance {
        hips: [-0.05, -0.05, -0.04],
        trunk: [5.0, 0.0, -3.0],
        spine: [2.0, 8.0, -4.0],
        neck: [2.0, 12.0, 0.0],
        head: [-4.0, 16.0, 0.0],
        paws: [PLANTED, PLANTED, [0.02, 0.42, 0.20, 76.0], [-0.03, 0.0, 0.0, 0.0]],
        ..STAND
    };
    let mut out = Stance { neck: [-12.0, 8.0, 0.0], ..raised };
    out.paws[2] = [-0.06, 0.62, 0.56, 12.0];
    let mut across = Stance { spine: [2.0, -10.0, 4.0], ..raised };
    across.paws[2] = [-0.24, 0.34, 0.48, 8.0];
    let half = [STAND, raised, out, across, raised, out, across, raised];
    let both: Vec<Stance> = half.iter().copied().chain(half.iter().map(Stance::mirrored)).collect();
    even("swat", 0.36, &both)
}

/// Steps round on the spot, to the left and back.
fn turn() -> Move {
    let step = |heading: f64, lead: f64, lifted: [usize; 2]| {
        let mut stance = Stance {
            heading,
            hips: [0.0, -0.05, 0.0],
            spine: [2.0, 26.0 * lead, 0.0],
            neck: [-2.0, 26.0 * lead, 0.0],
            head: [-2.0, 46.0 * lead, 0.0],
            tail: [10.0, 14.0 * lead, 10.0, 24.0 * lead],
            ..STAND
        };
        for paw in lifted {
            stance.paws[paw] = [0.03, 0.15, 0.02, 40.0];
        }
        stance
    };
    let keys: Vec<Stance> = (0..12)
        .map(|i| {
            let out = i < 6;
            let heading = if out { 15.0 * f64::from(i) } else { 15.0 * f64::from(12 - i) };
            let lead = [0.2, 1.0, 1.0, 1.0, 1.0, 0.4, -0.4, -1.0, -1.0, -1.0, -0.8, -0.2][i as usize];
            step(heading, lead, if i % 2 == 0 { [0, 3] } else { [1, 2] })
        })
        .collect();
    even("turn on the spot", 0.42, &keys)
}

/// Weight over each leg in turn, the trunk in a circle.
fn sway() -> Move {
    let at = |i: i32| {
        let (s, c) = (f64::from(i) * std::f64::consts::FRAC_PI_4).sin_cos();
        Stance {
            hips: [0.10 * s, -0.10 + 0.03 * c, 0.09 * c],
            trunk: [-5.0 * c, 6.0 * s, 6.0 * s],
            spine: [10.0 * c, -20.0 * s, -8.0 * s],
            neck: [8.0 * c, 22.0 * s, 0.0],
            head: [6.0 * c, 30.0 * s, 6.0 * s],
            tail: [24.0 + 14.0 * c, -24.0 * s, 14.0, -40.0 * s],
            paws: [[0.06, 0.0, 0.0, 0.0]; 4],
            ..STAND
        }
    };
    even("sway", 0.5, &(0..8).map(at).collect::<Vec<_>>())
}

/// Down by stages with the nose low, a paw held up, then up again.
fn creep() -> Move {
    let low = Stance {
        hips: [0.0, -0.36, 0.0],
        trunk: [-3.0, 0.0, 0.0],
        spine: [10.0, 0.0, 0.0],
        neck: [-42.0, 0.0, 0.0],
        head: [-6.0, 0.0, 0.0],
        ears: 26.0,
        tail: [16.0, 0.0, 10.0, 0.0],
        paws: [[0.03, 0.0, 0.06, -24.0], [0.03, 0.0, 0.06, -24.0], [0.0, 0.0, 0.06, 0.0], [0.0, 0.0, 0.06, 0.0]],
        ..STAND
    };
    let mut held = Stance { hips: [-0.05, -0.30, 0.02], tail: [20.0, 8.0, 14.0, 22.0], ..low };
    held.paws[2] = [0.0, 0.16, 0.26, 30.0];
    let flat = Stance {
        hips: [0.0, -0.46, 0.04],
        neck: [-34.0, 0.0, 0.0],
        paws: LIE.paws.map(|[out, up, forward, heel]| [out, up, 0.8 * forward, 0.6 * heel]),
        ..low
    };
    even("crouch", 0.7, &[STAND, low, held, held, low, held.mirrored(), low, flat, flat, low])
}
