//! Paws, eyes and soft paint: parts that the animals share, as rows placed and sized by arguments.
//! Lengths in metres; the left ones stand for both sides.

use super::figure::{PART, Part};
use super::loft::Role;

type Influence = &'static [(&'static str, f64, f64)];

const UP: [f64; 3] = [0.0, 1.0, 0.0];
const FORWARD: [f64; 3] = [0.0, 0.0, 1.0];

/// Of a paw 1 long and 1 high, its heel over the start: front is up, and centre - back = 0 at the ground.
const PAW: &[[f64; 5]] =
    &[[0.10, 0.50, 0.36, 0.50, 0.50], [0.45, 0.50, 0.46, 0.50, 0.50], [0.80, 0.40, 0.44, 0.40, 0.40]];

/// A paw whose heel stands at `heel`: width, height and length in `size`.
pub const fn paw(heel: [f64; 3], size: [f64; 3], colour: [f32; 3], joints: Influence) -> Part {
    let paw = Part::loft(heel, PAW, [0.10, 0.18]).along(FORWARD, UP).size(size).exponent(2.3);
    paw.blend(0.4 * size[1], 0.2 * size[0]).on(joints).coloured(colour)
}

/// The toe number `i` of four, of the paw of the same place and size.
pub const fn toe(heel: [f64; 3], size: [f64; 3], i: usize, colour: [f32; 3], joints: Influence) -> Part {
    let across = [-0.34, -0.12, 0.12, 0.34][i] * size[0];
    let ahead = [0.74, 0.88, 0.88, 0.74][i] * size[2];
    let toe = Part::ball(
        [heel[0] + across, 0.30 * size[1], heel[2] + ahead],
        [0.145 * size[0], 0.19 * size[2], 0.30 * size[1]],
    );
    toe.blend(0.10 * size[0], 0.12 * size[0]).on(joints).coloured(colour)
}

/// An eyeball of shell 1, its rim and pupil painted on, looking along `gaze`. `size`: its radius, then the pupil's half
/// width and half height.
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

/// Paint within an ellipsoid of the half-axes `size` (x, y, z), its border `soft` metres wide.
pub const fn paint(at: [f64; 3], size: [f64; 3], colour: [f32; 3], soft: f64) -> Part {
    let ball = Part { start: at, along: FORWARD, front: UP, size, ..PART };
    ball.role(Role::Paint).coloured(colour).blend(soft, 0.02)
}
