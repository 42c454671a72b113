//! The project's own characters, built from tables: smooth union of lofts -> even mesh -> skin weights -> motion.
//! simulation.md §4.1.

mod figure;
mod loft;
mod mannequin;
mod remesh;
mod surface;
mod weights;

pub use figure::{Figure, JointRow, Part};
pub use loft::smoothstep;

use crate::motion;
use crate::rig::{Character, Mesh, Surface};
use crate::{Error, Result};
use glam::DVec3;

/// Every character this module can build, by name.
const FIGURES: &[(&str, Figure)] = &[("mannequin", mannequin::MANNEQUIN)];

/// The character of that name, with the project's clips.
pub fn character(name: &str) -> Result<Character> {
    let known: Vec<&str> = FIGURES.iter().map(|(known, _)| *known).collect();
    let found = FIGURES.iter().find(|(known, _)| *known == name);
    let (_, figure) =
        found.ok_or_else(|| Error::Character(format!("wanted one of {}, found {name:?}", known.join(", "))))?;
    let mut character = build(figure);
    character.clips = motion::clips(&character, motion::RATE)?;
    Ok(character)
}

/// A figure's body, skeleton and skin weights in the canonical pose, without motion.
pub fn build(figure: &Figure) -> Character {
    let joints = figure.skeleton();
    let lofts = figure.lofts(&joints);
    let edge = |p: DVec3| edge_length(&lofts, p);
    let body = remesh::remesh(&surface::extract(&lofts, figure.cell), &edge, &|p| loft::project(&lofts, p), 8);
    let weights = weights::weights(&body, &lofts, joints.len());
    let surface = drawn(&body, figure.colour);
    Character { joints, root: 0, body, weights, surface, clips: vec![], metres_per_unit: 1.0 }
}

/// Wanted edge length at `p`, metres: that of the lofts around it, nearer ones counting more.
fn edge_length(lofts: &[loft::Loft], p: DVec3) -> f64 {
    let share = |loft: &loft::Loft| (loft.edge, (-loft.distance(p).max(0.0) / 0.01).exp());
    let (sum, weight) = lofts
        .iter()
        .filter(|loft| loft.near(p))
        .map(share)
        .fold((0.0, 1e-12), |(s, w), (edge, k)| (s + edge * k, w + k));
    if weight > 1e-9 { sum / weight } else { 0.02 }
}

/// Every welded vertex drawn once, in one colour.
fn drawn(body: &Mesh, colour: [f32; 3]) -> Surface {
    Surface {
        vertex: (0..body.positions.len() as u32).collect(),
        uv: vec![],
        triangles: body.triangles.clone(),
        colour: vec![colour; body.triangles.len()],
    }
}

#[cfg(test)]
mod tests;
