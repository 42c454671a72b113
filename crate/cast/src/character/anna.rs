//! Anna: a grown woman of 1.70 m of the same kit as Andy: arms 42° below the horizontal, six and a half heads tall, in
//! sneakers, a sports top and shorts. Feet on y = 0, facing +Z. Lengths in metres.

use super::face::{self, Face, face, lips};
use super::figure::{BOX, Figure, JointRow, Part};
use super::hand::{self, hand};
use super::loft::Role::Paint;
use super::person::{ARM, CHEST, FRONT, HEAD, all, placed};
use super::shoe::{self, shoe};

/// The left wrist, and the middle of the eye line.
const WRIST: [f64; 3] = [0.5325, 0.9948, -0.017];
const EYES: [f64; 3] = [0.0, 1.5820, 0.0];

const SKIN: [f32; 3] = [0.48, 0.245, 0.14];
const BLUSH: [f32; 3] = [0.50, 0.185, 0.11];
const LIP: [f32; 3] = [0.38, 0.105, 0.085];
const HAIR: [f32; 3] = [0.034, 0.018, 0.012];
const IRIS: [f32; 3] = [0.095, 0.042, 0.014];
const SPORTSWEAR: [f32; 3] = [0.035, 0.13, 0.135];
const LEATHER: [f32; 3] = [0.62, 0.40, 0.10];
const SOCK: [f32; 3] = [0.70, 0.69, 0.66];

/// The table of Anna.
pub const ANNA: Figure = Figure { joints: JOINTS, parts: PARTS, cell: 0.005, colour: SKIN };

const PARTS: &[Part] = &all::<{ BODY.len() + hand::ROWS + shoe::ROWS + face::ROWS + 1 + HAIRDO.len() }>(&[
    BODY,
    &hand(WRIST, 0.90),
    &shoe([0.0925, 0.0, -0.056], 0.90, LEATHER, SOCK),
    &face(&FACE),
    &lips(&FACE, LIP),
    &placed(HAIRDO, EYES, 0.93),
]);

const FACE: Face =
    Face { at: EYES, scale: 0.93, jaw: 0.86, brow: 0.75, lash: 1.5, blush: BLUSH, iris: IRIS, hair: HAIR };

const JOINTS: &[JointRow] = &[
    ("Hips", "", [0.0, 0.905, -0.005]),
    ("Spine", "Hips", [0.0, 0.990, -0.008]),
    ("Spine1", "Spine", [0.0, 1.100, -0.010]),
    ("Spine2", "Spine1", [0.0, 1.215, -0.015]),
    ("Neck", "Spine2", [0.0, 1.392, -0.028]),
    ("Head", "Neck", [0.0, 1.482, -0.007]),
    ("LeftShoulder", "Spine2", [0.026, 1.345, -0.014]),
    ("LeftArm", "LeftShoulder", [0.158, 1.332, -0.018]),
    ("LeftForeArm", "LeftArm", [0.3586, 1.1513, -0.020]),
    ("LeftHand", "LeftForeArm", WRIST),
    ("LeftUpLeg", "Hips", [0.088, 0.862, -0.004]),
    ("LeftLeg", "LeftUpLeg", [0.090, 0.475, 0.000]),
    ("LeftFoot", "LeftLeg", [0.092, 0.080, -0.024]),
    ("LeftToeBase", "LeftFoot", [0.102, 0.019, 0.100]),
];

const BODY: &[Part] = &[
    // Trunk, from the hips to the collar bones.
    Part::loft([0.0, 0.815, -0.006], TRUNK, [0.10, 0.03]).exponent(2.25).blend(0.03, 0.025).on(&[
        ("Hips", 0.0, 0.01),
        ("Spine", 0.175, 0.070),
        ("Spine1", 0.285, 0.070),
        ("Spine2", 0.400, 0.070),
        ("Neck", 0.580, 0.04),
    ]),
    // Breast, shoulder blade, seat.
    Part::ball([0.062, 1.236, 0.058], [0.058, 0.050, 0.055]).blend(0.050, 0.020).on(CHEST),
    Part::ball([0.072, 1.268, -0.070], [0.058, 0.030, 0.075]).blend(0.045, 0.024).on(CHEST),
    Part::ball([0.074, 0.872, -0.060], [0.082, 0.062, 0.086])
        .along([0.0, -1.0, 0.10], FRONT)
        .blend(0.045, 0.024)
        .on(&[("Hips", 0.0, 0.01), ("LeftUpLeg", 0.045, 0.085)]),
    // Neck.
    Part::loft([0.0, 1.330, -0.042], NECK, [0.03, 0.02]).along([0.0, 0.170, 0.034], FRONT).blend(0.055, 0.018).on(&[
        ("Spine2", 0.0, 0.01),
        ("Neck", 0.058, 0.042),
        ("Head", 0.152, 0.033),
    ]),
    // Collar bone and shoulder.
    Part::loft([0.020, 1.405, -0.040], COLLAR, [0.03, 0.03])
        .along([0.140, -0.073, 0.018], FRONT)
        .blend(0.055, 0.021)
        .on(&[("Spine2", 0.0, 0.01), ("LeftShoulder", 0.054, 0.050), ("LeftArm", 0.158, 0.042)]),
    Part::ball([0.177, 1.315, -0.018], [0.044, 0.051, 0.068])
        .along(ARM, FRONT)
        .blend(0.042, 0.021)
        .on(&[("LeftShoulder", -0.06, 0.02), ("LeftArm", -0.018, 0.060)]),
    // Arm, shoulder to wrist.
    Part::loft([0.158, 1.332, -0.018], LIMB, [0.045, 0.02]).along(ARM, FRONT).blend(0.042, 0.020).on(&[
        ("LeftShoulder", -0.05, 0.02),
        ("LeftArm", 0.010, 0.064),
        ("LeftForeArm", 0.270, 0.050),
        ("LeftHand", 0.486, 0.033),
    ]),
    // Leg, hip to ankle.
    Part::loft([0.088, 0.895, -0.004], LEG, [0.08, 0.03])
        .along([0.004, -0.815, -0.020], FRONT)
        .exponent(2.05)
        .blend(0.04, 0.025)
        .on(&[
            ("Hips", -0.02, 0.02),
            ("LeftUpLeg", 0.047, 0.080),
            ("LeftLeg", 0.420, 0.066),
            ("LeftFoot", 0.810, 0.040),
        ]),
    // Shorts; top with its straps.
    Part::belt([0.670, 0.960], 0.3, SPORTSWEAR),
    Part::belt([1.145, 1.272], 0.150, SPORTSWEAR),
    Part::loft([0.078, 1.262, 0.0], BOX, [1e-4; 2])
        .size([0.034, 0.4, 0.20])
        .exponent(8.0)
        .role(Paint)
        .coloured(SPORTSWEAR)
        .blend(0.0, 0.02),
];

const HAIRDO: [Part; 5] = [
    strand([0.0, 0.0480, -0.0220], [0.1040, 0.1100, 0.1060]).blend(0.02, 0.020),
    // A bob: behind, and at the sides down to the jaw.
    strand([0.0, -0.0380, -0.0560], [0.1020, 0.0680, 0.0920]).blend(0.05, 0.018),
    strand([0.0880, -0.0330, -0.0080], [0.0270, 0.0600, 0.0900]).blend(0.045, 0.014),
    // Volume above the brow, parted in the middle.
    strand([0.0, 0.1040, 0.0320], [0.0800, 0.0620, 0.0400]).blend(0.03, 0.016),
    Part::loft([0.0080, 0.1160, 0.0640], LOCK, [0.020, 0.030])
        .along([0.80, -0.62, -0.34], FRONT)
        .shell(1)
        .coloured(HAIR)
        .blend(0.015, 0.012)
        .on(HEAD),
];

/// A ball of hair.
const fn strand(centre: [f64; 3], half_axes: [f64; 3]) -> Part {
    Part::ball(centre, half_axes).shell(1).coloured(HAIR).on(HEAD)
}

const TRUNK: &[[f64; 5]] = &[
    [0.050, 0.000, 0.166, 0.088, 0.098],
    [0.120, 0.000, 0.159, 0.090, 0.098],
    [0.190, 0.002, 0.135, 0.086, 0.084],
    [0.245, 0.002, 0.1205, 0.082, 0.074],
    [0.310, 0.000, 0.1230, 0.084, 0.076],
    [0.390, -0.005, 0.1380, 0.090, 0.086],
    [0.465, -0.010, 0.1420, 0.086, 0.088],
    [0.525, -0.016, 0.1130, 0.064, 0.076],
    [0.570, -0.020, 0.0690, 0.046, 0.054],
];
const NECK: &[[f64; 5]] = &[
    [0.000, 0.0, 0.0600, 0.050, 0.056],
    [0.055, 0.0, 0.0470, 0.045, 0.050],
    [0.110, 0.0, 0.0425, 0.042, 0.047],
    [0.190, 0.0, 0.0425, 0.041, 0.049],
];
const COLLAR: &[[f64; 5]] =
    &[[0.0, 0.0, 0.022, 0.029, 0.034], [0.070, 0.0, 0.031, 0.038, 0.043], [0.145, 0.0, 0.039, 0.044, 0.046]];
const LIMB: &[[f64; 5]] = &[
    [0.000, 0.000, 0.0420, 0.0460, 0.0450],
    [0.055, 0.000, 0.0420, 0.0460, 0.0450],
    [0.120, 0.002, 0.0390, 0.0450, 0.0420],
    [0.185, 0.002, 0.0365, 0.0420, 0.0400],
    [0.256, 0.000, 0.0330, 0.0340, 0.0360],
    [0.310, 0.002, 0.0350, 0.0370, 0.0340],
    [0.365, 0.002, 0.0330, 0.0350, 0.0320],
    [0.430, 0.002, 0.0260, 0.0285, 0.0265],
    [0.485, 0.002, 0.0205, 0.0255, 0.0240],
    [0.512, 0.002, 0.0190, 0.0255, 0.0240],
];
const LEG: &[[f64; 5]] = &[
    [0.040, 0.000, 0.0840, 0.086, 0.090],
    [0.100, 0.000, 0.0860, 0.089, 0.092],
    [0.180, 0.003, 0.0800, 0.086, 0.085],
    [0.280, 0.007, 0.0675, 0.076, 0.069],
    [0.375, 0.008, 0.0555, 0.058, 0.055],
    [0.420, 0.009, 0.0510, 0.051, 0.049],
    [0.478, 0.004, 0.0495, 0.045, 0.053],
    [0.553, -0.002, 0.0525, 0.043, 0.062],
    [0.647, 0.000, 0.0425, 0.037, 0.052],
    [0.740, 0.000, 0.0315, 0.032, 0.038],
    [0.812, 0.000, 0.0300, 0.034, 0.035],
];
const LOCK: &[[f64; 5]] = &[
    [0.000, 0.000, 0.0200, 0.0190, 0.020],
    [0.050, 0.006, 0.0270, 0.0220, 0.024],
    [0.095, -0.004, 0.0160, 0.0130, 0.018],
];
