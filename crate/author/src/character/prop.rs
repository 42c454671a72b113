//! Rigid obstacles with one joint: a sphere of radius 0.3 m and a box with round edges, both centred 0.5 m over y = 0.
//! The box is a superellipsoid: its faces bulge by a few millimetres, so cloth slides off instead of catching.

use super::figure::{BALL, Figure, JointRow, PART, Part};

const JOINTS: &[JointRow] = &[("Root", "", [0.0, 0.5, 0.0])];
const ROOT: &[(&str, f64, f64)] = &[("Root", 0.0, 0.01)];
const CLAY: [f32; 3] = [0.42, 0.40, 0.37];

/// The sphere.
pub const SPHERE: Figure = Figure { joints: JOINTS, parts: &[WHOLE], cell: 0.015, colour: CLAY };

/// The box: 0.5 m wide, 0.4 m high, 0.4 m deep.
pub const BOX: Figure = Figure {
    parts: &[Part {
        sections: &[[-0.18, 0.0, 0.25, 0.2, 0.2], [0.18, 0.0, 0.25, 0.2, 0.2]],
        size: [1.0; 3],
        caps: [0.02; 2],
        exponent: 6.0,
        edge: 0.02,
        ..WHOLE
    }],
    ..SPHERE
};

const WHOLE: Part = Part { start: [0.0, 0.5, 0.0], sections: BALL, size: [0.3; 3], edge: 0.02, joints: ROOT, ..PART };
