//! A friendly head about its eye line: smooth round forms, large clear eyes, a small nose, a calm smile. No feature
//! is nearer to life than the others: a likeness half reached looks uncanny. Lengths in metres, for a man's head.

use super::figure::Part;
use super::loft::Role::{Carve, Paint};
use super::person::{FRONT, HEAD, UP, placed};

/// Number of rows of a head.
pub const ROWS: usize = 22;

/// What tells one head from another. Colours are linear RGB.
pub struct Face {
    /// The middle of the eye line.
    pub at: [f64; 3],
    /// Size of the head, width of the jaw, heights of brows and lashes: against Andy's.
    pub scale: f64,
    pub jaw: f64,
    pub brow: f64,
    pub lash: f64,
    pub blush: [f32; 3],
    pub iris: [f32; 3],
    pub hair: [f32; 3],
}

const WHITE: [f32; 3] = [0.82, 0.81, 0.79];
const DARK: [f32; 3] = [0.014, 0.010, 0.009];
const MOUTH: [f32; 3] = [0.16, 0.04, 0.03];
/// Up the ear, and out of it.
const EAR: [[f64; 3]; 2] = [[0.10, 1.0, -0.18], [0.40, 0.0, 1.0]];
/// The middle of the left eyeball; along its gaze.
const EYE: [f64; 3] = [0.0385, 0.0, 0.0930];
const GAZE: [f64; 3] = [0.243, 0.0, 0.970];
/// Left of the middle of the mouth, and from there to its corner.
const LIPS: [f64; 3] = [0.0005, -0.0690, 0.1030];
const CORNER: [f64; 3] = [1.0, 0.15, -0.06];

/// The rows of a head without hair. Shells 2 to 9 are its own.
pub const fn face(face: &Face) -> [Part; ROWS] {
    let Face { jaw, brow, lash, blush, iris, hair, .. } = *face;
    let rows = [
        // Skull, jaw, chin, cheek and its blush, lower lip.
        Part::ball([0.0, 0.030, -0.008], [0.0950, 0.1120, 0.1100]).blend(0.03, 0.018),
        Part::loft([0.0, -0.125, 0.020], JAW, [0.036, 0.050]).size([jaw, 1.0, 1.0]).exponent(2.25).blend(0.035, 0.013),
        Part::ball([0.0, -0.102, 0.0700], [0.0280 * jaw, 0.0230, 0.0210]).blend(0.040, 0.012),
        Part::ball([0.046, -0.038, 0.0600], [0.0300, 0.0300, 0.0260]).blend(0.040, 0.012),
        Part::ball([0.056, -0.046, 0.0900], [0.0120, 0.0300, 0.0100]).role(Paint).coloured(blush).blend(0.030, 0.012),
        Part::ball([0.0, -0.0810, 0.0920], [0.0200, 0.0110, 0.0080]).blend(0.016, 0.009),
        // Eye socket, ear and its hollow.
        Part::ball([0.0400, 0.004, 0.1260], [0.0300, 0.0210, 0.0230]).role(Carve).blend(0.025, 0.009),
        Part::ball([0.0980, -0.012, -0.010], [0.0095, 0.0200, 0.0320]).along(EAR[0], EAR[1]).blend(0.012, 0.009),
        Part::ball([0.1090, -0.009, -0.002], [0.0060, 0.0105, 0.0190])
            .along(EAR[0], EAR[1])
            .role(Carve)
            .blend(0.010, 0.008),
        // Nose: ridge, tip, wing.
        Part::loft([0.0, 0.014, 0.0990], RIDGE, [0.020, 0.010]).along([0.0, -0.046, 0.0150], FRONT).blend(0.022, 0.008),
        Part::ball([0.0, -0.0335, 0.1150], [0.0150, 0.0140, 0.0125]).blend(0.014, 0.0065),
        Part::ball([0.0125, -0.0360, 0.1060], [0.0095, 0.0120, 0.0085]).blend(0.012, 0.007),
        // Brow. Eyeball, iris, pupil, glint; the upper lid and its lashes, cut off along an arch.
        Part::loft([0.0165, 0.0425, 0.1035], BROW, [0.005, 0.008])
            .size([1.0, brow, 1.0])
            .along([1.0, -0.05, -0.45], UP)
            .shell(2)
            .coloured(hair)
            .blend(0.001, 0.006),
        ball(1.0).shell(3).coloured(WHITE).blend(0.001, 0.007),
        ahead(0.0122, [0.0130, 0.0056, 0.0130]).shell(4).coloured(iris).blend(0.001, 0.0045),
        ahead(0.0156, [0.0070, 0.0034, 0.0070]).shell(5).coloured(DARK).blend(0.001, 0.0035),
        Part::ball([0.0415, 0.0050, 0.1105], [0.0028, 0.0030, 0.0028]).shell(6).coloured([1.0; 3]).blend(0.001, 0.003),
        ball(1.18).shell(7).blend(0.001, 0.0050),
        arch(0.0008).shell(7).blend(0.003, 0.0040),
        ball(1.10).shell(8).coloured(DARK).blend(0.001, 0.0045),
        arch(-0.0034 * lash).shell(8).blend(0.002, 0.0040),
        // The line of the mouth.
        Part::loft(LIPS, SMILE, [0.004; 2]).along(CORNER, UP).shell(9).coloured(MOUTH).blend(0.003, 0.004),
    ];
    placed(on_head(rows), face.at, face.scale)
}

/// The row of full lips of the same head, in shell 10.
pub const fn lips(face: &Face, colour: [f32; 3]) -> [Part; 1] {
    let lips = Part::loft(LIPS, LIP, [0.006, 0.008]).along(CORNER, UP).shell(10).coloured(colour).blend(0.006, 0.0042);
    placed(on_head([lips]), face.at, face.scale)
}

/// The same rows, following the head.
const fn on_head<const N: usize>(mut rows: [Part; N]) -> [Part; N] {
    let mut i = 0;
    while i < N {
        rows[i] = rows[i].on(HEAD);
        i += 1;
    }
    rows
}

/// The left eyeball, or what lies on it, `size` times as large.
const fn ball(size: f64) -> Part {
    Part::loft(EYE, DOME, [0.35, 0.99]).size([0.0245 * size, 0.0200 * size, 0.0160 * size]).along(GAZE, UP)
}

/// An ellipsoid on the left gaze, `depth` metres before the middle of the eyeball: half-axes across, along and up.
const fn ahead(depth: f64, half_axes: [f64; 3]) -> Part {
    let centre = [EYE[0] - 0.0030 + depth * GAZE[0], EYE[1], EYE[2] + 0.0008 + depth * GAZE[2]];
    Part::ball(centre, half_axes).along(UP, GAZE)
}

/// Takes away what lies below the arch of the upper lid, moved up by `raised` metres.
const fn arch(raised: f64) -> Part {
    let centre = [EYE[0], EYE[1] + raised - 0.0300, EYE[2]];
    Part::ball(centre, [0.0400, 0.0600, 0.0450]).along(UP, GAZE).role(Carve)
}

const JAW: &[[f64; 5]] = &[
    [0.032, 0.004, 0.064, 0.068, 0.036],
    [0.062, 0.002, 0.080, 0.082, 0.058],
    [0.095, 0.000, 0.087, 0.086, 0.085],
    [0.140, 0.000, 0.089, 0.088, 0.095],
];
const RIDGE: &[[f64; 5]] =
    &[[0.0, 0.0, 0.0080, 0.006, 0.012], [0.024, 0.0, 0.0090, 0.0080, 0.012], [0.044, 0.0, 0.0110, 0.0090, 0.012]];
const BROW: &[[f64; 5]] = &[
    [0.000, 0.0000, 0.0050, 0.0058, 0.0058],
    [0.022, 0.0045, 0.0075, 0.0058, 0.0058],
    [0.044, 0.0020, 0.0050, 0.0036, 0.0036],
];
const DOME: &[[f64; 5]] = &[[-0.01, 0.0, 1.0, 1.0, 1.0], [0.01, 0.0, 1.0, 1.0, 1.0]];
/// The left half of the lips, and of the line between them, from the middle to the corner.
const LIP: &[[f64; 5]] = &[
    [0.000, 0.0000, 0.0044, 0.0058, 0.0090],
    [0.010, 0.0000, 0.0044, 0.0058, 0.0078],
    [0.020, 0.0015, 0.0036, 0.0032, 0.0038],
];
const SMILE: &[[f64; 5]] = &[
    [0.000, 0.0000, 0.0055, 0.0022, 0.0022],
    [0.015, -0.0010, 0.0055, 0.0022, 0.0022],
    [0.030, 0.0035, 0.0050, 0.0018, 0.0018],
];
