//! Scenes of cloth over a rigid obstacle. A sheet hangs from a rail, which is the root. Behind it stands a sphere or a
//! box with a joint of its own. The box is a superellipsoid: its faces bulge by a few millimetres, so cloth slides off
//! instead of catching.

use super::figure::{Figure, JointRow, PART, Part};

const JOINTS: &[JointRow] = &[("Root", "", [0.0, RAIL, 0.0]), ("Obstacle", "Root", CENTRE)];
/// Height of the rail, and the middle of the obstacle in the canonical pose, just behind the sheet; metres.
const RAIL: f64 = 1.3;
const CENTRE: [f64; 3] = [0.0, 0.78, -0.26];
const WOOD: [f32; 3] = [0.30, 0.17, 0.08];
const CLAY: [f32; 3] = [0.42, 0.40, 0.37];

/// A sphere of radius 0.22 m behind the sheet.
pub const SPHERE: Figure = Figure { joints: JOINTS, parts: &[BAR, BODY], cell: 0.01, colour: CLAY };

/// A box 0.4 m wide, 0.34 m high and deep.
pub const BOX: Figure = Figure {
    parts: &[
        BAR,
        Part {
            sections: &[[-0.11, 0.0, 0.2, 0.17, 0.17], [0.11, 0.0, 0.2, 0.17, 0.17]],
            size: [1.0; 3],
            // On edges as round as these, a sheet of 1,200 vertices sinks in by 3 mm between two vertices.
            caps: [0.06; 2],
            exponent: 6.0,
            ..BODY
        },
    ],
    ..SPHERE
};

/// The rail: a metre of bar along x.
const BAR: Part = Part {
    start: [0.0, RAIL, 0.0],
    along: [1.0, 0.0, 0.0],
    sections: &[[-0.49, 0.0, 0.018, 0.018, 0.018], [0.49, 0.0, 0.018, 0.018, 0.018]],
    caps: [0.01; 2],
    edge: 0.012,
    colour: Some(WOOD),
    joints: &[("Root", 0.0, 0.01)],
    ..PART
};

const BODY: Part =
    Part { start: CENTRE, size: [0.22; 3], edge: 0.014, shell: 1, joints: &[("Obstacle", 0.0, 0.01)], ..PART };
