//! A hand about its wrist, with round fingers a little apart. Lengths in metres, for a man's hand.

use super::figure::Part;
use super::person::{ARM, FRONT, Influence, PALM, placed};

/// Number of rows of a hand.
pub const ROWS: usize = 7;

const HAND: Influence = &[("LeftHand", 0.0, 0.01)];

/// The rows of the left hand, whose wrist is at `wrist`; `scale` is against a man's.
pub const fn hand(wrist: [f64; 3], scale: f64) -> [Part; ROWS] {
    let rows = [
        // Palm, ball of the thumb, fingers, thumb.
        Part::loft([0.0; 3], BACK, [0.020, 0.020])
            .along(ARM, FRONT)
            .exponent(2.4)
            .blend(0.03, 0.013)
            .on(&[("LeftForeArm", -0.05, 0.01), ("LeftHand", 0.0, 0.035)]),
        Part::ball([0.0253, -0.0337, 0.0200], [0.0160, 0.0170, 0.036])
            .along([0.72, -0.62, 0.28], FRONT)
            .blend(0.024, 0.012)
            .on(HAND),
        finger(0.088, 0.0330, 0.11, [0.0112, 0.074]),
        finger(0.092, 0.0105, 0.03, [0.0116, 0.082]),
        finger(0.088, -0.0122, -0.05, [0.0112, 0.076]),
        finger(0.081, -0.0335, -0.15, [0.0102, 0.060]),
        Part::loft([0.0240, -0.0330, 0.0270], FINGER, [0.10, 0.10])
            .size([0.0124, 0.0124, 0.070])
            .along([0.66, -0.62, 0.62], PALM)
            .blend(0.016, 0.0100)
            .on(HAND),
    ];
    placed(rows, wrist, scale)
}

/// A finger that starts `at` metres beyond the wrist at depth `z` and points forward by `spread`. Radius, length.
const fn finger(at: f64, z: f64, spread: f64, [radius, length]: [f64; 2]) -> Part {
    Part::loft([at * ARM[0], at * ARM[1], z], FINGER, [0.13, 0.14])
        .size([radius, radius, length])
        .along([ARM[0], ARM[1], spread], PALM)
        .blend(0.009, 0.0095)
        .on(HAND)
}

const BACK: &[[f64; 5]] = &[
    [-0.010, 0.002, 0.0210, 0.028, 0.026],
    [0.030, 0.001, 0.0195, 0.037, 0.036],
    [0.062, 0.000, 0.0175, 0.0425, 0.0420],
    [0.085, -0.001, 0.0145, 0.0415, 0.0415],
];
/// Sections of a finger in units of its radius and length. It curls a little towards the palm.
const FINGER: &[[f64; 5]] = &[
    [-0.10, 0.0, 1.02, 1.05, 1.05],
    [0.20, 0.05, 1.0, 1.0, 1.0],
    [0.50, 0.30, 0.98, 0.98, 0.98],
    [0.78, 0.80, 0.92, 0.90, 0.90],
    [0.90, 1.10, 0.86, 0.82, 0.82],
];
