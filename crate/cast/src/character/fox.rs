//! The fox: 0.68 m from nose to rump, 0.38 m at the withers, standing on y = 0 and facing +Z; a brush of 0.42 m.
//! Proportions of *Vulpes vulpes*; lengths in metres. Legs are lofts on vertical chords; sections shift with the bones.

use super::figure::{Figure, JointRow, Part};
use super::loft::Role;
use super::paw::{eye, paint, paw, toe};

const UP: [f64; 3] = [0.0, 1.0, 0.0];
const DOWN: [f64; 3] = [0.0, -1.0, 0.0];
const FORWARD: [f64; 3] = [0.0, 0.0, 1.0];
/// Along the brush: 40° below the horizontal.
const BRUSH: [f64; 3] = [0.0, -0.6428, -0.7660];

const RED: [f32; 3] = [0.56, 0.135, 0.022];
const WHITE: [f32; 3] = [0.82, 0.76, 0.66];
const BLACK: [f32; 3] = [0.020, 0.015, 0.013];

/// The table of the fox.
pub const FOX: Figure = Figure { joints: JOINTS, parts: PARTS, cell: 0.0035, colour: RED };

#[expect(clippy::approx_constant, reason = "0.318 is the height of a hip, not 1/π")]
const JOINTS: &[JointRow] = &[
    ("Hips", "", [0.0, 0.345, -0.190]),
    ("Spine", "Hips", [0.0, 0.352, -0.115]),
    ("Spine1", "Spine", [0.0, 0.352, -0.030]),
    ("Spine2", "Spine1", [0.0, 0.348, 0.050]),
    ("Neck", "Spine2", [0.0, 0.362, 0.130]),
    ("Neck1", "Neck", [0.0, 0.420, 0.165]),
    ("Head", "Neck1", [0.0, 0.468, 0.195]),
    ("LeftEar", "Head", [0.034, 0.508, 0.190]),
    ("LeftFrontShoulder", "Spine2", [0.034, 0.345, 0.085]),
    ("LeftFrontUpLeg", "LeftFrontShoulder", [0.046, 0.280, 0.130]),
    ("LeftFrontLeg", "LeftFrontUpLeg", [0.048, 0.212, 0.078]),
    ("LeftFrontFoot", "LeftFrontLeg", [0.046, 0.085, 0.094]),
    ("LeftFrontToes", "LeftFrontFoot", [0.046, 0.020, 0.112]),
    ("LeftBackUpLeg", "Hips", [0.042, 0.318, -0.205]),
    ("LeftBackLeg", "LeftBackUpLeg", [0.052, 0.205, -0.152]),
    ("LeftBackFoot", "LeftBackLeg", [0.050, 0.108, -0.248]),
    ("LeftBackToes", "LeftBackFoot", [0.050, 0.020, -0.222]),
    ("Tail", "Hips", [0.0, 0.352, -0.272]),
    ("Tail1", "Tail", [0.0, 0.2973, -0.3371]),
    ("Tail2", "Tail1", [0.0, 0.2427, -0.4022]),
    ("Tail3", "Tail2", [0.0, 0.1881, -0.4673]),
    ("Tail4", "Tail3", [0.0, 0.1335, -0.5324]),
];

const EYE: [Part; 3] = eye([0.0258, 0.4920, 0.2468], [0.62, 0.14, 0.78], [0.0100, 0.0046, 0.0068], [0.42, 0.16, 0.015]);

const PARTS: &[Part] = &[
    TRUNK,
    NECK,
    // Fur of the chest.
    Part::loft(
        [0.0, 0.355, 0.150],
        &[[0.0, 0.0, 0.036, 0.026, 0.030], [0.045, 0.0, 0.042, 0.028, 0.04], [0.10, -0.01, 0.034, 0.02, 0.04]],
        [0.04, 0.045],
    )
    .along([0.0, -1.0, -0.25], FORWARD)
    .blend(0.05, 0.014)
    .on(&[("Neck", 0.0, 0.01), ("Spine2", 0.03, 0.035)]),
    // Thigh.
    Part::loft(
        [0.036, 0.345, -0.215],
        &[
            [0.00, 0.0, 0.030, 0.046, 0.044],
            [0.05, 0.0, 0.033, 0.054, 0.048],
            [0.10, 0.0, 0.029, 0.048, 0.040],
            [0.15, -0.004, 0.022, 0.032, 0.028],
        ],
        [0.04, 0.03],
    )
    .along([0.013, -0.150, 0.058], FORWARD)
    .blend(0.04, 0.014)
    .on(&[("Hips", -0.03, 0.02), ("LeftBackUpLeg", 0.045, 0.055), ("LeftBackLeg", 0.150, 0.03)]),
    // Hind leg, stifle to paw.
    Part::loft(
        [0.051, 0.215, -0.160],
        &[
            [0.000, 0.000, 0.024, 0.033, 0.034],
            [0.040, -0.030, 0.0205, 0.028, 0.030],
            [0.075, -0.062, 0.0150, 0.0215, 0.022],
            [0.108, -0.084, 0.0120, 0.0160, 0.0165],
            [0.140, -0.078, 0.0115, 0.0135, 0.0130],
            [0.190, -0.064, 0.0125, 0.0140, 0.0130],
        ],
        [0.03, 0.02],
    )
    .along(DOWN, FORWARD)
    .blend(0.03, 0.0100)
    .on(&[
        ("LeftBackUpLeg", -0.03, 0.01),
        ("LeftBackLeg", 0.005, 0.030),
        ("LeftBackFoot", 0.106, 0.020),
        ("LeftBackToes", 0.192, 0.012),
    ]),
    // Shoulder blade and upper arm.
    Part::loft(
        [0.034, 0.352, 0.080],
        &[
            [0.00, 0.0, 0.022, 0.036, 0.034],
            [0.05, 0.004, 0.028, 0.042, 0.042],
            [0.10, 0.002, 0.027, 0.036, 0.044],
            [0.14, -0.008, 0.022, 0.026, 0.034],
        ],
        [0.03, 0.03],
    )
    .along([0.013, -0.150, 0.020], FORWARD)
    .blend(0.04, 0.014)
    .on(&[
        ("Spine2", -0.03, 0.02),
        ("LeftFrontShoulder", 0.020, 0.035),
        ("LeftFrontUpLeg", 0.080, 0.03),
        ("LeftFrontLeg", 0.146, 0.025),
    ]),
    // Foreleg, elbow to paw.
    Part::loft(
        [0.048, 0.230, 0.082],
        &[
            [0.000, 0.000, 0.022, 0.030, 0.030],
            [0.040, -0.001, 0.0175, 0.023, 0.024],
            [0.090, 0.005, 0.0140, 0.0165, 0.017],
            [0.145, 0.012, 0.0125, 0.0140, 0.0145],
            [0.175, 0.019, 0.0120, 0.0135, 0.0130],
            [0.208, 0.026, 0.0130, 0.0140, 0.0130],
        ],
        [0.03, 0.02],
    )
    .along([-0.002, -0.230, 0.0], FORWARD)
    .blend(0.03, 0.0100)
    .on(&[
        ("LeftFrontUpLeg", -0.03, 0.01),
        ("LeftFrontLeg", 0.012, 0.025),
        ("LeftFrontFoot", 0.145, 0.020),
        ("LeftFrontToes", 0.208, 0.012),
    ]),
    paw(BACK_PAW, PAW_SIZE, BLACK, BACK_TOES),
    toe(BACK_PAW, PAW_SIZE, 0, BLACK, BACK_TOES),
    toe(BACK_PAW, PAW_SIZE, 1, BLACK, BACK_TOES),
    toe(BACK_PAW, PAW_SIZE, 2, BLACK, BACK_TOES),
    toe(BACK_PAW, PAW_SIZE, 3, BLACK, BACK_TOES),
    paw(FRONT_PAW, PAW_SIZE, BLACK, FRONT_TOES),
    toe(FRONT_PAW, PAW_SIZE, 0, BLACK, FRONT_TOES),
    toe(FRONT_PAW, PAW_SIZE, 1, BLACK, FRONT_TOES),
    toe(FRONT_PAW, PAW_SIZE, 2, BLACK, FRONT_TOES),
    toe(FRONT_PAW, PAW_SIZE, 3, BLACK, FRONT_TOES),
    // Brush.
    Part::loft(
        [0.0, 0.350, -0.262],
        &[
            [0.00, 0.0, 0.026, 0.026, 0.026],
            [0.06, 0.0, 0.029, 0.030, 0.030],
            [0.14, 0.0, 0.041, 0.042, 0.042],
            [0.24, 0.0, 0.050, 0.050, 0.052],
            [0.33, 0.0, 0.041, 0.040, 0.042],
            [0.40, 0.0, 0.022, 0.021, 0.022],
        ],
        [0.03, 0.045],
    )
    .along(BRUSH, [0.0, 0.766, -0.643])
    .blend(0.045, 0.015)
    .on(&[
        ("Hips", -0.04, 0.01),
        ("Tail", 0.012, 0.025),
        ("Tail1", 0.097, 0.042),
        ("Tail2", 0.182, 0.042),
        ("Tail3", 0.267, 0.042),
        ("Tail4", 0.352, 0.042),
    ]),
    SKULL,
    // Cheek ruff.
    Part::loft(
        [0.022, 0.470, 0.212],
        &[[0.0, 0.0, 0.030, 0.020, 0.020], [0.028, 0.0, 0.017, 0.009, 0.010]],
        [0.02, 0.020],
    )
    .along([1.0, -0.42, -0.42], FORWARD)
    .blend(0.02, 0.0075)
    .on(HEAD),
    MUZZLE,
    // Brow.
    Part::ball([0.020, 0.503, 0.240], [0.015, 0.018, 0.008]).on(HEAD).blend(0.016, 0.0075),
    // Lower jaw.
    Part::ball([0.0, 0.4505, 0.278], [0.012, 0.034, 0.008]).on(HEAD).blend(0.012, 0.0052),
    // Eye socket, then the lid over it.
    Part::ball([0.0285, 0.4930, 0.2505], [0.0095; 3]).on(HEAD).role(Role::Carve).blend(0.006, 0.0048),
    Part::ball([0.0262, 0.5018, 0.2454], [0.0112, 0.0116, 0.0054]).on(HEAD).blend(0.004, 0.0042),
    EAR,
    // Hollow of the ear.
    Part {
        start: [0.0415, 0.511, 0.2095],
        role: Role::Carve,
        sections: &[[0.004, 0.0, 0.0150, 0.012, 0.0120], [0.050, 0.0, 0.0050, 0.006, 0.0060]],
        caps: [0.010, 0.010],
        blend: 0.006,
        edge: 0.0048,
        ..EAR
    },
    // White: chest and belly, cheeks and chin, tip of the brush.
    paint([0.0, 0.300, 0.175], [0.036, 0.110, 0.085], WHITE, 0.022),
    paint([0.0, 0.235, 0.000], [0.040, 0.050, 0.200], WHITE, 0.022),
    paint([0.0, 0.375, 0.185], [0.044, 0.060, 0.050], WHITE, 0.020),
    paint([0.052, 0.448, 0.235], [0.038, 0.026, 0.045], WHITE, 0.012),
    paint([0.0, 0.436, 0.270], [0.050, 0.025, 0.085], WHITE, 0.010),
    paint([0.0, 0.080, -0.590], [0.080, 0.085, 0.080], WHITE, 0.030),
    // Black: socks, backs of the ears.
    paint([0.048, 0.035, 0.105], [0.036, 0.100, 0.060], BLACK, 0.040),
    paint([0.050, 0.030, -0.225], [0.036, 0.090, 0.070], BLACK, 0.040),
    paint([0.058, 0.570, 0.176], [0.040, 0.042, 0.022], BLACK, 0.010),
    paint([0.0415, 0.535, 0.2115], [0.014, 0.032, 0.012], [0.50, 0.36, 0.27], 0.006),
    // Nose.
    Part::ball([0.0, 0.4680, 0.3380], [0.0074, 0.0064, 0.0060]).on(HEAD).blend(0.03, 0.0030).shell(2).coloured(BLACK),
    EYE[0],
    EYE[1],
    EYE[2],
];

const HEAD: &[(&str, f64, f64)] = &[("Head", 0.0, 0.01)];
const BACK_TOES: &[(&str, f64, f64)] = &[("LeftBackFoot", -0.02, 0.01), ("LeftBackToes", 0.004, 0.010)];
const FRONT_TOES: &[(&str, f64, f64)] = &[("LeftFrontFoot", -0.02, 0.01), ("LeftFrontToes", 0.004, 0.010)];
const BACK_PAW: [f64; 3] = [0.050, 0.0, -0.242];
const FRONT_PAW: [f64; 3] = [0.046, 0.0, 0.090];
const PAW_SIZE: [f64; 3] = [0.039, 0.028, 0.062];

const TRUNK: Part = Part::loft(
    [0.0, 0.335, -0.255],
    &[
        [0.00, 0.008, 0.044, 0.036, 0.048],
        [0.06, 0.002, 0.054, 0.046, 0.058],
        [0.14, 0.004, 0.051, 0.046, 0.052],
        [0.22, 0.002, 0.056, 0.046, 0.066],
        [0.30, -0.006, 0.060, 0.054, 0.080],
        [0.36, -0.004, 0.055, 0.055, 0.078],
        [0.41, 0.000, 0.044, 0.046, 0.060],
    ],
    [0.04, 0.04],
)
.along(FORWARD, UP)
.exponent(2.1)
.blend(0.04, 0.016)
.on(&[
    ("Hips", 0.0, 0.01),
    ("Spine", 0.140, 0.045),
    ("Spine1", 0.225, 0.045),
    ("Spine2", 0.305, 0.045),
    ("Neck", 0.395, 0.035),
]);

const NECK: Part = Part::loft(
    [0.0, 0.330, 0.100],
    &[
        [0.00, 0.0, 0.050, 0.052, 0.052],
        [0.07, 0.0, 0.046, 0.046, 0.044],
        [0.12, 0.0, 0.041, 0.040, 0.038],
        [0.16, 0.0, 0.038, 0.036, 0.034],
    ],
    [0.04, 0.03],
)
.along([0.0, 0.140, 0.095], FORWARD)
.blend(0.05, 0.014)
.on(&[("Spine2", 0.0, 0.01), ("Neck", 0.045, 0.035), ("Neck1", 0.095, 0.032), ("Head", 0.150, 0.025)]);

const SKULL: Part = Part::loft(
    [0.0, 0.480, 0.190],
    &[[0.000, 0.0, 0.038, 0.036, 0.034], [0.030, 0.0, 0.043, 0.037, 0.034], [0.060, -0.002, 0.033, 0.029, 0.027]],
    [0.034, 0.028],
)
.along([0.0, -0.06, 1.0], UP)
.blend(0.03, 0.0095)
.on(&[("Neck1", -0.1, 0.01), ("Head", 0.0, 0.02)]);

const MUZZLE: Part = Part::loft(
    [0.0, 0.472, 0.245],
    &[[0.000, 0.0, 0.025, 0.022, 0.022], [0.040, 0.0, 0.0165, 0.0145, 0.015], [0.078, 0.0, 0.0115, 0.0105, 0.011]],
    [0.02, 0.018],
)
.along([0.0, -0.10, 1.0], UP)
.blend(0.026, 0.0052)
.on(HEAD);

const EAR: Part = Part::loft(
    [0.032, 0.502, 0.192],
    &[[0.000, 0.0, 0.024, 0.012, 0.010], [0.025, 0.0, 0.0205, 0.010, 0.008], [0.048, 0.0, 0.0115, 0.007, 0.006]],
    [0.015, 0.026],
)
.along([0.30, 1.0, -0.02], [0.35, 0.0, 1.0])
.blend(0.014, 0.0048)
.on(&[("Head", 0.0, 0.01), ("LeftEar", 0.010, 0.012)]);
