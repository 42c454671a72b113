//! A sneaker and a sock: the shoe stands on a white sole, the ankle in a collar. Lengths in metres, for a man's foot.

use super::figure::Part;
use super::loft::Role::Paint;
use super::person::{FRONT, Influence, UP, placed};

/// Number of rows of a shoe.
pub const ROWS: usize = 7;

const FOOT: Influence = &[("LeftFoot", 0.0, 0.01), ("LeftToeBase", 0.168, 0.024)];
const ANKLE: Influence = &[("LeftFoot", 0.0, 0.01)];
/// From heel to toe.
const ALONG: [f64; 3] = [0.024, 0.0, 0.240];

const RUBBER: [f32; 3] = [0.78, 0.77, 0.74];

/// The rows of the left shoe with its heel above `heel` on the floor; `scale` is against a man's.
pub const fn shoe(heel: [f64; 3], scale: f64, leather: [f32; 3], sock: [f32; 3]) -> [Part; ROWS] {
    let rows = [
        Part::loft([0.0; 3], UPPER, [0.032, 0.050])
            .along(ALONG, UP)
            .exponent(2.3)
            .coloured(leather)
            .blend(0.004, 0.014)
            .on(FOOT),
        Part::loft([0.0005, 0.045, 0.0320], COLLAR, [0.020, 0.008])
            .along([0.0, 1.0, -0.04], FRONT)
            .coloured(leather)
            .blend(0.020, 0.012)
            .on(ANKLE),
        Part::loft([0.0, 0.0125, 0.0], SOLE, [0.038, 0.056])
            .along(ALONG, UP)
            .exponent(2.6)
            .coloured(leather)
            .blend(0.004, 0.011)
            .on(FOOT),
        // Crisp paint: sock, shoe, toe cap, sole.
        Part::belt([0.05, 0.150], 0.3, sock),
        Part::belt([-0.01, 0.093], 0.3, leather),
        Part::ball([0.0250, 0.020, 0.2300], [0.060, 0.042, 0.040]).role(Paint).coloured(RUBBER).blend(0.0, 0.01),
        Part::belt([-0.01, 0.0240], 0.3, RUBBER),
    ];
    placed(rows, heel, scale)
}

const UPPER: &[[f64; 5]] = &[
    [0.00, 0.036, 0.0370, 0.048, 0.034],
    [0.05, 0.036, 0.0395, 0.058, 0.034],
    [0.10, 0.034, 0.0440, 0.050, 0.032],
    [0.155, 0.030, 0.0500, 0.036, 0.028],
    [0.195, 0.028, 0.0490, 0.029, 0.026],
];
const COLLAR: &[[f64; 5]] = &[[0.0, 0.0, 0.0420, 0.060, 0.048], [0.045, 0.0, 0.0410, 0.046, 0.046]];
const SOLE: &[[f64; 5]] = &[
    [0.00, 0.0, 0.0400, 0.0125, 0.0125],
    [0.05, 0.0, 0.0425, 0.0125, 0.0125],
    [0.10, 0.0, 0.0465, 0.0125, 0.0125],
    [0.155, 0.0, 0.0530, 0.0125, 0.0125],
    [0.195, 0.0, 0.0520, 0.0125, 0.0125],
];
