//! Faces so thin that their shape is rounding error: a short side is closed; a corner on a long side is let into the
//! face beyond it, which mends T-junctions too.

use super::at;
use super::patch::{Face, Patch};
use crate::garment::check::SLIVER;
use ctsn_rig::mesh::triangle::least_angle;
use ctsn_rig::mesh::{Edges, around};
use std::collections::BTreeSet;

/// A side shorter than this share of the longest is closed.
const SHORT: f64 = 0.2;
pub(super) fn mend(patch: &mut Patch, said: &mut Vec<String>) {
    let mut places = Vec::new();
    // Each mend takes a face away; one may leave another sliver, which is then mended.
    for _ in 0..patch.faces.len() {
        let thin: Vec<usize> =
            (0..patch.faces.len()).filter(|&face| least_angle(patch.corners(face)) < SLIVER).collect();
        let Some(place) = thin.into_iter().find_map(|face| mend_one(patch, face)) else { break };
        places.push(place);
    }
    if !places.is_empty() {
        said.push(at("slivers closed, or let into the face beside them (faces by vertices)", places));
    }
}

/// Mends a sliver; what it was, or `None` where it cannot be.
fn mend_one(patch: &mut Patch, face: usize) -> Option<String> {
    let name = patch.name(face);
    let length = |[a, b]: [u32; 2]| patch.positions[a as usize].distance(patch.positions[b as usize]);
    let mut sides = around(patch.faces[face].corners);
    sides.sort_by(|a, b| length(*a).total_cmp(&length(*b)));
    let [short, _, long] = sides;
    let edges = Edges::new(&patch.triangles());
    if length(short) < SHORT * length(long) && collapses(patch, &edges, short) {
        let [into, gone] = [short[0].min(short[1]), short[0].max(short[1])];
        patch.pinned[into as usize] |= patch.pinned[gone as usize];
        patch.faces.iter_mut().for_each(|face| {
            face.corners = face.corners.map(|vertex| if vertex == gone { into } else { vertex });
        });
        let whole = |[a, b, c]: [u32; 3]| a != b && b != c && c != a;
        let kept: Vec<bool> = patch.faces.iter().map(|face| whole(face.corners)).collect();
        patch.retain(|face| kept[face]);
        return Some(name);
    }
    let beyond: Vec<usize> =
        edges.at(long).iter().map(|side| side.triangle).filter(|triangle| *triangle != face).collect();
    match beyond[..] {
        [] => {}
        [beyond] => let_in(patch, face, beyond, long),
        _ => return None,
    }
    patch.retain(|index| index != face);
    Some(name)
}

/// Whether an edge can be closed without faces falling together: a neighbour that both ends have in common is a corner
/// that faces the edge, or lies across a slit that is closed with it.
fn collapses(patch: &Patch, edges: &Edges, [a, b]: [u32; 2]) -> bool {
    let ring = |of: u32| -> BTreeSet<u32> {
        let beside = patch.faces.iter().filter(|face| face.corners.contains(&of));
        beside.flat_map(|face| face.corners).filter(|vertex| *vertex != of).collect()
    };
    let faces = |vertex: u32| edges.at([a, b]).iter().any(|side| side.opposite == vertex);
    let slit = |vertex: u32| edges.at([a, vertex]).len() == 1 && edges.at([b, vertex]).len() == 1;
    ring(a).intersection(&ring(b)).all(|&vertex| faces(vertex) || slit(vertex))
}

/// Parts the face beyond a sliver's long side in two, at the sliver's third corner.
fn let_in(patch: &mut Patch, sliver: usize, beyond: usize, side: [u32; 2]) {
    let third = (0..3).find(|at| !side.contains(&patch.faces[sliver].corners[*at])).unwrap_or(0);
    let (vertex, drawn) = (patch.faces[sliver].corners[third], patch.faces[sliver].drawn[third]);
    let Face { corners, drawn: old } = patch.faces[beyond];
    let half = |end: u32| {
        let put = |at: usize| if corners[at] == end { (vertex, drawn) } else { (corners[at], old[at]) };
        let [a, b, c] = [0, 1, 2].map(put);
        Face { corners: [a.0, b.0, c.0], drawn: [a.1, b.1, c.1] }
    };
    patch.faces[beyond] = half(side[0]);
    patch.faces.push(half(side[1]));
}
