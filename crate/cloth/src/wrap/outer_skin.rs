//! The body's outer skin as closed even meshes, one for each part that stands apart, a voxel away from it: what is left
//! of shells, holes and inner parts when the body is only touched from outside. The garment's own field, without
//! openings.

use super::cut::extract_parts;
use super::field::Field;
use super::remesh::remesh;
use super::solid::{self, Solid, split};
use crate::{Error, Result};
use ctsn_rig::Mesh;
use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

/// Vertices of a skin fine enough to simulate against, about.
pub const SKIN: usize = 7000;

/// The body that was wrapped, the vertices asked for, the skin and its distance.
type Wrapped = (Mesh, usize, Mesh, f64);

/// How many skins are kept.
const KEPT: usize = 4;

/// The skins that were made last: a bake asks for the same one a dozen times, and each takes seconds.
static LAST: Mutex<VecDeque<Wrapped>> = Mutex::new(VecDeque::new());

/// The outer skin of a body, every part of it, of about so many vertices, and its distance from the body, metres.
pub fn outer_skin(body: &Mesh, vertices: usize) -> Result<(Mesh, f64)> {
    // Not locked while one is made: its threads may work on another meanwhile.
    let last = || LAST.lock().unwrap_or_else(PoisonError::into_inner);
    let same = |kept: &&Wrapped| kept.0 == *body && kept.1 == vertices;
    if let Some((_, _, skin, distance)) = last().iter().find(same) {
        return Ok((skin.clone(), *distance));
    }
    let (skin, distance) = wrap(body, vertices)?;
    let mut last = last();
    last.truncate(KEPT - 1);
    last.push_front((body.clone(), vertices, skin.clone(), distance));
    Ok((skin, distance))
}

fn wrap(body: &Mesh, vertices: usize) -> Result<(Mesh, f64)> {
    let [low, high] = body.bounds();
    let cell = solid::cell(low, high);
    let (triangles, covered) = split(body, (high - low).max_element() / 60.0, |_, _, _| true);
    let solid = Solid { triangles: &triangles, covered: &covered, room: 0.0, looseness: cell, smoothing: cell };
    let field = Field::new(&solid, cell);
    let piece = remesh(extract_parts(&field), &field, &[], vertices);
    match piece.mesh.triangles.is_empty() {
        true => Err(Error::Character("the body encloses nothing a garment could touch".into())),
        false => Ok((piece.mesh, cell)),
    }
}
