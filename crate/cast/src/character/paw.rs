//! Paws, eyes and soft paint: parts that the animals share, as rows placed and sized by arguments.
//! Lengths in metres; the left ones stand for both sides.

use super::figure::{PART, Part};
use super::loft::Role;

type Influence = &'static [(&'static str, f64, f64)];

const UP: [f64; 3] = [0.0, 1.0, 0.0];
const FORWARD: [f64; 3] = [0.0, 0.0, 1.0];

/// Sections of a paw 1 long and 1 high, from the heel on. Front is up; centre = back keeps the sole on the ground.
const PAW: &[[f64; 5]] =
    &[[0.10, 0.50, 0.36, 0.50, 0.50], [0.45, 0.50, 0.46, 0.50, 0.50], [0.80, 0.40, 0.44, 0.40, 0.40]];

/// A paw whose heel stands at `heel`: width, height and length in `size`.
pub const fn paw(heel: [f64; 3], size: [f64; 3], colour: [f32; 3], joints: Influence) -> Part {
    let paw = Part::loft(heel, PAW, [0.10, 0.18]).along(FORWARD, UP).size(size).exponent(2.3);
    paw.blend(0.4 * size[1], 0.2 * size[0]).on(joints).coloured(colour)
}

/// Toe `i` of four of the paw with the same `heel` and `size`.
pub const fn toe(heel: [f64; 3], size: [f64; 3], i: usize, colour: [f32; 3], joints: Influence) -> Part {
    let across = [-0.34, -0.12, 0.12, 0.34][i] * size[0];
    let ahead = [0.74, 0.88, 0.88, 0.74][i] * size[2];
    let toe = Part::ball(
        [heel[0] + across, 0.30 * size[1], heel[2] + ahead],
        [0.145 * size[0], 0.19 * size[2], 0.30 * size[1]],
    );
    toe.blend(0.10 * size[0], 0.12 * size[0]).on(joints).coloured(colour)
}

/// An eyeball in shell 1 that looks along `gaze`, with rim and pupil painted on. `size`: radius of the ball, half width
/// and half height of the pupil.
pub const fn eye(at: [f64; 3], gaze: [f64; 3], size: [f64; 3], iris: [f32; 3]) -> [Part; 3] {
    let [radius, wide, high] = size;
    let ball = Part::ball(at, [radius; 3]).along(gaze, UP).blend(0.0, 0.14 * radius).shell(1);
    let whole = ball.on(&[("Head", 0.0, 0.01)]).coloured(iris);
    let dark = ball.role(Role::Paint).coloured([0.012, 0.008, 0.006]);
    let behind = 0.36 * radius;
    let centre = [at[0] - behind * gaze[0], at[1] - behind * gaze[1], at[2] - behind * gaze[2]];
    let rim = Part { start: centre, ..dark.size([1.6 * radius, 1.6 * radius, 0.98 * radius]) };
    [whole, rim, dark.size([wide, high, 1.5 * radius])]
}

/// Paint within an ellipsoid of half-axes `size` (x, y, z), with a border `soft` metres wide.
pub const fn paint(at: [f64; 3], size: [f64; 3], colour: [f32; 3], soft: f64) -> Part {
    let ball = Part { start: at, along: FORWARD, front: UP, size, ..PART };
    ball.role(Role::Paint).coloured(colour).blend(soft, 0.02)
}
