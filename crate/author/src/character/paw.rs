//! Paws, ears and eyes of the four-legged: parts that the cat and the fox share, as rows placed and sized by arguments.
//! Lengths in metres; the left ones stand for both sides.

use super::figure::{PART, Part};

type Influence = &'static [(&'static str, f64, f64)];

const UP: [f64; 3] = [0.0, 1.0, 0.0];
const FORWARD: [f64; 3] = [0.0, 0.0, 1.0];

/// Of a paw 1 long and 1 high, its heel over the start: front is up, and centre - back = 0 at the ground.
const PAW: &[[f64; 5]] =
    &[[0.10, 0.50, 0.36, 0.50, 0.50], [0.45, 0.50, 0.46, 0.50, 0.50], [0.80, 0.40, 0.44, 0.40, 0.40]];

/// A paw whose heel stands at `heel`: width, height and length in `size`.
pub const fn paw(heel: [f64; 3], size: [f64; 3], colour: [f32; 3], joints: Influence) -> Part {
    Part {
        start: heel,
        along: FORWARD,
        front: UP,
        sections: PAW,
        size,
        caps: [0.10, 0.18],
        exponent: 2.3,
        blend: 0.4 * size[1],
        colour: Some(colour),
        edge: 0.2 * size[0],
        joints,
        ..PART
    }
}

/// The toe number `i` of four, of the paw of the same place and size.
pub const fn toe(heel: [f64; 3], size: [f64; 3], i: usize, colour: [f32; 3], joints: Influence) -> Part {
    let across = [-0.34, -0.12, 0.12, 0.34][i] * size[0];
    let ahead = [0.86, 1.0, 1.0, 0.86][i] * size[2];
    Part {
        start: [heel[0] + across, 0.30 * size[1], heel[2] + ahead - 0.12 * size[2]],
        size: [0.145 * size[0], 0.30 * size[1], 0.19 * size[2]],
        along: FORWARD,
        front: UP,
        blend: 0.10 * size[0],
        colour: Some(colour),
        edge: 0.12 * size[0],
        joints,
        ..PART
    }
}

/// A ball of the half-axes `size` (side, up, forward) at `at`.
pub const fn ball(at: [f64; 3], size: [f64; 3], joints: Influence) -> Part {
    Part { start: at, along: FORWARD, front: UP, size, joints, ..PART }
}

/// An eyeball of shell 1 with its pupil painted on, looking along `gaze`. `size`: its radius, then the pupil's half width
/// and half height.
pub const fn eye(at: [f64; 3], gaze: [f64; 3], size: [f64; 3], iris: [f32; 3]) -> [Part; 3] {
    let [radius, wide, high] = size;
    let whole = Part {
        size: [radius; 3],
        shell: 1,
        colour: Some(iris),
        edge: 0.14 * radius,
        joints: &[("Head", 0.0, 0.01)],
        start: at,
        along: gaze,
        front: UP,
        ..PART
    };
    let paint = super::loft::Role::Paint;
    let rim = Part {
        start: [at[0] - 0.36 * radius * gaze[0], at[1] - 0.36 * radius * gaze[1], at[2] - 0.36 * radius * gaze[2]],
        size: [1.6 * radius, 1.6 * radius, 0.98 * radius],
        role: paint,
        blend: 0.15 * radius,
        colour: Some([0.012, 0.008, 0.006]),
        ..whole
    };
    let pupil = Part { size: [wide, high, 1.5 * radius], role: paint, blend: 0.25 * wide, colour: rim.colour, ..whole };
    [whole, rim, pupil]
}
