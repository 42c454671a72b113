//! The dolphin: a bottlenose of 2.2 m that swims towards +Z with its belly 0.3 m over y = 0. One chain of ten joints
//! runs from the beak to the flukes, its root amidships; each pectoral fin has a joint. Lengths in metres.

use super::figure::{Figure, JointRow, Part};
use super::loft::Role;
use super::paw::paint;

const UP: [f64; 3] = [0.0, 1.0, 0.0];
const FORWARD: [f64; 3] = [0.0, 0.0, 1.0];
/// Height of the body's axis.
const AXIS: f64 = 0.52;

const GREY: [f32; 3] = [0.115, 0.155, 0.195];
const PALE: [f32; 3] = [0.50, 0.54, 0.56];
const BLACK: [f32; 3] = [0.010, 0.012, 0.014];

/// The table of the dolphin.
pub const DOLPHIN: Figure = Figure { joints: JOINTS, parts: PARTS, cell: 0.006, colour: GREY };

const JOINTS: &[JointRow] = &[
    ("Hips", "", [0.0, AXIS, 0.00]),
    ("Spine", "Hips", [0.0, AXIS, 0.17]),
    ("Spine1", "Spine", [0.0, AXIS, 0.34]),
    ("Neck", "Spine1", [0.0, AXIS, 0.52]),
    ("Head", "Neck", [0.0, AXIS, 0.66]),
    ("Tail", "Hips", [0.0, AXIS, -0.17]),
    ("Tail1", "Tail", [0.0, AXIS, -0.34]),
    ("Tail2", "Tail1", [0.0, AXIS, -0.51]),
    ("Tail3", "Tail2", [0.0, AXIS, -0.68]),
    ("Tail4", "Tail3", [0.0, AXIS, -0.84]),
    ("Fluke", "Tail4", [0.0, AXIS, -0.98]),
    ("LeftFin", "Spine1", [0.125, 0.415, 0.435]),
];

const SPINE: &[(&str, f64, f64)] = &[
    ("Fluke", 0.0, 0.01),
    ("Tail4", 0.16, 0.055),
    ("Tail3", 0.30, 0.075),
    ("Tail2", 0.46, 0.08),
    ("Tail1", 0.63, 0.085),
    ("Tail", 0.80, 0.085),
    ("Hips", 0.97, 0.085),
    ("Spine", 1.31, 0.085),
    ("Spine1", 1.48, 0.085),
    ("Neck", 1.66, 0.080),
    ("Head", 1.80, 0.065),
];

const PARTS: &[Part] = &[
    // Body: from the root of the flukes to the forehead.
    Part::loft(
        [0.0, AXIS, -1.14],
        &[
            [0.06, 0.000, 0.020, 0.030, 0.030],
            [0.20, 0.000, 0.026, 0.050, 0.050],
            [0.40, 0.002, 0.055, 0.080, 0.082],
            [0.62, 0.004, 0.106, 0.122, 0.128],
            [0.88, 0.004, 0.158, 0.165, 0.178],
            [1.16, 0.004, 0.188, 0.190, 0.208],
            [1.42, 0.002, 0.190, 0.184, 0.206],
            [1.64, 0.000, 0.165, 0.158, 0.174],
            [1.80, -0.004, 0.132, 0.132, 0.138],
            [1.90, -0.010, 0.104, 0.112, 0.112],
        ],
        [0.05, 0.100],
    )
    .along(FORWARD, UP)
    .blend(0.05, 0.030)
    .on(SPINE),
    // Melon.
    Part::ball([0.0, 0.545, 0.790], [0.072, 0.085, 0.072]).on(HEAD).blend(0.05, 0.022),
    // Beak: upper and lower jaw.
    Part::loft(
        [0.0, 0.488, 0.800],
        &[[0.00, 0.0, 0.070, 0.045, 0.030], [0.10, 0.0, 0.043, 0.027, 0.018], [0.19, 0.0, 0.031, 0.019, 0.014]],
        [0.04, 0.034],
    )
    .along([0.0, -0.10, 1.0], UP)
    .exponent(2.2)
    .blend(0.030, 0.014)
    .on(HEAD),
    Part::loft(
        [0.0, 0.458, 0.790],
        &[[0.00, 0.0, 0.066, 0.026, 0.034], [0.10, 0.0, 0.041, 0.016, 0.022], [0.20, 0.0, 0.029, 0.012, 0.016]],
        [0.04, 0.034],
    )
    .along([0.0, -0.05, 1.0], UP)
    .exponent(2.2)
    .blend(0.008, 0.013)
    .on(HEAD),
    // Dorsal fin: swept back, its foot on the back.
    Part::loft(
        [0.0, 0.66, -0.02],
        &[
            [0.00, 0.000, 0.030, 0.135, 0.120],
            [0.10, -0.006, 0.020, 0.092, 0.070],
            [0.19, -0.026, 0.012, 0.056, 0.036],
            [0.26, -0.060, 0.007, 0.028, 0.016],
        ],
        [0.05, 0.020],
    )
    .along([0.0, 1.0, -0.55], FORWARD)
    .blend(0.06, 0.013)
    .on(&[("Hips", 0.0, 0.01)]),
    // Pectoral fin.
    Part::loft(
        [0.110, 0.425, 0.435],
        &[
            [0.00, 0.000, 0.026, 0.070, 0.066],
            [0.09, 0.006, 0.020, 0.068, 0.068],
            [0.20, -0.012, 0.014, 0.056, 0.050],
            [0.30, -0.050, 0.009, 0.036, 0.028],
            [0.36, -0.084, 0.006, 0.018, 0.014],
        ],
        [0.05, 0.020],
    )
    .along([0.62, -0.52, -0.46], [0.35, 0.0, 1.0])
    .blend(0.035, 0.013)
    .on(&[("Spine1", -0.05, 0.01), ("LeftFin", 0.035, 0.050)]),
    // Fluke: its front axis points forward, its side axis up.
    Part::loft(
        [0.012, AXIS, -1.06],
        &[
            [0.00, 0.010, 0.022, 0.090, 0.050],
            [0.07, 0.000, 0.018, 0.074, 0.060],
            [0.16, -0.026, 0.013, 0.054, 0.050],
            [0.24, -0.064, 0.009, 0.034, 0.030],
            [0.30, -0.104, 0.006, 0.017, 0.014],
        ],
        [0.03, 0.018],
    )
    .along([1.0, 0.0, -0.22], FORWARD)
    .blend(0.03, 0.012)
    .on(FLUKE),
    // Blowhole.
    Part::ball([0.0, 0.652, 0.690], [0.016, 0.009, 0.010]).on(HEAD).role(Role::Carve).blend(0.008, 0.012),
    // Pale belly and throat, a paler flank, the mouth's line.
    paint([0.0, 0.330, 0.260], [0.175, 0.120, 0.700], PALE, 0.090),
    paint([0.0, 0.390, 0.820], [0.120, 0.082, 0.240], PALE, 0.035),
    paint([0.0, 0.330, -0.250], [0.100, 0.110, 0.460], PALE, 0.090),
    // Eyes.
    Part::ball([0.1045, 0.478, 0.745], [0.0105, 0.0135, 0.0115]).on(HEAD).blend(0.03, 0.0040).shell(1).coloured(BLACK),
];

const HEAD: &[(&str, f64, f64)] = &[("Head", 0.0, 0.01)];
const FLUKE: &[(&str, f64, f64)] = &[("Fluke", 0.0, 0.01)];
