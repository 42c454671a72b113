//! A figure as a table: joints by name and place, body parts as rows of sections. A second character is a second table.
//! Only the middle and the left side are written; joints named `Left…` and parts off the middle are mirrored.

use super::loft::{Loft, Role, Section};
use ctsn_rig::Joint;
use glam::{DAffine3, DVec3};

/// One joint: name, name of its parent (empty for the root), place in the canonical pose in metres.
pub type JointRow = (&'static str, &'static str, [f64; 3]);

/// One body part, a [`Loft`] as a row of a table; lengths in metres.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Where its chord starts.
    pub start: [f64; 3],
    /// Where its chord points.
    pub along: [f64; 3],
    /// Where its front axis points.
    pub front: [f64; 3],
    /// Sections: distance along the chord, centre, half width, half depth in front, half depth behind.
    pub sections: &'static [[f64; 5]],
    /// Factors on sections and caps: side, front, along. With [`BALL`] they are the half-axes of an ellipsoid.
    pub size: [f64; 3],
    /// Cap lengths at the start and the end.
    pub caps: [f64; 2],
    /// Superellipse exponent of the sections.
    pub exponent: f64,
    /// What it does to the rows before it in its shell.
    pub role: Role,
    /// Radius of the smooth union with the rows before it, above 0 where they, or its mirror image, are near. For
    /// paint: width of the soft border, 0 for a crisp one.
    pub blend: f64,
    /// Which closed mesh it belongs to: 0 is the body; eyes, teeth, horns or hair have a number of their own.
    pub shell: usize,
    /// Linear RGB; `None` is the figure's colour.
    pub colour: Option<[f32; 3]>,
    /// Wanted edge length of the mesh.
    pub edge: f64,
    /// Joints it follows: name, where along the chord the influence begins, half width of the transition.
    pub joints: &'static [(&'static str, f64, f64)],
}

/// Sections of the unit ball; its ends are `caps: [0.99; 2]`.
pub const BALL: &[[f64; 5]] = &[[-0.01, 0.0, 1.0, 1.0, 1.0], [0.01, 0.0, 1.0, 1.0, 1.0]];

/// Sections of a box a metre wide and deep, for crisp paint: scale it, and start its chord where the paint starts.
pub const BOX: &[[f64; 5]] = &[[0.0, 0.0, 0.5, 0.5, 0.5], [1.0, 0.0, 0.5, 0.5, 0.5]];

/// Defaults of a row: an upright ellipsoid of the body, facing +Z.
pub const PART: Part = Part {
    start: [0.0; 3],
    along: [0.0, 1.0, 0.0],
    front: [0.0, 0.0, 1.0],
    sections: BALL,
    size: [1.0; 3],
    caps: [0.99; 2],
    exponent: 2.0,
    role: Role::Join,
    blend: 0.03,
    shell: 0,
    colour: None,
    edge: 0.02,
    joints: &[],
};

impl Part {
    /// An ellipsoid at `centre` with half-axes along x, z and y, metres: turn it with [`Part::along`].
    pub const fn ball(centre: [f64; 3], half_axes: [f64; 3]) -> Part {
        Part { start: centre, size: half_axes, ..PART }
    }

    /// A loft from `start` through `sections`.
    pub const fn loft(start: [f64; 3], sections: &'static [[f64; 5]], caps: [f64; 2]) -> Part {
        Part { start, sections, caps, ..PART }
    }

    /// Crisp paint on all between two heights and within `half_width` of the plane x = 0, metres.
    pub const fn belt([low, high]: [f64; 2], half_width: f64, colour: [f32; 3]) -> Part {
        let size = [2.0 * half_width, 2.0 * half_width, high - low];
        let belt = Part::loft([0.0, low, 0.0], BOX, [1e-4; 2]).size(size).role(Role::Paint);
        belt.exponent(8.0).coloured(colour).blend(0.0, 0.02)
    }

    /// The same with other directions of chord and front axis.
    pub const fn along(self, along: [f64; 3], front: [f64; 3]) -> Part {
        Part { along, front, ..self }
    }

    /// The same with factors on side, front and length.
    pub const fn size(self, size: [f64; 3]) -> Part {
        Part { size, ..self }
    }

    /// The same with another radius of the smooth union, and edge length.
    pub const fn blend(self, blend: f64, edge: f64) -> Part {
        Part { blend, edge, ..self }
    }

    /// The same with another superellipse exponent.
    pub const fn exponent(self, exponent: f64) -> Part {
        Part { exponent, ..self }
    }

    /// The same, following these joints.
    pub const fn on(self, joints: &'static [(&'static str, f64, f64)]) -> Part {
        Part { joints, ..self }
    }

    /// The same in a colour of its own.
    pub const fn coloured(self, colour: [f32; 3]) -> Part {
        Part { colour: Some(colour), ..self }
    }

    /// The same with another role.
    pub const fn role(self, role: Role) -> Part {
        Part { role, ..self }
    }

    /// The same in another shell.
    pub const fn shell(self, shell: usize) -> Part {
        Part { shell, ..self }
    }
}

/// A character's shape and skeleton.
#[derive(Clone, Copy, Debug)]
pub struct Figure {
    /// Joints, parents first; those named `Left…` stand for both sides.
    pub joints: &'static [JointRow],
    /// Body parts; those that start off the plane x = 0 stand for both sides.
    pub parts: &'static [Part],
    /// Grid spacing that resolves its thinnest gap, metres.
    pub cell: f64,
    /// Linear RGB base colour.
    pub colour: [f32; 3],
}

impl Figure {
    /// Joints of both sides, axes parallel to the world's in the canonical pose.
    pub fn skeleton(&self) -> Vec<Joint> {
        let mut rows: Vec<(String, String, DVec3)> = vec![];
        for side in ["Left", "Right"] {
            for &(name, parent, place) in self.joints {
                let place = DVec3::from_array(place);
                if name.starts_with("Left") {
                    let x = if side == "Left" { place.x } else { -place.x };
                    rows.push((name.replace("Left", side), parent.replace("Left", side), place.with_x(x)));
                } else if side == "Left" {
                    rows.push((name.into(), parent.into(), place));
                }
            }
        }
        let parent = |wanted: &str| rows.iter().position(|(name, ..)| name == wanted);
        let joint = |(name, above, place): &(String, String, DVec3)| Joint {
            name: name.clone(),
            parent: parent(above),
            inverse_bind: DAffine3::from_translation(-*place),
        };
        rows.iter().map(joint).collect()
    }

    /// Lofts of both sides over the joints of [`Figure::skeleton`]. Parts that name no known joint follow none.
    pub fn lofts(&self, joints: &[Joint]) -> Vec<Loft> {
        let index = |wanted: &str| joints.iter().position(|joint| joint.name == wanted);
        let other = |joint: usize| index(&joints[joint].name.replace("Left", "Right")).unwrap_or(joint);
        let mut lofts = vec![];
        for part in self.parts {
            let [wide, deep, long] = part.size;
            let section = |&[at, centre, side, front, back]: &[f64; 5]| Section {
                at: at * long,
                centre: centre * deep,
                side: side * wide,
                front: front * deep,
                back: back * deep,
            };
            let caps = part.caps.map(|cap| cap * long);
            let [start, along, front] = [part.start, part.along, part.front].map(DVec3::from_array);
            let mut loft = Loft::new(start, along, front, part.sections.iter().map(section).collect(), caps);
            loft.joints = part.joints.iter().filter_map(|&(name, at, half)| Some((index(name)?, at, half))).collect();
            (loft.exponent, loft.blend, loft.edge) = (part.exponent, part.blend, part.edge);
            (loft.role, loft.shell, loft.colour) = (part.role, part.shell, part.colour.unwrap_or(self.colour));
            lofts.push(loft.clone());
            if part.start[0] != 0.0 {
                lofts.push(loft.mirrored(other));
            }
        }
        lofts
    }
}
