//! Monster: a troll of 1.75 m, hunched, with arms nearly to the ground, a jaw like a shovel, tusks and small eyes.
//! A-pose, arms 42° below the horizontal, feet on y = 0, facing +Z. Lengths in metres.

use super::figure::{Figure, JointRow, Part};
use super::loft::Role::{Carve, Paint};

const UP: [f64; 3] = [0.0, 1.0, 0.0];
const SIDE: [f64; 3] = [1.0, 0.0, 0.0];
const FRONT: [f64; 3] = [0.0, 0.0, 1.0];
/// Along the left arm: cos 42°, -sin 42°; and from the back of the hand to the palm.
const ARM: [f64; 3] = [0.7431, -0.6691, 0.0];
const PALM: [f64; 3] = [-0.6691, -0.7431, 0.0];
/// The left wrist.
const WRIST: [f64; 3] = [0.9865, 0.7880, 0.070];

const SKIN: [f32; 3] = [0.20, 0.27, 0.13];
const BELLY: [f32; 3] = [0.36, 0.38, 0.20];
const WART: [f32; 3] = [0.13, 0.18, 0.085];
const HORN: [f32; 3] = [0.42, 0.34, 0.22];
const TUSK: [f32; 3] = [0.72, 0.64, 0.46];
const EYE: [f32; 3] = [0.85, 0.55, 0.06];
const DARK: [f32; 3] = [0.015, 0.012, 0.010];

/// The table of the monster.
pub const MONSTER: Figure = Figure { joints: JOINTS, parts: PARTS, cell: 0.008, colour: SKIN };

const JOINTS: &[JointRow] = &[
    ("Hips", "", [0.0, 0.800, -0.060]),
    ("Spine", "Hips", [0.0, 0.910, -0.080]),
    ("Spine1", "Spine", [0.0, 1.050, -0.085]),
    ("Spine2", "Spine1", [0.0, 1.200, -0.055]),
    ("Neck", "Spine2", [0.0, 1.415, 0.075]),
    ("Head", "Neck", [0.0, 1.475, 0.165]),
    ("LeftShoulder", "Spine2", [0.070, 1.400, 0.020]),
    ("LeftArm", "LeftShoulder", [0.310, 1.400, 0.060]),
    ("LeftForeArm", "LeftArm", [0.6500, 1.0939, 0.060]),
    ("LeftHand", "LeftForeArm", WRIST),
    ("LeftUpLeg", "Hips", [0.155, 0.740, -0.045]),
    ("LeftLeg", "LeftUpLeg", [0.175, 0.420, -0.015]),
    ("LeftFoot", "LeftLeg", [0.185, 0.110, -0.065]),
    ("LeftToeBase", "LeftFoot", [0.205, 0.030, 0.105]),
];

const HEAD: &[(&str, f64, f64)] = &[("Head", 0.0, 0.01)];
const CHEST: &[(&str, f64, f64)] = &[("Spine2", 0.0, 0.01)];
const HAND: &[(&str, f64, f64)] = &[("LeftHand", 0.0, 0.01)];
const TOES: &[(&str, f64, f64)] = &[("LeftToeBase", 0.0, 0.01)];

const PARTS: &[Part] = &[
    // Trunk, leaning forward; belly, hump, breast, shoulder, seat.
    Part::loft([0.0, 0.66, -0.045], TRUNK, [0.12, 0.08])
        .along([0.0, 1.0, 0.035], FRONT)
        .exponent(2.2)
        .blend(0.05, 0.034)
        .on(&[("Hips", 0.0, 0.01), ("Spine", 0.250, 0.095), ("Spine1", 0.390, 0.095), ("Spine2", 0.540, 0.095)]),
    Part::ball([0.0, 0.960, 0.060], [0.215, 0.160, 0.190]).blend(0.08, 0.032).on(&[
        ("Hips", -0.2, 0.01),
        ("Spine", -0.06, 0.09),
        ("Spine1", 0.085, 0.09),
    ]),
    Part::ball([0.0, 1.330, -0.075], [0.250, 0.165, 0.190])
        .along([0.0, 1.0, 0.45], FRONT)
        .blend(0.10, 0.032)
        .on(&[("Spine1", -0.3, 0.01), ("Spine2", -0.10, 0.09)]),
    Part::ball([0.120, 1.285, 0.110], [0.140, 0.080, 0.095]).blend(0.07, 0.030).on(CHEST),
    Part::ball([0.120, 0.770, -0.120], [0.125, 0.105, 0.120])
        .blend(0.07, 0.032)
        .on(&[("Hips", 0.0, 0.01), ("LeftUpLeg", -0.030, -0.11)]),
    Part::loft([0.090, 1.440, 0.005], COLLAR, [0.06, 0.05])
        .along([0.240, -0.040, 0.050], FRONT)
        .blend(0.09, 0.030)
        .on(&[("Spine2", 0.0, 0.01), ("LeftShoulder", 0.070, 0.080), ("LeftArm", 0.215, 0.075)]),
    Part::ball([0.345, 1.375, 0.055], [0.105, 0.118, 0.145])
        .along(ARM, FRONT)
        .blend(0.07, 0.030)
        .on(&[("LeftShoulder", -0.13, 0.02), ("LeftArm", -0.035, 0.105)]),
    // Neck.
    Part::loft([0.0, 1.330, 0.020], NECK, [0.05, 0.05]).along([0.0, 0.60, 0.80], UP).blend(0.09, 0.026).on(&[
        ("Spine2", 0.0, 0.01),
        ("Neck", 0.090, 0.060),
        ("Head", 0.200, 0.050),
    ]),
    // Arm, palm, fingers, thumb.
    Part::loft([0.310, 1.400, 0.060], ARM_SECTIONS, [0.08, 0.03]).along(ARM, FRONT).blend(0.06, 0.028).on(&[
        ("LeftShoulder", -0.08, 0.02),
        ("LeftArm", 0.015, 0.105),
        ("LeftForeArm", 0.4575, 0.085),
        ("LeftHand", 0.890, 0.055),
    ]),
    Part::loft(WRIST, PALM_SECTIONS, [0.03, 0.03])
        .along(ARM, FRONT)
        .exponent(2.5)
        .blend(0.04, 0.020)
        .on(&[("LeftForeArm", -0.08, 0.01), ("LeftHand", 0.0, 0.05)]),
    finger(0.135, 0.048, 0.16, [0.0215, 0.135]),
    finger(0.145, 0.000, 0.0, [0.0225, 0.145]),
    finger(0.135, -0.048, -0.18, [0.0205, 0.125]),
    Part::loft([1.0130, 0.7450, 0.100], FINGER, [0.08, 0.08])
        .size([0.0230, 0.0230, 0.125])
        .along([0.60, -0.62, 0.72], PALM)
        .blend(0.030, 0.017)
        .on(HAND),
    // Leg; foot with three toes.
    Part::loft([0.155, 0.790, -0.045], LEG, [0.10, 0.04]).along([0.030, -0.680, -0.020], FRONT).blend(0.06, 0.032).on(
        &[("Hips", -0.03, 0.02), ("LeftUpLeg", 0.065, 0.110), ("LeftLeg", 0.370, 0.085), ("LeftFoot", 0.675, 0.055)],
    ),
    Part::loft([0.186, 0.0, -0.105], FOOT, [0.050, 0.040])
        .along([0.035, 0.0, 0.260], UP)
        .exponent(2.3)
        .blend(0.05, 0.024)
        .on(&[("LeftFoot", 0.0, 0.01), ("LeftToeBase", 0.215, 0.035)]),
    toe([0.155, 0.028, 0.160], [0.033, 0.028, 0.050]),
    toe([0.220, 0.026, 0.163], [0.031, 0.026, 0.048]),
    toe([0.280, 0.024, 0.145], [0.029, 0.024, 0.046]),
    // Head: skull, jaw, lower lip, cheek, brow, nose, ears.
    Part::ball([0.0, 1.545, 0.215], [0.120, 0.150, 0.115]).blend(0.03, 0.024).on(HEAD),
    Part::ball([0.0, 1.430, 0.270], [0.125, 0.125, 0.078]).exponent(2.2).blend(0.05, 0.020).on(HEAD),
    Part::ball([0.0, 1.405, 0.365], [0.034, 0.040, 0.095]).along(SIDE, FRONT).blend(0.04, 0.014).on(HEAD),
    Part::ball([0.0, 1.490, 0.340], [0.045, 0.050, 0.075]).along(SIDE, FRONT).blend(0.03, 0.014).on(HEAD),
    Part::ball([0.0, 1.450, 0.410], [0.008, 0.045, 0.095]).along(SIDE, FRONT).role(Carve).blend(0.014, 0.011).on(HEAD),
    Part::ball([0.052, 1.592, 0.325], [0.024, 0.032, 0.062])
        .along([1.0, 0.16, -0.35], FRONT)
        .blend(0.03, 0.014)
        .on(HEAD),
    Part::ball([0.055, 1.552, 0.360], [0.028, 0.024, 0.018]).role(Carve).blend(0.016, 0.011).on(HEAD),
    Part::loft([0.0, 1.590, 0.335], NOSE, [0.02, 0.02]).along([0.0, -0.085, 0.060], FRONT).blend(0.03, 0.014).on(HEAD),
    Part::ball([0.032, 1.508, 0.385], [0.022, 0.024, 0.018]).blend(0.016, 0.013).on(HEAD),
    Part::loft([0.105, 1.545, 0.195], EAR, [0.02, 0.012])
        .along([0.85, 0.35, -0.25], FRONT)
        .blend(0.024, 0.015)
        .on(HEAD),
    // Warts.
    Part::ball([0.080, 1.490, -0.110], [0.035, 0.035, 0.025]).coloured(WART).blend(0.02, 0.020).on(CHEST),
    Part::ball([0.150, 1.400, -0.165], [0.030, 0.026, 0.026]).coloured(WART).blend(0.02, 0.020).on(CHEST),
    // Pale belly and throat.
    Part::ball([0.0, 1.000, 0.210], [0.190, 0.150, 0.330]).role(Paint).coloured(BELLY).blend(0.10, 0.034).on(CHEST),
    // Tusks, horns, eyes.
    Part::loft([0.062, 1.425, 0.385], FANG, [0.01, 0.008])
        .size([0.015, 0.015, 0.085])
        .along([0.20, 1.0, 0.16], FRONT)
        .shell(1)
        .coloured(TUSK)
        .blend(0.001, 0.012)
        .on(HEAD),
    Part::loft([0.078, 1.620, 0.215], FANG, [0.02, 0.010])
        .size([0.026, 0.026, 0.115])
        .along([0.62, 1.0, -0.25], [-1.0, 0.6, 0.0])
        .shell(2)
        .coloured(HORN)
        .blend(0.001, 0.017)
        .on(HEAD),
    Part::ball([0.053, 1.553, 0.338], [0.0180, 0.0150, 0.0150]).shell(3).coloured(EYE).blend(0.001, 0.007).on(HEAD),
    Part::ball([0.052, 1.552, 0.3505], [0.0050, 0.0040, 0.0095]).shell(4).coloured(DARK).blend(0.001, 0.004).on(HEAD),
];

/// A finger that starts `at` metres beyond the wrist at depth `z` and points forward by `spread`. Radius, length.
const fn finger(at: f64, z: f64, spread: f64, [radius, length]: [f64; 2]) -> Part {
    let start = [WRIST[0] + at * ARM[0], WRIST[1] + at * ARM[1], WRIST[2] + z];
    Part::loft(start, FINGER, [0.12, 0.10])
        .size([radius, radius, length])
        .along([ARM[0], ARM[1], spread], PALM)
        .blend(0.018, 0.017)
        .on(HAND)
}

/// A toe, an ellipsoid.
const fn toe(centre: [f64; 3], half_axes: [f64; 3]) -> Part {
    Part::ball(centre, half_axes).along([0.12, -0.06, 1.0], UP).blend(0.018, 0.018).on(TOES)
}

/// Sections of a finger in units of its radius and length. It curls towards the palm.
const FINGER: &[[f64; 5]] = &[
    [-0.10, 0.0, 1.05, 1.05, 1.05],
    [0.30, 0.05, 1.0, 1.0, 1.0],
    [0.60, 0.45, 1.0, 1.0, 1.0],
    [0.92, 1.40, 0.80, 0.78, 0.78],
];
/// Sections of a tusk or horn in units of its radius and length. It curves to its front.
const FANG: &[[f64; 5]] = &[
    [-0.2, 0.0, 1.0, 1.0, 1.0],
    [0.3, 0.1, 0.86, 0.86, 0.86],
    [0.7, 0.7, 0.52, 0.52, 0.52],
    [1.0, 1.6, 0.16, 0.16, 0.16],
];
const TRUNK: &[[f64; 5]] = &[
    [0.060, 0.00, 0.205, 0.150, 0.150],
    [0.160, -0.01, 0.225, 0.160, 0.150],
    [0.280, -0.02, 0.235, 0.170, 0.150],
    [0.400, -0.02, 0.250, 0.180, 0.165],
    [0.520, 0.00, 0.275, 0.180, 0.185],
    [0.640, 0.02, 0.285, 0.170, 0.190],
    [0.740, 0.03, 0.230, 0.130, 0.160],
];
const COLLAR: &[[f64; 5]] =
    &[[0.0, 0.0, 0.060, 0.090, 0.095], [0.120, 0.0, 0.078, 0.100, 0.105], [0.235, 0.0, 0.090, 0.105, 0.105]];
const NECK: &[[f64; 5]] =
    &[[0.00, 0.0, 0.145, 0.125, 0.120], [0.10, 0.0, 0.120, 0.105, 0.100], [0.22, 0.0, 0.100, 0.085, 0.085]];
const ARM_SECTIONS: &[[f64; 5]] = &[
    [0.000, 0.000, 0.092, 0.098, 0.098],
    [0.120, 0.002, 0.088, 0.098, 0.094],
    [0.250, 0.004, 0.080, 0.090, 0.084],
    [0.360, 0.002, 0.070, 0.074, 0.074],
    [0.450, 0.000, 0.066, 0.068, 0.074],
    [0.560, 0.004, 0.080, 0.086, 0.078],
    [0.660, 0.004, 0.082, 0.088, 0.080],
    [0.780, 0.002, 0.066, 0.072, 0.068],
    [0.890, 0.000, 0.050, 0.060, 0.058],
];
const PALM_SECTIONS: &[[f64; 5]] =
    &[[-0.01, 0.0, 0.046, 0.058, 0.056], [0.06, 0.0, 0.042, 0.076, 0.074], [0.125, -0.004, 0.033, 0.078, 0.076]];
const LEG: &[[f64; 5]] = &[
    [0.04, 0.000, 0.128, 0.135, 0.135],
    [0.14, 0.004, 0.128, 0.135, 0.132],
    [0.25, 0.012, 0.110, 0.118, 0.108],
    [0.37, 0.016, 0.092, 0.092, 0.092],
    [0.46, 0.000, 0.090, 0.084, 0.100],
    [0.58, 0.000, 0.078, 0.076, 0.084],
    [0.68, 0.000, 0.072, 0.076, 0.076],
];
const FOOT: &[[f64; 5]] = &[
    [0.00, 0.052, 0.070, 0.070, 0.052],
    [0.08, 0.050, 0.076, 0.075, 0.050],
    [0.16, 0.040, 0.088, 0.055, 0.040],
    [0.225, 0.030, 0.096, 0.034, 0.030],
];
const NOSE: &[[f64; 5]] =
    &[[0.0, 0.0, 0.020, 0.020, 0.030], [0.05, 0.0, 0.024, 0.026, 0.030], [0.095, 0.0, 0.032, 0.032, 0.032]];
const EAR: &[[f64; 5]] =
    &[[0.0, 0.0, 0.036, 0.012, 0.014], [0.05, 0.004, 0.038, 0.010, 0.012], [0.12, 0.010, 0.010, 0.006, 0.006]];
