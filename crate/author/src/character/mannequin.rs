//! The mannequin: an androgynous shop-window figure of 1.76 m in an A-pose, arms 42° below the horizontal.
//! Feet on y = 0, facing +Z. Proportions of an eight-head fashion figure; lengths in metres.

use super::figure::{Figure, JointRow, Part};

const UP: [f64; 3] = [0.0, 1.0, 0.0];
const FRONT: [f64; 3] = [0.0, 0.0, 1.0];
/// Along the left arm: cos 42°, -sin 42°.
const ARM: [f64; 3] = [0.7431, -0.6691, 0.0];

/// The table of the mannequin.
pub const MANNEQUIN: Figure = Figure { joints: JOINTS, parts: PARTS, cell: 0.0055, colour: [0.80, 0.70, 0.60] };

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
        along: UP,
        front: FRONT,
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
        blend: 0.03,
        edge: 0.022,
        joints: &[("Hips", 0.0, 0.01), ("Spine", 0.19, 0.07), ("Spine1", 0.30, 0.07), ("Spine2", 0.415, 0.07), ("Neck", 0.605, 0.04)],
    },
    // Breast.
    Part {
        start: [0.066, 1.305, 0.052],
        along: [0.35, -0.20, 0.25],
        front: FRONT,
        sections: &[[-0.010, 0.0, 0.052, 0.030, 0.030], [0.010, 0.0, 0.054, 0.032, 0.030]],
        caps: [0.055, 0.040],
        exponent: 2.0,
        blend: 0.055,
        edge: 0.020,
        joints: &[("Spine2", 0.0, 0.01), ("LeftShoulder", 0.2, 0.01)],
    },
    // Seat.
    Part {
        start: [0.073, 0.945, -0.058],
        along: [0.0, -1.0, 0.10],
        front: FRONT,
        sections: &[[-0.010, 0.0, 0.070, 0.050, 0.056], [0.020, 0.0, 0.072, 0.050, 0.058]],
        caps: [0.080, 0.064],
        exponent: 2.0,
        blend: 0.05,
        edge: 0.022,
        joints: &[("Hips", 0.0, 0.01), ("LeftUpLeg", 0.055, 0.085)],
    },
    // Neck.
    Part {
        start: [0.0, 1.40, -0.040],
        along: [0.0, 0.180, 0.038],
        front: FRONT,
        sections: &[
            [0.00, 0.0, 0.066, 0.056, 0.060],
            [0.06, 0.0, 0.054, 0.051, 0.053],
            [0.11, 0.0, 0.0475, 0.047, 0.050],
            [0.20, 0.0, 0.049, 0.048, 0.052],
        ],
        caps: [0.03, 0.02],
        exponent: 2.0,
        blend: 0.06,
        edge: 0.016,
        joints: &[("Spine2", 0.0, 0.01), ("Neck", 0.055, 0.045), ("Head", 0.150, 0.035)],
    },
    // Head: an egg, chin forward.
    Part {
        start: [0.0, 1.530, 0.008],
        along: UP,
        front: FRONT,
        sections: &[
            [0.022, 0.024, 0.037, 0.058, 0.050],
            [0.055, 0.014, 0.055, 0.078, 0.074],
            [0.095, 0.002, 0.0680, 0.091, 0.094],
            [0.142, -0.006, 0.0745, 0.095, 0.104],
        ],
        caps: [0.024, 0.092],
        exponent: 2.1,
        blend: 0.018,
        edge: 0.013,
        joints: &[("Neck", 0.0, 0.01), ("Head", 0.0, 0.01)],
    },
    // Ridge of the nose: gives the face a direction, no more.
    Part {
        start: [0.0, 1.672, 0.088],
        along: [0.0, -0.056, 0.010],
        front: FRONT,
        sections: &[[0.0, 0.0, 0.006, 0.006, 0.012], [0.028, 0.0, 0.007, 0.010, 0.012], [0.046, 0.0, 0.0085, 0.012, 0.012]],
        caps: [0.030, 0.009],
        exponent: 2.0,
        blend: 0.032,
        edge: 0.009,
        joints: &[("Head", 0.0, 0.01)],
    },
    // Collar bone and trapezius.
    Part {
        start: [0.020, 1.468, -0.042],
        along: [0.150, -0.072, 0.016],
        front: FRONT,
        sections: &[[0.0, 0.0, 0.026, 0.032, 0.036], [0.07, 0.0, 0.034, 0.042, 0.044], [0.15, 0.0, 0.044, 0.050, 0.050]],
        caps: [0.03, 0.03],
        exponent: 2.0,
        blend: 0.06,
        edge: 0.020,
        joints: &[("Spine2", 0.0, 0.01), ("LeftShoulder", 0.055, 0.050), ("LeftArm", 0.165, 0.045)],
    },
    // Arm, shoulder to wrist.
    Part {
        start: [0.165, 1.386, -0.022],
        along: ARM,
        front: FRONT,
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
        exponent: 2.0,
        blend: 0.045,
        edge: 0.019,
        joints: &[("LeftShoulder", -0.05, 0.02), ("LeftArm", 0.010, 0.065), ("LeftForeArm", 0.282, 0.048), ("LeftHand", 0.538, 0.035)],
    },
    // Palm; thin across, thumb in front.
    Part {
        start: [0.5640, 1.0267, -0.022],
        along: ARM,
        front: FRONT,
        sections: &[
            [-0.010, 0.002, 0.0190, 0.026, 0.024],
            [0.030, 0.003, 0.0165, 0.033, 0.032],
            [0.070, 0.003, 0.0135, 0.0370, 0.0370],
        ],
        caps: [0.02, 0.020],
        exponent: 2.5,
        blend: 0.03,
        edge: 0.011,
        joints: &[("LeftForeArm", -0.05, 0.01), ("LeftHand", 0.0, 0.035)],
    },
    finger(0.0085, 0.99, 0.094),
    finger(-0.0100, 1.0, 0.104),
    finger(-0.0285, 1.0, 0.096),
    finger(-0.0465, 0.92, 0.075),
    // Thumb.
    Part {
        start: [0.5775, 1.0110, 0.004],
        along: [0.066, -0.066, 0.032],
        front: FRONT,
        sections: &[[0.0, 0.0, 0.015, 0.016, 0.016], [0.04, 0.0, 0.0125, 0.0125, 0.0125], [0.080, 0.0, 0.0088, 0.0092, 0.0092]],
        caps: [0.015, 0.010],
        exponent: 2.0,
        blend: 0.016,
        edge: 0.009,
        joints: &[("LeftHand", 0.0, 0.01)],
    },
    // Leg, hip to ankle.
    Part {
        start: [0.088, 0.950, -0.005],
        along: [0.008, -0.870, -0.017],
        front: FRONT,
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
        joints: &[("Hips", -0.02, 0.02), ("LeftUpLeg", 0.050, 0.085), ("LeftLeg", 0.450, 0.062), ("LeftFoot", 0.862, 0.040)],
    },
    // Foot, heel to toes; the sections' front is up, and centre - back = 0 at the ground.
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
    },
];

/// A finger whose knuckle lies at depth `z`, `length` metres from the knuckle to the start of its tip.
/// The four touch, as on a shop-window figure: sleeves slide over them and the grid need not resolve gaps.
const fn finger(z: f64, scale: f64, length: f64) -> Part {
    let sections: &'static [[f64; 5]] = if length > 0.1 {
        &[[0.0, 0.0, 0.0105, 0.0105, 0.0105], [0.055, 0.0, 0.0095, 0.0100, 0.0100], [0.104, 0.0, 0.0072, 0.0080, 0.0080]]
    } else if length > 0.08 {
        &[[0.0, 0.0, 0.0105, 0.0105, 0.0105], [0.050, 0.0, 0.0095, 0.0100, 0.0100], [0.095, 0.0, 0.0072, 0.0080, 0.0080]]
    } else {
        &[[0.0, 0.0, 0.0098, 0.0098, 0.0098], [0.040, 0.0, 0.0088, 0.0094, 0.0094], [0.075, 0.0, 0.0064, 0.0072, 0.0072]]
    };
    Part {
        start: [0.5640 + 0.0446 * scale, 1.0267 - 0.0401 * scale, z],
        along: [0.7431, -0.6691, -0.04 * (z + 0.02) / 0.03],
        front: FRONT,
        sections,
        caps: [0.01, 0.009],
        exponent: 2.0,
        blend: 0.007,
        edge: 0.0085,
        joints: &[("LeftHand", 0.0, 0.01)],
    }
}
