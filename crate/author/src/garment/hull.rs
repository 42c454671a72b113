//! The body's outer skin as closed even meshes, one for each part that stands apart, a voxel away from it: what is left of shells, holes
//! and inner parts when the body is only touched from outside. The garment's own field, without openings.

use super::field::Field;
use super::pattern::Pattern;
use super::solid::Solid;
use super::{cut, remesh, split_body};
use crate::rig::{Character, Mesh};
use crate::{Error, Result};
use glam::DVec3;

/// Vertices of a skin fine enough to simulate against, about.
pub const SKIN: usize = 7000;

/// The outer skin of the character's body in its canonical pose, every part of it, of about so many vertices, and its distance from the body, metres.
pub fn hull(character: &Character, vertices: usize) -> Result<(Mesh, f64)> {
    let positions = &character.body.positions;
    let low = positions.iter().fold(DVec3::INFINITY, |low, p| low.min(*p));
    let high = positions.iter().fold(DVec3::NEG_INFINITY, |high, p| high.max(*p));
    let cell = super::cell(low, high);
    let (triangles, covered) = split_body(character, &[], (high - low).max_element() / 60.0, 0.0);
    let solid = Solid {
        triangles: &triangles,
        covered: &covered,
        falling: None,
        pattern: &Pattern::default(),
        room: 0.0,
        looseness: cell,
        smoothing: cell,
    };
    let field = Field::new(&solid, cell);
    let piece = remesh::remesh(cut::extract_parts(&field), &field, &[], vertices);
    match piece.mesh.triangles.is_empty() {
        true => Err(Error::Character("the body encloses nothing a garment could touch".into())),
        false => Ok((piece.mesh, cell)),
    }
}
