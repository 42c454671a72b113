//! Andy: a grown man of 1.80 m in an A-pose, arms 42° below the horizontal, 7.6 heads tall. Feet on y = 0, facing +Z.
//! Lengths in metres. The face is kept to planes a sculptor would begin with: a likeness half reached looks uncanny.

use super::figure::{Figure, JointRow, Part};
use super::loft::Role::Carve;

const UP: [f64; 3] = [0.0, 1.0, 0.0];
const SIDE: [f64; 3] = [1.0, 0.0, 0.0];
const FRONT: [f64; 3] = [0.0, 0.0, 1.0];
/// Along the left arm: cos 42°, -sin 42°; and from the back of the hand to the palm.
const ARM: [f64; 3] = [0.7431, -0.6691, 0.0];
const PALM: [f64; 3] = [-0.6691, -0.7431, 0.0];
/// Along the left eyebrow outward, and up the ear.
const BROW: [f64; 3] = [1.0, 0.03, -0.30];
const EAR: [f64; 3] = [0.08, 1.0, -0.18];
/// The left wrist.
const WRIST: [f64; 3] = [0.5937, 1.0737, -0.018];

const SKIN: [f32; 3] = [0.58, 0.34, 0.23];
const HAIR: [f32; 3] = [0.045, 0.028, 0.018];
const LIP: [f32; 3] = [0.46, 0.21, 0.15];
const EYE: [f32; 3] = [0.55, 0.52, 0.48];
const IRIS: [f32; 3] = [0.045, 0.022, 0.012];
const BRIEFS: [f32; 3] = [0.06, 0.075, 0.10];

/// The table of Andy.
pub const ANDY: Figure = Figure { joints: JOINTS, parts: PARTS, cell: 0.005, colour: SKIN };

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

const HEAD: &[(&str, f64, f64)] = &[("Head", 0.0, 0.01)];
const CHEST: &[(&str, f64, f64)] = &[("Spine2", 0.0, 0.01)];
const HAND: &[(&str, f64, f64)] = &[("LeftHand", 0.0, 0.01)];
const TOES: &[(&str, f64, f64)] = &[("LeftToeBase", 0.0, 0.01)];

const PARTS: &[Part] = &[
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
    // Palm, ball of the thumb, fingers, thumb.
    Part::loft(WRIST, HAND_BACK, [0.02, 0.018])
        .along(ARM, FRONT)
        .exponent(2.5)
        .blend(0.03, 0.013)
        .on(&[("LeftForeArm", -0.05, 0.01), ("LeftHand", 0.0, 0.035)]),
    Part::ball([0.6190, 1.0400, 0.002], [0.0150, 0.0160, 0.034])
        .along([0.72, -0.62, 0.28], FRONT)
        .blend(0.024, 0.012)
        .on(HAND),
    finger(0.090, 0.0135, 0.10, [0.0098, 0.076]),
    finger(0.094, -0.0085, 0.03, [0.0102, 0.085]),
    finger(0.090, -0.0300, -0.05, [0.0098, 0.078]),
    finger(0.083, -0.0500, -0.14, [0.0088, 0.062]),
    Part::loft([0.6180, 1.0400, 0.008], FINGER, [0.006, 0.008])
        .size([0.0108, 0.0108, 0.074])
        .along([0.66, -0.62, 0.60], PALM)
        .blend(0.016, 0.0095)
        .on(HAND),
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
    // Foot, heel to ball: its front axis points up, and centre = back keeps the sole on the ground. Ankle bones, toes.
    Part::loft([0.1015, 0.0, -0.062], FOOT, [0.028, 0.030])
        .along([0.024, 0.0, 0.240], [0.0, 1.0, 0.0])
        .exponent(2.3)
        .blend(0.035, 0.016)
        .on(&[("LeftFoot", 0.0, 0.01), ("LeftToeBase", 0.168, 0.024)]),
    Part::ball([0.103, 0.088, -0.028], [0.037, 0.020, 0.016]).blend(0.02, 0.016).on(&[("LeftFoot", 0.0, 0.01)]),
    toe([0.0965, 0.0135, 0.152], [0.0145, 0.0135, 0.030]),
    toe([0.1180, 0.0115, 0.153], [0.0095, 0.0110, 0.026]),
    toe([0.1345, 0.0110, 0.146], [0.0092, 0.0105, 0.024]),
    toe([0.1495, 0.0105, 0.136], [0.0088, 0.0100, 0.022]),
    toe([0.1630, 0.0100, 0.124], [0.0085, 0.0095, 0.020]),
    // Head: skull, face, chin, cheek bones.
    Part::ball([0.0, 1.712, -0.004], [0.0745, 0.0950, 0.0830]).blend(0.03, 0.018).on(&[("Head", 0.0, 0.01)]),
    Part::loft([0.0, 1.563, 0.026], FACE, [0.024, 0.050]).exponent(2.4).blend(0.025, 0.010).on(HEAD),
    Part::ball([0.0, 1.5800, 0.0830], [0.0210, 0.0140, 0.0145]).blend(0.022, 0.009).on(HEAD),
    Part::ball([0.044, 1.665, 0.056], [0.020, 0.018, 0.013]).blend(0.03, 0.009).on(HEAD),
    // Brow, eye socket, upper and lower lid.
    Part::ball([0.029, 1.7105, 0.0780], [0.0075, 0.0100, 0.0260]).along(BROW, FRONT).blend(0.016, 0.008).on(HEAD),
    Part::ball([0.0320, 1.6920, 0.0970], [0.0200, 0.0130, 0.0120]).role(Carve).blend(0.012, 0.005).on(HEAD),
    Part::ball([0.0320, 1.6969, 0.0722], [0.0142, 0.0134, 0.0134]).blend(0.003, 0.0038).on(HEAD),
    Part::ball([0.0320, 1.6858, 0.0722], [0.0142, 0.0132, 0.0132]).blend(0.002, 0.0038).on(HEAD),
    // Nose: ridge, tip, wings.
    Part::loft([0.0, 1.704, 0.0840], NOSE, [0.016, 0.006])
        .along([0.0, -0.050, 0.0165], FRONT)
        .blend(0.016, 0.006)
        .on(HEAD),
    Part::ball([0.0, 1.6535, 0.1010], [0.0120, 0.0110, 0.0095]).blend(0.010, 0.006).on(HEAD),
    Part::ball([0.0130, 1.6520, 0.0915], [0.0080, 0.0110, 0.0075]).blend(0.009, 0.006).on(HEAD),
    // Lips, and the line between them.
    Part::ball([0.0, 1.6225, 0.0800], [0.0058, 0.0105, 0.0250])
        .along(SIDE, FRONT)
        .coloured(LIP)
        .blend(0.010, 0.0045)
        .on(HEAD),
    Part::ball([0.0, 1.6125, 0.0792], [0.0064, 0.0105, 0.0210])
        .along(SIDE, FRONT)
        .coloured(LIP)
        .blend(0.010, 0.0045)
        .on(HEAD),
    Part::ball([0.0, 1.6177, 0.0925], [0.0018, 0.0060, 0.0260])
        .along(SIDE, FRONT)
        .role(Carve)
        .blend(0.004, 0.0045)
        .on(HEAD),
    // Ear, and its hollow.
    Part::ball([0.0750, 1.6830, 0.0000], [0.0065, 0.0165, 0.0300])
        .along(EAR, [0.25, 0.0, 1.0])
        .blend(0.010, 0.008)
        .on(HEAD),
    Part::ball([0.0835, 1.6850, 0.0040], [0.0050, 0.0080, 0.0150])
        .along(EAR, [0.25, 0.0, 1.0])
        .role(Carve)
        .blend(0.006, 0.007)
        .on(HEAD),
    Part::belt([0.805, 1.010], 0.3, BRIEFS),
    // Hair, eyebrows.
    Part::ball([0.0, 1.7290, -0.0190], [0.0800, 0.0985, 0.0815]).shell(1).coloured(HAIR).blend(0.02, 0.015).on(HEAD),
    Part::ball([0.0, 1.7800, 0.0440], [0.0520, 0.0380, 0.0250]).shell(1).coloured(HAIR).blend(0.03, 0.012).on(HEAD),
    Part::ball([0.0, 1.6720, -0.0560], [0.0600, 0.0420, 0.0500]).shell(1).coloured(HAIR).blend(0.03, 0.014).on(HEAD),
    Part::ball([0.0320, 1.7125, 0.0860], [0.0034, 0.0060, 0.0200])
        .along(BROW, FRONT)
        .shell(2)
        .coloured(HAIR)
        .blend(0.001, 0.006)
        .on(HEAD),
    // Eyes: ball and iris.
    Part::ball([0.0320, 1.6915, 0.0740], [0.0142, 0.0128, 0.0128]).shell(3).coloured(EYE).blend(0.001, 0.005).on(HEAD),
    Part::ball([0.0316, 1.6915, 0.0846], [0.0068, 0.0030, 0.0068]).shell(4).coloured(IRIS).blend(0.001, 0.003).on(HEAD),
];

/// A finger that starts `at` metres beyond the wrist at depth `z` and points forward by `spread`. Radius, length.
const fn finger(at: f64, z: f64, spread: f64, [radius, length]: [f64; 2]) -> Part {
    let start = [WRIST[0] + at * ARM[0], WRIST[1] + at * ARM[1], WRIST[2] + z];
    let along = [ARM[0], ARM[1], spread];
    Part::loft(start, FINGER, [0.10, 0.10])
        .size([radius, radius, length])
        .along(along, PALM)
        .blend(0.009, 0.009)
        .on(HAND)
}

/// A toe, an ellipsoid.
const fn toe(centre: [f64; 3], half_axes: [f64; 3]) -> Part {
    Part::ball(centre, half_axes).along([0.10, -0.06, 1.0], UP).blend(0.010, 0.011).on(TOES)
}

/// Sections of a finger in units of its radius and length. It curls a little towards the palm.
const FINGER: &[[f64; 5]] = &[
    [-0.10, 0.0, 1.02, 1.05, 1.05],
    [0.20, 0.0, 1.0, 1.0, 1.0],
    [0.50, 0.18, 0.96, 0.96, 0.96],
    [0.80, 0.70, 0.86, 0.84, 0.84],
    [0.93, 1.05, 0.76, 0.72, 0.72],
];
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
const HAND_BACK: &[[f64; 5]] = &[
    [-0.010, 0.002, 0.0205, 0.028, 0.026],
    [0.030, 0.000, 0.0180, 0.036, 0.036],
    [0.062, -0.002, 0.0155, 0.0400, 0.0415],
    [0.085, -0.004, 0.0130, 0.0390, 0.0410],
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
const FOOT: &[[f64; 5]] = &[
    [0.00, 0.034, 0.0310, 0.044, 0.034],
    [0.05, 0.034, 0.0330, 0.056, 0.034],
    [0.10, 0.030, 0.0370, 0.050, 0.030],
    [0.155, 0.022, 0.0440, 0.030, 0.022],
    [0.185, 0.018, 0.0440, 0.018, 0.018],
];
const FACE: &[[f64; 5]] = &[
    [0.020, 0.000, 0.039, 0.058, 0.050],
    [0.052, 0.000, 0.053, 0.0595, 0.060],
    [0.095, 0.000, 0.061, 0.056, 0.060],
    [0.145, 0.000, 0.064, 0.055, 0.060],
];
const NOSE: &[[f64; 5]] =
    &[[0.0, 0.0, 0.0075, 0.006, 0.012], [0.026, 0.0, 0.0090, 0.0080, 0.012], [0.048, 0.0, 0.0110, 0.0090, 0.012]];
