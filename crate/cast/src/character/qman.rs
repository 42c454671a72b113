//! Qman: a cartoon boy of 1.30 m in an A-pose, arms 38° below the horizontal: three heads tall, mitten-sized hands with
//! three fingers and a thumb, big shoes. Feet on y = 0, facing +Z. Lengths in metres.

use super::figure::{Figure, JointRow, Part};

const UP: [f64; 3] = [0.0, 1.0, 0.0];
const SIDE: [f64; 3] = [1.0, 0.0, 0.0];
const FRONT: [f64; 3] = [0.0, 0.0, 1.0];
/// Along the left arm: cos 38°, -sin 38°; and from the back of the hand to the palm.
const ARM: [f64; 3] = [0.7880, -0.6157, 0.0];
const PALM: [f64; 3] = [-0.6157, -0.7880, 0.0];
/// The left wrist.
const WRIST: [f64; 3] = [0.4150, 0.5885, -0.005];

const SKIN: [f32; 3] = [0.80, 0.47, 0.31];
const CHEEK: [f32; 3] = [0.80, 0.33, 0.23];
const HAIR: [f32; 3] = [0.24, 0.085, 0.022];
const SHORTS: [f32; 3] = [0.05, 0.16, 0.34];
const SHOE: [f32; 3] = [0.55, 0.055, 0.045];
const SOLE: [f32; 3] = [0.75, 0.72, 0.66];
const WHITE: [f32; 3] = [0.88, 0.88, 0.86];
const DARK: [f32; 3] = [0.012, 0.010, 0.010];
const MOUTH: [f32; 3] = [0.22, 0.035, 0.03];

/// The table of Qman.
pub const QMAN: Figure = Figure { joints: JOINTS, parts: PARTS, cell: 0.006, colour: SKIN };

const JOINTS: &[JointRow] = &[
    ("Hips", "", [0.0, 0.455, 0.000]),
    ("Spine", "Hips", [0.0, 0.520, 0.000]),
    ("Spine1", "Spine", [0.0, 0.600, -0.002]),
    ("Spine2", "Spine1", [0.0, 0.685, -0.006]),
    ("Neck", "Spine2", [0.0, 0.805, -0.012]),
    ("Head", "Neck", [0.0, 0.865, -0.006]),
    ("LeftShoulder", "Spine2", [0.030, 0.775, -0.008]),
    ("LeftArm", "LeftShoulder", [0.150, 0.7590, -0.008]),
    ("LeftForeArm", "LeftArm", [0.2860, 0.6650, -0.008]),
    ("LeftHand", "LeftForeArm", WRIST),
    ("LeftUpLeg", "Hips", [0.078, 0.410, 0.000]),
    ("LeftLeg", "LeftUpLeg", [0.085, 0.240, 0.006]),
    ("LeftFoot", "LeftLeg", [0.090, 0.080, -0.010]),
    ("LeftToeBase", "LeftFoot", [0.100, 0.028, 0.105]),
];

const HEAD: &[(&str, f64, f64)] = &[("Head", 0.0, 0.01)];
const HAND: &[(&str, f64, f64)] = &[("LeftHand", 0.0, 0.01)];

const PARTS: &[Part] = &[
    // Trunk: a pear.
    Part::loft([0.0, 0.38, 0.0], TRUNK, [0.075, 0.03]).exponent(2.2).blend(0.03, 0.020).on(&[
        ("Hips", 0.0, 0.01),
        ("Spine", 0.140, 0.055),
        ("Spine1", 0.220, 0.055),
        ("Spine2", 0.305, 0.055),
        ("Neck", 0.430, 0.03),
    ]),
    // Shorts: a shape of their own, so that the border lies in a fold.
    Part::loft([0.0, 0.36, 0.0], SHORTS_WAIST, [0.055, 0.010])
        .exponent(2.2)
        .blend(0.006, 0.018)
        .on(&[("Hips", 0.0, 0.01), ("Spine", 0.160, 0.055)]),
    Part::loft([0.078, 0.430, 0.0], SHORTS_LEG, [0.05, 0.008])
        .along([0.007, -0.170, 0.004], FRONT)
        .blend(0.012, 0.0125)
        .on(&[("Hips", -0.03, 0.02), ("LeftUpLeg", 0.030, 0.060), ("LeftLeg", 0.190, 0.050)]),
    Part::loft([0.0, 0.745, -0.014], NECK, [0.03, 0.03]).blend(0.03, 0.018).on(&[
        ("Spine2", 0.0, 0.01),
        ("Neck", 0.060, 0.030),
        ("Head", 0.115, 0.025),
    ]),
    Part::loft([0.040, 0.788, -0.012], COLLAR, [0.03, 0.03])
        .along([0.120, -0.034, 0.0], FRONT)
        .blend(0.05, 0.018)
        .on(&[("Spine2", 0.0, 0.01), ("LeftShoulder", 0.030, 0.040), ("LeftArm", 0.115, 0.040)]),
    // Arm, palm, fingers, thumb.
    Part::loft([0.150, 0.759, -0.008], ARM_SECTIONS, [0.045, 0.02]).along(ARM, FRONT).blend(0.035, 0.018).on(&[
        ("LeftShoulder", -0.04, 0.02),
        ("LeftArm", 0.005, 0.050),
        ("LeftForeArm", 0.167, 0.045),
        ("LeftHand", 0.322, 0.030),
    ]),
    Part::loft(WRIST, PALM_SECTIONS, [0.02, 0.030])
        .along(ARM, FRONT)
        .exponent(2.3)
        .blend(0.022, 0.013)
        .on(&[("LeftForeArm", -0.05, 0.01), ("LeftHand", 0.0, 0.028)]),
    finger(0.080, 0.032, 0.20, [0.0185, 0.074]),
    finger(0.086, 0.000, 0.0, [0.0190, 0.080]),
    finger(0.080, -0.032, -0.20, [0.0180, 0.070]),
    Part::loft([0.4380, 0.5640, 0.026], FINGER, [0.10, 0.10])
        .size([0.0190, 0.0190, 0.072])
        .along([0.55, -0.48, 0.80], PALM)
        .blend(0.020, 0.012)
        .on(HAND),
    // Leg, shoe, sole.
    Part::loft([0.078, 0.430, 0.0], LEG, [0.05, 0.03]).along([0.012, -0.350, -0.010], FRONT).blend(0.006, 0.017).on(&[
        ("Hips", -0.03, 0.02),
        ("LeftUpLeg", 0.030, 0.060),
        ("LeftLeg", 0.190, 0.050),
        ("LeftFoot", 0.345, 0.030),
    ]),
    Part::loft([0.0905, 0.0, -0.075], SHOE_SECTIONS, [0.040, 0.062])
        .along([0.022, 0.0, 0.230], UP)
        .exponent(2.3)
        .coloured(SHOE)
        .blend(0.004, 0.014)
        .on(&[("LeftFoot", 0.0, 0.01), ("LeftToeBase", 0.175, 0.025)]),
    Part::ball([0.0895, 0.093, -0.020], [0.053, 0.062, 0.030])
        .coloured(SHOE)
        .blend(0.012, 0.013)
        .on(&[("LeftFoot", 0.0, 0.01)]),
    Part::loft([0.0905, 0.0150, -0.075], SOLE_SECTIONS, [0.045, 0.068])
        .along([0.022, 0.0, 0.230], UP)
        .exponent(2.6)
        .coloured(SHOE)
        .blend(0.004, 0.011)
        .on(&[("LeftFoot", 0.0, 0.01), ("LeftToeBase", 0.175, 0.025)]),
    // Crisp paint: shorts, shoe, sole.
    Part::belt([0.2625, 0.513], 0.25, SHORTS),
    Part::belt([-0.01, 0.1200], 0.25, SHOE),
    Part::belt([-0.01, 0.0275], 0.25, SOLE),
    // Head: skull, cheeks, nose, ears.
    Part::ball([0.0, 1.075, 0.000], [0.195, 0.180, 0.190]).exponent(2.1).blend(0.02, 0.031).on(HEAD),
    Part::ball([0.0, 0.985, 0.030], [0.165, 0.150, 0.115]).blend(0.06, 0.024).on(HEAD),
    Part::ball([0.110, 0.985, 0.105], [0.060, 0.050, 0.050]).coloured(CHEEK).blend(0.05, 0.017).on(HEAD),
    Part::ball([0.0, 1.030, 0.188], [0.027, 0.026, 0.023]).coloured(CHEEK).blend(0.012, 0.009).on(HEAD),
    Part::ball([0.196, 1.040, -0.005], [0.022, 0.036, 0.048])
        .along([0.15, 1.0, -0.1], [0.35, 0.0, 1.0])
        .blend(0.014, 0.012)
        .on(HEAD),
    // Hair with a tuft; brows.
    Part::ball([0.0, 1.118, -0.030], [0.206, 0.186, 0.172]).shell(1).coloured(HAIR).blend(0.02, 0.034).on(HEAD),
    Part::ball([0.055, 1.235, 0.090], [0.085, 0.085, 0.050])
        .along([0.3, 1.0, 0.3], FRONT)
        .shell(2)
        .coloured(HAIR)
        .blend(0.03, 0.022)
        .on(HEAD),
    Part::loft([0.0, 1.270, 0.010], TUFT, [0.03, 0.012])
        .along([0.25, 1.0, -0.1], SIDE)
        .shell(3)
        .coloured(HAIR)
        .blend(0.02, 0.014)
        .on(HEAD),
    Part::ball([0.078, 1.166, 0.154], [0.009, 0.012, 0.032])
        .along([1.0, -0.10, -0.34], FRONT)
        .shell(4)
        .coloured(HAIR)
        .blend(0.002, 0.012)
        .on(HEAD),
    // Eyes: white, pupil, glint. Mouth.
    Part::ball([0.068, 1.080, 0.146], [0.042, 0.036, 0.056]).shell(5).coloured(WHITE).blend(0.001, 0.014).on(HEAD),
    Part::ball([0.064, 1.076, 0.170], [0.021, 0.0150, 0.029]).shell(6).coloured(DARK).blend(0.001, 0.009).on(HEAD),
    Part::ball([0.071, 1.088, 0.182], [0.0065, 0.0050, 0.0075]).shell(7).coloured(WHITE).blend(0.001, 0.004).on(HEAD),
    Part::loft([0.0, 0.958, 0.162], SMILE, [0.008, 0.008])
        .along(SIDE, UP)
        .shell(8)
        .coloured(MOUTH)
        .blend(0.001, 0.008)
        .on(HEAD),
];

/// A finger that starts `at` metres beyond the wrist at depth `z` and points forward by `spread`. Radius, length.
const fn finger(at: f64, z: f64, spread: f64, [radius, length]: [f64; 2]) -> Part {
    let start = [WRIST[0] + at * ARM[0], WRIST[1] + at * ARM[1], WRIST[2] + z];
    Part::loft(start, FINGER, [0.20, 0.20])
        .size([radius, radius, length])
        .along([ARM[0], ARM[1], spread], PALM)
        .blend(0.012, 0.012)
        .on(HAND)
}

/// Sections of a finger in units of its radius and length. It curls a little towards the palm.
const FINGER: &[[f64; 5]] =
    &[[-0.10, 0.0, 0.95, 0.95, 0.95], [0.40, 0.08, 1.02, 1.02, 1.02], [0.80, 0.45, 1.0, 1.0, 1.0]];
const TRUNK: &[[f64; 5]] = &[
    [0.030, 0.000, 0.128, 0.105, 0.108],
    [0.100, 0.004, 0.140, 0.118, 0.112],
    [0.180, 0.006, 0.142, 0.122, 0.108],
    [0.260, 0.002, 0.134, 0.110, 0.100],
    [0.340, -0.004, 0.120, 0.092, 0.090],
    [0.400, -0.008, 0.092, 0.072, 0.074],
    [0.435, -0.010, 0.062, 0.056, 0.058],
];
const SHORTS_WAIST: &[[f64; 5]] =
    &[[0.030, 0.000, 0.136, 0.113, 0.116], [0.090, 0.003, 0.148, 0.124, 0.120], [0.150, 0.006, 0.151, 0.130, 0.119]];
const SHORTS_LEG: &[[f64; 5]] =
    &[[0.00, 0.0, 0.070, 0.080, 0.084], [0.08, 0.0, 0.073, 0.078, 0.080], [0.165, 0.0, 0.071, 0.073, 0.074]];
const NECK: &[[f64; 5]] =
    &[[0.00, 0.0, 0.060, 0.056, 0.058], [0.06, 0.0, 0.052, 0.050, 0.052], [0.13, 0.0, 0.056, 0.054, 0.056]];
const COLLAR: &[[f64; 5]] = &[[0.0, 0.0, 0.040, 0.048, 0.050], [0.115, 0.0, 0.044, 0.050, 0.050]];
const ARM_SECTIONS: &[[f64; 5]] = &[
    [0.000, 0.0, 0.047, 0.050, 0.050],
    [0.080, 0.0, 0.042, 0.044, 0.043],
    [0.165, 0.0, 0.038, 0.038, 0.039],
    [0.240, 0.0, 0.036, 0.037, 0.036],
    [0.330, 0.0, 0.033, 0.035, 0.034],
];
const PALM_SECTIONS: &[[f64; 5]] =
    &[[0.000, 0.0, 0.030, 0.036, 0.035], [0.040, 0.0, 0.029, 0.050, 0.048], [0.080, 0.0, 0.024, 0.052, 0.050]];
const LEG: &[[f64; 5]] = &[
    [0.00, 0.0, 0.062, 0.072, 0.076],
    [0.08, 0.0, 0.062, 0.066, 0.068],
    [0.190, 0.004, 0.050, 0.050, 0.050],
    [0.260, 0.0, 0.050, 0.047, 0.054],
    [0.350, 0.0, 0.043, 0.044, 0.046],
];
const SHOE_SECTIONS: &[[f64; 5]] = &[
    [0.00, 0.050, 0.050, 0.056, 0.046],
    [0.07, 0.050, 0.055, 0.058, 0.046],
    [0.15, 0.046, 0.068, 0.050, 0.042],
    [0.215, 0.044, 0.071, 0.044, 0.040],
];
const SOLE_SECTIONS: &[[f64; 5]] = &[
    [0.00, 0.0, 0.054, 0.0150, 0.0150],
    [0.08, 0.0, 0.060, 0.0150, 0.0150],
    [0.15, 0.0, 0.073, 0.0150, 0.0150],
    [0.215, 0.0, 0.076, 0.0150, 0.0150],
];
const TUFT: &[[f64; 5]] =
    &[[0.0, 0.0, 0.030, 0.034, 0.034], [0.04, 0.008, 0.018, 0.020, 0.020], [0.075, 0.030, 0.008, 0.009, 0.009]];
const SMILE: &[[f64; 5]] = &[
    [-0.062, 0.026, 0.014, 0.0035, 0.0035],
    [-0.035, 0.008, 0.018, 0.0060, 0.0060],
    [0.0, 0.0, 0.020, 0.0070, 0.0070],
    [0.035, 0.008, 0.018, 0.0060, 0.0060],
    [0.062, 0.026, 0.014, 0.0035, 0.0035],
];
