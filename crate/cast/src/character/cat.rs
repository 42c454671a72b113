//! The cat: 0.48 m from nose to rump, 0.26 m at the withers, standing on y = 0 and facing +Z; a tail of 0.30 m.
//! A grey shorthair with a white bib and white paws; lengths in metres. Legs as in `fox.rs`.

use super::figure::{Figure, JointRow, Part};
use super::loft::Role;
use super::paw::{eye, paint, paw, toe};

const UP: [f64; 3] = [0.0, 1.0, 0.0];
const DOWN: [f64; 3] = [0.0, -1.0, 0.0];
const FORWARD: [f64; 3] = [0.0, 0.0, 1.0];
/// Along the tail: 35° below the horizontal.
const TAIL: [f64; 3] = [0.0, -0.5736, -0.8192];

const GREY: [f32; 3] = [0.135, 0.138, 0.155];
const WHITE: [f32; 3] = [0.80, 0.77, 0.72];
const PINK: [f32; 3] = [0.46, 0.19, 0.17];

/// The table of the cat.
pub const CAT: Figure = Figure { joints: JOINTS, parts: PARTS, cell: 0.0025, colour: GREY };

const JOINTS: &[JointRow] = &[
    ("Hips", "", [0.0, 0.235, -0.135]),
    ("Spine", "Hips", [0.0, 0.242, -0.085]),
    ("Spine1", "Spine", [0.0, 0.243, -0.025]),
    ("Spine2", "Spine1", [0.0, 0.240, 0.030]),
    ("Neck", "Spine2", [0.0, 0.252, 0.085]),
    ("Neck1", "Neck", [0.0, 0.280, 0.107]),
    ("Head", "Neck1", [0.0, 0.305, 0.125]),
    ("LeftEar", "Head", [0.026, 0.352, 0.138]),
    ("LeftFrontShoulder", "Spine2", [0.026, 0.236, 0.058]),
    ("LeftFrontUpLeg", "LeftFrontShoulder", [0.034, 0.192, 0.090]),
    ("LeftFrontLeg", "LeftFrontUpLeg", [0.036, 0.142, 0.052]),
    ("LeftFrontFoot", "LeftFrontLeg", [0.034, 0.052, 0.064]),
    ("LeftFrontToes", "LeftFrontFoot", [0.034, 0.014, 0.076]),
    ("LeftBackUpLeg", "Hips", [0.032, 0.215, -0.148]),
    ("LeftBackLeg", "LeftBackUpLeg", [0.040, 0.137, -0.106]),
    ("LeftBackFoot", "LeftBackLeg", [0.038, 0.068, -0.176]),
    ("LeftBackToes", "LeftBackFoot", [0.038, 0.014, -0.156]),
    ("Tail", "Hips", [0.0, 0.240, -0.200]),
    ("Tail1", "Tail", [0.0, 0.2067, -0.2475]),
    ("Tail2", "Tail1", [0.0, 0.1735, -0.2950]),
    ("Tail3", "Tail2", [0.0, 0.1402, -0.3425]),
    ("Tail4", "Tail3", [0.0, 0.1069, -0.3900]),
];

const EYE: [Part; 3] = eye([0.0185, 0.3270, 0.1672], [0.42, 0.08, 0.90], [0.0098, 0.0044, 0.0074], [0.27, 0.40, 0.06]);

const PARTS: &[Part] = &[
    TRUNK,
    NECK,
    // Thigh.
    Part::loft(
        [0.028, 0.232, -0.154],
        &[
            [0.000, 0.0, 0.024, 0.036, 0.034],
            [0.035, 0.0, 0.026, 0.042, 0.038],
            [0.070, 0.0, 0.023, 0.037, 0.033],
            [0.105, -0.004, 0.018, 0.026, 0.024],
        ],
        [0.03, 0.025],
    )
    .along([0.011, -0.105, 0.046], FORWARD)
    .blend(0.03, 0.0105)
    .on(&[("Hips", -0.02, 0.015), ("LeftBackUpLeg", 0.030, 0.042), ("LeftBackLeg", 0.106, 0.022)]),
    // Hind leg, stifle to paw.
    Part::loft(
        [0.039, 0.143, -0.112],
        &[
            [0.000, 0.000, 0.0195, 0.026, 0.027],
            [0.028, -0.024, 0.0165, 0.022, 0.024],
            [0.052, -0.048, 0.0130, 0.018, 0.019],
            [0.075, -0.061, 0.0112, 0.0145, 0.0145],
            [0.095, -0.056, 0.0108, 0.0125, 0.0120],
            [0.128, -0.045, 0.0118, 0.0130, 0.0120],
        ],
        [0.02, 0.014],
    )
    .along(DOWN, FORWARD)
    .blend(0.022, 0.0080)
    .on(&[
        ("LeftBackUpLeg", -0.02, 0.01),
        ("LeftBackLeg", 0.005, 0.022),
        ("LeftBackFoot", 0.074, 0.016),
        ("LeftBackToes", 0.130, 0.009),
    ]),
    // Shoulder blade and upper arm.
    Part::loft(
        [0.027, 0.244, 0.055],
        &[
            [0.000, 0.0, 0.018, 0.027, 0.026],
            [0.035, 0.003, 0.022, 0.031, 0.032],
            [0.070, 0.001, 0.021, 0.027, 0.033],
            [0.100, -0.008, 0.018, 0.020, 0.026],
        ],
        [0.024, 0.022],
    )
    .along([0.009, -0.105, 0.012], FORWARD)
    .blend(0.03, 0.0105)
    .on(&[
        ("Spine2", -0.02, 0.015),
        ("LeftFrontShoulder", 0.014, 0.026),
        ("LeftFrontUpLeg", 0.056, 0.022),
        ("LeftFrontLeg", 0.104, 0.018),
    ]),
    // Foreleg, elbow to paw.
    Part::loft(
        [0.036, 0.152, 0.056],
        &[
            [0.000, 0.000, 0.0180, 0.023, 0.024],
            [0.028, -0.001, 0.0150, 0.019, 0.020],
            [0.060, 0.003, 0.0126, 0.0150, 0.0155],
            [0.098, 0.008, 0.0115, 0.0130, 0.0132],
            [0.115, 0.013, 0.0112, 0.0125, 0.0122],
            [0.137, 0.018, 0.0120, 0.0130, 0.0120],
        ],
        [0.02, 0.014],
    )
    .along([-0.002, -0.152, 0.0], FORWARD)
    .blend(0.022, 0.0080)
    .on(&[
        ("LeftFrontUpLeg", -0.02, 0.01),
        ("LeftFrontLeg", 0.009, 0.018),
        ("LeftFrontFoot", 0.099, 0.015),
        ("LeftFrontToes", 0.138, 0.009),
    ]),
    paw(BACK_PAW, PAW_SIZE, WHITE, BACK_TOES),
    toe(BACK_PAW, PAW_SIZE, 0, WHITE, BACK_TOES),
    toe(BACK_PAW, PAW_SIZE, 1, WHITE, BACK_TOES),
    toe(BACK_PAW, PAW_SIZE, 2, WHITE, BACK_TOES),
    toe(BACK_PAW, PAW_SIZE, 3, WHITE, BACK_TOES),
    paw(FRONT_PAW, PAW_SIZE, WHITE, FRONT_TOES),
    toe(FRONT_PAW, PAW_SIZE, 0, WHITE, FRONT_TOES),
    toe(FRONT_PAW, PAW_SIZE, 1, WHITE, FRONT_TOES),
    toe(FRONT_PAW, PAW_SIZE, 2, WHITE, FRONT_TOES),
    toe(FRONT_PAW, PAW_SIZE, 3, WHITE, FRONT_TOES),
    // Tail.
    Part::loft(
        [0.0, 0.242, -0.196],
        &[
            [0.00, 0.0, 0.0180, 0.0180, 0.0180],
            [0.05, 0.0, 0.0145, 0.0145, 0.0145],
            [0.15, 0.0, 0.0128, 0.0128, 0.0128],
            [0.24, 0.0, 0.0120, 0.0120, 0.0120],
            [0.28, 0.0, 0.0100, 0.0100, 0.0100],
        ],
        [0.02, 0.018],
    )
    .along(TAIL, [0.0, 0.8192, -0.5736])
    .blend(0.026, 0.0080)
    .on(&[
        ("Hips", -0.03, 0.01),
        ("Tail", 0.004, 0.018),
        ("Tail1", 0.061, 0.028),
        ("Tail2", 0.119, 0.028),
        ("Tail3", 0.177, 0.028),
        ("Tail4", 0.235, 0.028),
    ]),
    SKULL,
    // Cheeks.
    Part::ball([0.026, 0.312, 0.150], [0.020, 0.018, 0.018]).on(HEAD).blend(0.018, 0.0075),
    // Muzzle: bridge of the nose, the two pads of the whiskers, chin.
    Part::ball([0.0, 0.320, 0.172], [0.0095, 0.016, 0.010]).on(HEAD).blend(0.016, 0.0045),
    Part::ball([0.0085, 0.3085, 0.1790], [0.0115, 0.0110, 0.0090]).on(HEAD).blend(0.010, 0.0042),
    Part::ball([0.0, 0.3000, 0.1740], [0.0090, 0.0110, 0.0070]).on(HEAD).blend(0.010, 0.0045),
    // Eye socket, then the lid over it.
    Part::ball([0.0191, 0.3272, 0.1700], [0.0098; 3]).on(HEAD).role(Role::Carve).blend(0.005, 0.0042),
    Part::ball([0.0186, 0.3372, 0.1656], [0.0118, 0.0104, 0.0054]).on(HEAD).blend(0.004, 0.0038),
    EAR,
    // Hollow of the ear.
    Part {
        start: [0.0290, 0.350, 0.1510],
        role: Role::Carve,
        sections: &[[0.002, 0.0, 0.0130, 0.009, 0.0090], [0.030, 0.0, 0.0040, 0.005, 0.0070]],
        caps: [0.006, 0.006],
        blend: 0.004,
        edge: 0.0034,
        ..EAR
    },
    // White: bib and belly, muzzle, paws.
    paint([0.0, 0.205, 0.118], [0.024, 0.062, 0.050], WHITE, 0.012),
    paint([0.0, 0.160, 0.000], [0.026, 0.032, 0.130], WHITE, 0.014),
    paint([0.0, 0.300, 0.186], [0.024, 0.016, 0.024], WHITE, 0.006),
    paint([0.0, 0.325, 0.184], [0.0045, 0.030, 0.020], WHITE, 0.006),
    paint([0.034, 0.010, 0.072], [0.032, 0.034, 0.050], WHITE, 0.012),
    paint([0.038, 0.010, -0.160], [0.032, 0.034, 0.050], WHITE, 0.012),
    paint([0.0310, 0.364, 0.1500], [0.0085, 0.019, 0.010], PINK, 0.004),
    // Line from nose to mouth.
    paint([0.0, 0.3085, 0.1890], [0.0012, 0.0075, 0.010], [0.10, 0.06, 0.06], 0.0022),
    // Nose.
    Part::ball([0.0, 0.3155, 0.1895], [0.0050, 0.0036, 0.0036]).on(HEAD).blend(0.03, 0.0022).shell(2).coloured(PINK),
    EYE[0],
    EYE[1],
    EYE[2],
];

const HEAD: &[(&str, f64, f64)] = &[("Head", 0.0, 0.01)];
const BACK_TOES: &[(&str, f64, f64)] = &[("LeftBackFoot", -0.02, 0.01), ("LeftBackToes", 0.004, 0.008)];
const FRONT_TOES: &[(&str, f64, f64)] = &[("LeftFrontFoot", -0.02, 0.01), ("LeftFrontToes", 0.004, 0.008)];
const BACK_PAW: [f64; 3] = [0.038, 0.0, -0.172];
const FRONT_PAW: [f64; 3] = [0.034, 0.0, 0.060];
const PAW_SIZE: [f64; 3] = [0.034, 0.024, 0.046];

const TRUNK: Part = Part::loft(
    [0.0, 0.228, -0.180],
    &[
        [0.00, 0.006, 0.034, 0.028, 0.036],
        [0.045, 0.002, 0.042, 0.036, 0.044],
        [0.10, 0.004, 0.044, 0.034, 0.046],
        [0.16, 0.002, 0.047, 0.034, 0.052],
        [0.215, -0.002, 0.047, 0.038, 0.056],
        [0.26, -0.002, 0.043, 0.039, 0.053],
        [0.295, 0.000, 0.034, 0.034, 0.042],
    ],
    [0.030, 0.030],
)
.along(FORWARD, UP)
.exponent(2.1)
.blend(0.03, 0.012)
.on(&[
    ("Hips", 0.0, 0.01),
    ("Spine", 0.095, 0.034),
    ("Spine1", 0.155, 0.034),
    ("Spine2", 0.210, 0.034),
    ("Neck", 0.278, 0.026),
]);

const NECK: Part = Part::loft(
    [0.0, 0.232, 0.068],
    &[
        [0.00, 0.0, 0.036, 0.038, 0.038],
        [0.045, 0.0, 0.036, 0.036, 0.034],
        [0.085, 0.0, 0.034, 0.032, 0.031],
        [0.11, 0.0, 0.032, 0.030, 0.029],
    ],
    [0.03, 0.02],
)
.along([0.0, 0.085, 0.064], FORWARD)
.blend(0.035, 0.0105)
.on(&[("Spine2", 0.0, 0.01), ("Neck", 0.028, 0.026), ("Neck1", 0.062, 0.022), ("Head", 0.095, 0.018)]);

const SKULL: Part = Part::loft(
    [0.0, 0.325, 0.118],
    &[[0.000, 0.0, 0.034, 0.032, 0.030], [0.020, 0.0, 0.039, 0.034, 0.030], [0.042, -0.002, 0.034, 0.028, 0.026]],
    [0.030, 0.022],
)
.along([0.0, -0.10, 1.0], UP)
.exponent(2.1)
.blend(0.022, 0.0064)
.on(&[("Neck1", -0.1, 0.01), ("Head", 0.0, 0.02)]);

const EAR: Part = Part::loft(
    [0.0245, 0.346, 0.138],
    &[[0.000, 0.0, 0.0205, 0.0110, 0.0080], [0.014, 0.0, 0.0170, 0.0085, 0.0065], [0.028, 0.0, 0.0105, 0.0062, 0.0048]],
    [0.012, 0.016],
)
.along([0.28, 1.0, 0.05], [0.40, 0.0, 1.0])
.blend(0.010, 0.0034)
.on(&[("Head", 0.0, 0.01), ("LeftEar", 0.006, 0.010)]);
