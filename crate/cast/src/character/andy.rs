//! Andy: a grown man of 1.80 m in an A-pose, arms 42° below the horizontal, six and a half heads tall, in sneakers.
//! Feet on y = 0, facing +Z. Lengths in metres.

use super::face::{self, Face, face};
use super::figure::{Figure, JointRow, Part};
use super::hand::{self, hand};
use super::person::{ARM, CHEST, FRONT, HEAD, all, placed};
use super::shoe::{self, shoe};

/// The left wrist, and the middle of the eye line.
const WRIST: [f64; 3] = [0.5937, 1.0737, -0.018];
const EYES: [f64; 3] = [0.0, 1.6950, 0.0];

const SKIN: [f32; 3] = [0.66, 0.38, 0.25];
const BLUSH: [f32; 3] = [0.66, 0.30, 0.20];
const HAIR: [f32; 3] = [0.085, 0.040, 0.018];
const IRIS: [f32; 3] = [0.13, 0.065, 0.022];
const SHORTS: [f32; 3] = [0.06, 0.075, 0.10];
const LEATHER: [f32; 3] = [0.42, 0.075, 0.04];
const SOCK: [f32; 3] = [0.70, 0.69, 0.66];

/// The table of Andy.
pub const ANDY: Figure = Figure { joints: JOINTS, parts: PARTS, cell: 0.005, colour: SKIN };

const PARTS: &[Part] = &all::<{ BODY.len() + hand::ROWS + shoe::ROWS + face::ROWS + HAIRDO.len() }>(&[
    BODY,
    &hand(WRIST, 1.0),
    &shoe([0.1015, 0.0, -0.062], 1.0, LEATHER, SOCK),
    &face(&FACE),
    &placed(HAIRDO, EYES, 1.0),
]);

const FACE: Face = Face { at: EYES, scale: 1.0, jaw: 1.0, brow: 1.0, lash: 1.0, blush: BLUSH, iris: IRIS, hair: HAIR };

const JOINTS: &[JointRow] = &[
    ("Hips", "", [0.0, 0.970, -0.005]),
    ("Spine", "Hips", [0.0, 1.060, -0.008]),
    ("Spine1", "Spine", [0.0, 1.180, -0.010]),
    ("Spine2", "Spine1", [0.0, 1.305, -0.016]),
    ("Neck", "Spine2", [0.0, 1.495, -0.030]),
    ("Head", "Neck", [0.0, 1.590, -0.008]),
    ("LeftShoulder", "Spine2", [0.030, 1.445, -0.015]),
    ("LeftArm", "LeftShoulder", [0.183, 1.432, -0.020]),
    ("LeftForeArm", "LeftArm", [0.4022, 1.2346, -0.022]),
    ("LeftHand", "LeftForeArm", WRIST),
    ("LeftUpLeg", "Hips", [0.093, 0.920, -0.004]),
    ("LeftLeg", "LeftUpLeg", [0.098, 0.505, 0.000]),
    ("LeftFoot", "LeftLeg", [0.101, 0.085, -0.026]),
    ("LeftToeBase", "LeftFoot", [0.113, 0.020, 0.108]),
];

const BODY: &[Part] = &[
    // Trunk, from the hips to the collar bones.
    Part::loft([0.0, 0.87, -0.006], TRUNK, [0.10, 0.03]).exponent(2.35).blend(0.03, 0.026).on(&[
        ("Hips", 0.0, 0.01),
        ("Spine", 0.19, 0.075),
        ("Spine1", 0.31, 0.075),
        ("Spine2", 0.435, 0.075),
        ("Neck", 0.63, 0.04),
    ]),
    // Breast muscle, shoulder blade, belly muscle, seat.
    Part::ball([0.070, 1.368, 0.052], [0.088, 0.048, 0.062]).blend(0.040, 0.022).on(CHEST),
    Part::ball([0.085, 1.375, -0.082], [0.070, 0.036, 0.085]).blend(0.045, 0.024).on(CHEST),
    Part::ball([0.040, 1.165, 0.055], [0.048, 0.034, 0.120]).blend(0.040, 0.024).on(&[
        ("Spine", -0.2, 0.01),
        ("Spine1", 0.02, 0.075),
        ("Spine2", 0.14, 0.075),
    ]),
    Part::ball([0.076, 0.925, -0.062], [0.082, 0.062, 0.088])
        .along([0.0, -1.0, 0.10], FRONT)
        .blend(0.045, 0.024)
        .on(&[("Hips", 0.0, 0.01), ("LeftUpLeg", 0.045, 0.085)]),
    // Neck with its two slanting muscles.
    Part::loft([0.0, 1.425, -0.046], NECK, [0.03, 0.02]).along([0.0, 0.180, 0.036], FRONT).blend(0.055, 0.019).on(&[
        ("Spine2", 0.0, 0.01),
        ("Neck", 0.065, 0.045),
        ("Head", 0.165, 0.035),
    ]),
    // Collar bone and trapezius; deltoid.
    Part::loft([0.022, 1.512, -0.045], COLLAR, [0.03, 0.03])
        .along([0.160, -0.083, 0.020], FRONT)
        .blend(0.06, 0.022)
        .on(&[("Spine2", 0.0, 0.01), ("LeftShoulder", 0.060, 0.055), ("LeftArm", 0.180, 0.045)]),
    Part::ball([0.206, 1.412, -0.020], [0.054, 0.062, 0.080])
        .along(ARM, FRONT)
        .blend(0.045, 0.022)
        .on(&[("LeftShoulder", -0.06, 0.02), ("LeftArm", -0.020, 0.065)]),
    // Arm, shoulder to wrist.
    Part::loft([0.183, 1.432, -0.020], UPPER_ARM, [0.05, 0.02]).along(ARM, FRONT).blend(0.045, 0.022).on(&[
        ("LeftShoulder", -0.05, 0.02),
        ("LeftArm", 0.010, 0.070),
        ("LeftForeArm", 0.295, 0.055),
        ("LeftHand", 0.533, 0.035),
    ]),
    // Leg, hip to ankle.
    Part::loft([0.093, 0.955, -0.004], LEG, [0.08, 0.03])
        .along([0.008, -0.870, -0.022], FRONT)
        .exponent(2.05)
        .blend(0.04, 0.026)
        .on(&[
            ("Hips", -0.02, 0.02),
            ("LeftUpLeg", 0.050, 0.085),
            ("LeftLeg", 0.450, 0.070),
            ("LeftFoot", 0.865, 0.042),
        ]),
    Part::belt([0.715, 1.010], 0.3, SHORTS),
];

const HAIRDO: [Part; 4] = [
    strand([0.0, 0.0480, -0.0240], [0.1020, 0.1050, 0.1030]).blend(0.02, 0.020),
    strand([0.0, -0.0200, -0.0620], [0.0800, 0.0560, 0.0600]).blend(0.03, 0.018),
    // Volume above the brow, and a lock combed to his left.
    strand([0.0, 0.1130, 0.0420], [0.0760, 0.0560, 0.0380]).along([0.0, 1.0, -0.20], FRONT).blend(0.03, 0.014),
    Part::loft([0.0, 0.1240, 0.0640], LOCK, [0.024, 0.020])
        .along([1.0, 0.10, -0.05], [0.0, 0.80, 0.6])
        .shell(1)
        .coloured(HAIR)
        .blend(0.028, 0.012)
        .on(HEAD),
];

/// A ball of hair.
const fn strand(centre: [f64; 3], half_axes: [f64; 3]) -> Part {
    Part::ball(centre, half_axes).shell(1).coloured(HAIR).on(HEAD)
}

const TRUNK: &[[f64; 5]] = &[
    [0.060, 0.000, 0.163, 0.094, 0.098],
    [0.130, 0.000, 0.160, 0.096, 0.096],
    [0.200, 0.002, 0.149, 0.094, 0.084],
    [0.270, 0.002, 0.144, 0.092, 0.079],
    [0.350, -0.001, 0.151, 0.096, 0.088],
    [0.430, -0.006, 0.165, 0.102, 0.100],
    [0.510, -0.012, 0.168, 0.098, 0.102],
    [0.565, -0.018, 0.138, 0.074, 0.088],
    [0.615, -0.022, 0.082, 0.052, 0.062],
];
const NECK: &[[f64; 5]] = &[
    [0.00, 0.0, 0.070, 0.058, 0.066],
    [0.06, 0.0, 0.056, 0.052, 0.058],
    [0.12, 0.0, 0.0510, 0.048, 0.055],
    [0.20, 0.0, 0.0510, 0.047, 0.058],
];
const COLLAR: &[[f64; 5]] =
    &[[0.0, 0.0, 0.026, 0.034, 0.040], [0.08, 0.0, 0.036, 0.044, 0.050], [0.165, 0.0, 0.046, 0.052, 0.054]];
const UPPER_ARM: &[[f64; 5]] = &[
    [0.000, 0.000, 0.050, 0.054, 0.053],
    [0.060, 0.000, 0.050, 0.055, 0.053],
    [0.130, 0.003, 0.0465, 0.054, 0.050],
    [0.200, 0.003, 0.0440, 0.051, 0.048],
    [0.280, 0.000, 0.0395, 0.040, 0.043],
    [0.340, 0.002, 0.0425, 0.045, 0.041],
    [0.400, 0.003, 0.0400, 0.042, 0.038],
    [0.470, 0.002, 0.0310, 0.034, 0.031],
    [0.530, 0.002, 0.0235, 0.029, 0.027],
    [0.560, 0.002, 0.0215, 0.029, 0.027],
];
const LEG: &[[f64; 5]] = &[
    [0.04, 0.000, 0.082, 0.086, 0.090],
    [0.10, 0.000, 0.085, 0.091, 0.093],
    [0.19, 0.004, 0.081, 0.090, 0.086],
    [0.30, 0.008, 0.0700, 0.080, 0.071],
    [0.40, 0.009, 0.0580, 0.061, 0.058],
    [0.450, 0.010, 0.0540, 0.054, 0.052],
    [0.510, 0.005, 0.0530, 0.048, 0.056],
    [0.590, -0.002, 0.0570, 0.046, 0.067],
    [0.690, 0.000, 0.0460, 0.040, 0.056],
    [0.790, 0.000, 0.0340, 0.034, 0.040],
    [0.865, 0.000, 0.0325, 0.036, 0.037],
];
const LOCK: &[[f64; 5]] = &[
    [-0.055, -0.020, 0.0160, 0.0140, 0.018],
    [-0.020, 0.000, 0.0270, 0.0220, 0.022],
    [0.025, 0.004, 0.0280, 0.0230, 0.022],
    [0.065, -0.014, 0.0160, 0.0130, 0.018],
];
