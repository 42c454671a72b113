//! The mannequin: an androgynous shop-window figure of 1.76 m in an A-pose, arms 42° below the horizontal.
//! Feet on y = 0, facing +Z. Proportions of an eight-head fashion figure; lengths in metres.

use super::figure::{Figure, JointRow, PART, Part};

const UP: [f64; 3] = [0.0, 1.0, 0.0];
/// Along the left arm: cos 42°, -sin 42°.
const ARM: [f64; 3] = [0.7431, -0.6691, 0.0];

/// The table of the mannequin.
pub const MANNEQUIN: Figure = Figure { joints: JOINTS, parts: PARTS, cell: 0.006, colour: [0.80, 0.70, 0.60] };

const JOINTS: &[JointRow] = &[
    ("Hips", "", [0.0, 0.965, -0.005]),
    ("Spine", "Hips", [0.0, 1.050, -0.010]),
    ("Spine1", "Spine", [0.0, 1.160, -0.012]),
    ("Spine2", "Spine1", [0.0, 1.275, -0.018]),
    ("Neck", "Spine2", [0.0, 1.462, -0.028]),
    ("Head", "Neck", [0.0, 1.555, -0.005]),
    ("LeftShoulder", "Spine2", [0.030, 1.410, -0.020]),
    ("LeftArm", "LeftShoulder", [0.165, 1.386, -0.022]),
    ("LeftForeArm", "LeftArm", [0.3746, 1.1973, -0.022]),
    ("LeftHand", "LeftForeArm", [0.5640, 1.0267, -0.022]),
    ("LeftUpLeg", "Hips", [0.088, 0.915, -0.005]),
    ("LeftLeg", "LeftUpLeg", [0.093, 0.500, 0.002]),
    ("LeftFoot", "LeftLeg", [0.096, 0.085, -0.022]),
    ("LeftToeBase", "LeftFoot", [0.106, 0.020, 0.105]),
];

const PARTS: &[Part] = &[
    // Trunk, from the hips to the collar bones.
    Part {
        start: [0.0, 0.86, -0.008],
        sections: &[
            [0.070, 0.000, 0.160, 0.092, 0.098],
            [0.130, 0.000, 0.154, 0.092, 0.096],
            [0.200, 0.002, 0.130, 0.087, 0.080],
            [0.265, 0.001, 0.1185, 0.083, 0.075],
            [0.340, -0.002, 0.130, 0.090, 0.086],
            [0.430, -0.008, 0.149, 0.098, 0.096],
            [0.505, -0.014, 0.148, 0.090, 0.090],
            [0.555, -0.020, 0.112, 0.064, 0.072],
            [0.590, -0.022, 0.074, 0.048, 0.054],
        ],
        caps: [0.120, 0.030],
        exponent: 2.2,
        edge: 0.022,
        joints: &[
            ("Hips", 0.0, 0.01),
            ("Spine", 0.19, 0.07),
            ("Spine1", 0.30, 0.07),
            ("Spine2", 0.415, 0.07),
            ("Neck", 0.605, 0.04),
        ],
        ..PART
    },
    // Breast.
    Part {
        start: [0.064, 1.308, 0.044],
        along: [0.45, -0.30, 0.06],
        sections: &[[-0.012, 0.0, 0.058, 0.036, 0.030], [0.012, 0.0, 0.058, 0.038, 0.030]],
        caps: [0.056, 0.052],
        blend: 0.065,
        edge: 0.020,
        joints: &[("Spine2", 0.0, 0.01), ("LeftShoulder", 0.2, 0.01)],
        ..PART
    },
    // Seat.
    Part {
        start: [0.073, 0.945, -0.058],
        along: [0.0, -1.0, 0.10],
        sections: &[[-0.010, 0.0, 0.070, 0.050, 0.056], [0.020, 0.0, 0.072, 0.050, 0.058]],
        caps: [0.080, 0.064],
        blend: 0.05,
        edge: 0.022,
        joints: &[("Hips", 0.0, 0.01), ("LeftUpLeg", 0.055, 0.085)],
        ..PART
    },
    // Neck.
    Part {
        start: [0.0, 1.40, -0.040],
        along: [0.0, 0.180, 0.038],
        sections: &[
            [0.00, 0.0, 0.066, 0.056, 0.060],
            [0.06, 0.0, 0.054, 0.051, 0.053],
            [0.11, 0.0, 0.0455, 0.045, 0.049],
            [0.20, 0.0, 0.047, 0.046, 0.052],
        ],
        caps: [0.03, 0.02],
        blend: 0.06,
        edge: 0.016,
        joints: &[("Spine2", 0.0, 0.01), ("Neck", 0.055, 0.045), ("Head", 0.150, 0.035)],
        ..PART
    },
    // Head: an egg.
    Part {
        start: [0.0, 1.530, 0.008],
        sections: &[[0.118, -0.002, 0.0742, 0.0920, 0.1015], [0.144, -0.005, 0.0748, 0.0940, 0.1035]],
        caps: [0.124, 0.090],
        exponent: 2.1,
        blend: 0.026,
        edge: 0.013,
        joints: &[("Neck", 0.0, 0.01), ("Head", 0.0, 0.01)],
        ..PART
    },
    // Chin.
    Part {
        start: [0.0, 1.556, 0.050],
        along: [0.0, -0.4, 1.0],
        front: UP,
        sections: &[[-0.012, 0.0, 0.028, 0.026, 0.024], [0.004, 0.0, 0.026, 0.026, 0.024]],
        caps: [0.03, 0.026],
        blend: 0.06,
        edge: 0.013,
        joints: &[("Head", 0.0, 0.01)],
        ..PART
    },
    // Ridge of the nose: gives the face a direction, no more.
    Part {
        start: [0.0, 1.672, 0.088],
        along: [0.0, -0.056, 0.010],
        sections: &[
            [0.0, 0.0, 0.006, 0.006, 0.012],
            [0.028, 0.0, 0.007, 0.009, 0.012],
            [0.046, 0.0, 0.008, 0.0105, 0.012],
        ],
        caps: [0.030, 0.009],
        blend: 0.032,
        edge: 0.009,
        joints: &[("Head", 0.0, 0.01)],
        ..PART
    },
    // Collar bone and trapezius.
    Part {
        start: [0.020, 1.468, -0.042],
        along: [0.150, -0.072, 0.016],
        sections: &[
            [0.0, 0.0, 0.026, 0.032, 0.036],
            [0.07, 0.0, 0.034, 0.042, 0.044],
            [0.15, 0.0, 0.044, 0.050, 0.050],
        ],
        caps: [0.03, 0.03],
        blend: 0.06,
        edge: 0.020,
        joints: &[("Spine2", 0.0, 0.01), ("LeftShoulder", 0.055, 0.050), ("LeftArm", 0.165, 0.045)],
        ..PART
    },
    // Arm, shoulder to wrist.
    Part {
        start: [0.165, 1.386, -0.022],
        along: ARM,
        sections: &[
            [0.000, 0.000, 0.049, 0.053, 0.052],
            [0.060, 0.000, 0.0485, 0.053, 0.051],
            [0.120, 0.002, 0.0430, 0.048, 0.045],
            [0.200, 0.002, 0.0390, 0.043, 0.041],
            [0.280, 0.000, 0.0355, 0.036, 0.038],
            [0.340, 0.001, 0.0370, 0.040, 0.036],
            [0.430, 0.002, 0.0300, 0.033, 0.030],
            [0.520, 0.002, 0.0210, 0.027, 0.025],
            [0.560, 0.002, 0.0195, 0.027, 0.025],
        ],
        caps: [0.054, 0.02],
        blend: 0.045,
        edge: 0.019,
        joints: &[
            ("LeftShoulder", -0.05, 0.02),
            ("LeftArm", 0.010, 0.065),
            ("LeftForeArm", 0.282, 0.048),
            ("LeftHand", 0.538, 0.035),
        ],
        ..PART
    },
    // Palm; thin across, thumb in front.
    Part {
        start: [0.5640, 1.0267, -0.022],
        along: ARM,
        sections: &[
            [-0.010, 0.002, 0.0190, 0.026, 0.024],
            [0.030, 0.003, 0.0165, 0.033, 0.032],
            [0.070, 0.003, 0.0135, 0.0370, 0.0370],
        ],
        caps: [0.02, 0.020],
        exponent: 2.5,
        edge: 0.011,
        joints: &[("LeftForeArm", -0.05, 0.01), ("LeftHand", 0.0, 0.035)],
        ..PART
    },
    finger(0.0065, 1.00, INDEX),
    finger(-0.0115, 1.01, MIDDLE),
    finger(-0.0295, 1.00, INDEX),
    finger(-0.0470, 0.96, LITTLE),
    // Thumb.
    Part {
        start: [0.5775, 1.0110, 0.004],
        along: [0.060, -0.060, 0.050],
        sections: &[
            [0.0, 0.0, 0.015, 0.016, 0.016],
            [0.04, 0.0, 0.0125, 0.0125, 0.0125],
            [0.080, 0.0, 0.0088, 0.0092, 0.0092],
        ],
        caps: [0.015, 0.010],
        blend: 0.024,
        edge: 0.009,
        joints: &[("LeftHand", 0.0, 0.01)],
        ..PART
    },
    // Leg, hip to ankle.
    Part {
        start: [0.088, 0.950, -0.005],
        along: [0.008, -0.870, -0.017],
        sections: &[
            [0.04, 0.000, 0.076, 0.082, 0.088],
            [0.10, 0.000, 0.079, 0.086, 0.092],
            [0.19, 0.002, 0.0755, 0.085, 0.084],
            [0.30, 0.006, 0.0645, 0.073, 0.067],
            [0.40, 0.008, 0.0535, 0.057, 0.055],
            [0.450, 0.009, 0.0490, 0.052, 0.049],
            [0.510, 0.005, 0.0480, 0.046, 0.053],
            [0.590, -0.002, 0.0510, 0.042, 0.062],
            [0.690, 0.000, 0.0410, 0.036, 0.052],
            [0.790, 0.000, 0.0300, 0.030, 0.036],
            [0.865, 0.000, 0.0295, 0.034, 0.035],
        ],
        caps: [0.08, 0.03],
        exponent: 2.05,
        blend: 0.045,
        edge: 0.022,
        joints: &[
            ("Hips", -0.02, 0.02),
            ("LeftUpLeg", 0.050, 0.085),
            ("LeftLeg", 0.450, 0.062),
            ("LeftFoot", 0.862, 0.040),
        ],
        ..PART
    },
    // Foot, heel to toes: its front axis points up, and centre = back keeps the sole on the ground.
    Part {
        start: [0.0965, 0.0, -0.058],
        along: [0.022, 0.0, 0.230],
        front: UP,
        sections: &[
            [0.00, 0.032, 0.0290, 0.040, 0.032],
            [0.05, 0.032, 0.0310, 0.052, 0.032],
            [0.10, 0.028, 0.0350, 0.046, 0.028],
            [0.155, 0.022, 0.0420, 0.027, 0.022],
            [0.195, 0.020, 0.0420, 0.017, 0.020],
        ],
        caps: [0.028, 0.042],
        exponent: 2.4,
        blend: 0.035,
        edge: 0.013,
        joints: &[("LeftFoot", 0.0, 0.01), ("LeftToeBase", 0.163, 0.022)],
        ..PART
    },
];

const INDEX: &[[f64; 5]] =
    &[[0.0, 0.0, 0.0108, 0.0108, 0.0108], [0.050, 0.0, 0.0096, 0.0102, 0.0102], [0.097, 0.0, 0.0076, 0.0092, 0.0092]];
const MIDDLE: &[[f64; 5]] =
    &[[0.0, 0.0, 0.0108, 0.0108, 0.0108], [0.055, 0.0, 0.0096, 0.0102, 0.0102], [0.107, 0.0, 0.0076, 0.0092, 0.0092]];
const LITTLE: &[[f64; 5]] =
    &[[0.0, 0.0, 0.0098, 0.0104, 0.0104], [0.040, 0.0, 0.0088, 0.0096, 0.0096], [0.076, 0.0, 0.0070, 0.0084, 0.0084]];

/// A finger whose knuckle lies at depth `z`, a share `knuckle` of the way along the palm.
/// The four touch, as on a shop-window figure: sleeves slide over them and the grid need not resolve gaps.
const fn finger(z: f64, knuckle: f64, sections: &'static [[f64; 5]]) -> Part {
    Part {
        start: [0.5640 + 0.0446 * knuckle, 1.0267 - 0.0401 * knuckle, z],
        along: ARM,
        sections,
        caps: [0.01, 0.010],
        blend: 0.009,
        edge: 0.0085,
        joints: &[("LeftHand", 0.0, 0.01)],
        ..PART
    }
}
