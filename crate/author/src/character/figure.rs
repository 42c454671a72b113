//! A figure as a table: joints by name and place, body parts as rows of sections. A second character is a second table.
//! Only the middle and the left side are written; names that begin with `Left` are mirrored to `Right`.

use super::loft::{Loft, Section};
use crate::rig::Joint;
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
    /// Cap lengths at the start and the end.
    pub caps: [f64; 2],
    /// Superellipse exponent of the sections.
    pub exponent: f64,
    /// Radius of the smooth union with the rows before it.
    pub blend: f64,
    /// Wanted edge length of the mesh.
    pub edge: f64,
    /// Joints it follows: name, where along the chord the influence begins, half width of the transition.
    pub joints: &'static [(&'static str, f64, f64)],
}

/// A character's shape and skeleton.
#[derive(Clone, Copy, Debug)]
pub struct Figure {
    /// Joints, parents first; left ones stand for both sides.
    pub joints: &'static [JointRow],
    /// Body parts; those that follow a left joint stand for both sides.
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
            let section = |&[at, centre, side, front, back]: &[f64; 5]| Section { at, centre, side, front, back };
            let [start, along, front] = [part.start, part.along, part.front].map(DVec3::from_array);
            let mut loft = Loft::new(start, along, front, part.sections.iter().map(section).collect(), part.caps);
            loft.joints = part.joints.iter().filter_map(|&(name, at, half)| Some((index(name)?, at, half))).collect();
            (loft.exponent, loft.blend, loft.edge) = (part.exponent, part.blend, part.edge);
            lofts.push(loft.clone());
            if part.joints.iter().any(|(name, ..)| name.starts_with("Left")) {
                lofts.push(loft.mirrored(other));
            }
        }
        lofts
    }
}
