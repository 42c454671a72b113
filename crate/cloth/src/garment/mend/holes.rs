//! Missing faces: holes of few edges, far shorter than the garment's openings.

use super::at;
use super::patch::{Face, Patch};
use crate::garment::check::{HOLE_EDGES, HOLE_SHARE, SLIVER};
use ctsn_rig::mesh::triangle::least_angle;
use ctsn_rig::mesh::{Edges, Mesh, ordered};
use std::collections::BTreeMap;

/// Closes holes by fans of faces, as long as none of them is a sliver.
pub(super) fn fill(patch: &mut Patch, said: &mut Vec<String>) {
    let edges = Edges::new(&patch.triangles());
    let place = |vertex: u32| patch.positions[vertex as usize];
    let length = |rim: &[[u32; 2]]| rim.iter().map(|[a, b]| place(*a).distance(place(*b))).sum::<f64>();
    let rims = edges.rims();
    // A piece's longest rim is no hole: a loose face has one around it.
    let pieces = Mesh { positions: patch.positions.clone(), triangles: patch.triangles() }.components();
    let piece = |rim: &[[u32; 2]]| pieces.of(rim[0][0] as usize);
    let mut longest: BTreeMap<usize, f64> = BTreeMap::new();
    for rim in &rims {
        let most = longest.entry(piece(rim)).or_default();
        *most = most.max(length(rim));
    }
    let small = |rim: &&Vec<[u32; 2]>| rim.len() <= HOLE_EDGES && length(rim) < HOLE_SHARE * longest[&piece(rim)];
    let mut places = Vec::new();
    let mut faces = Vec::new();
    for rim in rims.iter().filter(small) {
        let loop_of: Vec<u32> = rim.iter().map(|edge| edge[0]).collect();
        let closed = rim.first().zip(rim.last()).is_some_and(|(first, last)| last[1] == first[0]);
        if let Some(fan) = fan(&loop_of, &edges, place).filter(|_| closed && rim.len() > 2) {
            let names: Vec<String> = loop_of.iter().map(|vertex| patch.numbers[*vertex as usize].to_string()).collect();
            places.push(names.join("-"));
            faces.extend(fan);
        }
    }
    let drawn = |vertex: u32| {
        let corners = patch.faces.iter().flat_map(|face| face.corners.into_iter().zip(face.drawn));
        corners.filter(|(corner, _)| *corner == vertex).map(|(_, drawn)| drawn).next().unwrap_or(vertex)
    };
    let faces: Vec<Face> = faces.into_iter().map(|corners| Face { corners, drawn: corners.map(drawn) }).collect();
    patch.faces.extend(faces);
    if !places.is_empty() {
        said.push(at("small holes closed (vertices around them)", places));
    }
}

/// The fan over a loop whose least angle is largest, its faces against the loop's direction; `None` where each has a
/// sliver or an edge that is there already.
fn fan(rim: &[u32], edges: &Edges, place: impl Fn(u32) -> glam::DVec3) -> Option<Vec<[u32; 3]>> {
    let count = rim.len();
    let from = |start: usize| -> Vec<[u32; 3]> {
        let at = |step: usize| rim[(start + step) % count];
        (1..count - 1).map(|step| [at(0), at(step + 1), at(step)]).collect()
    };
    let least =
        |fan: &[[u32; 3]]| fan.iter().map(|corners| least_angle(corners.map(&place))).fold(f64::INFINITY, f64::min);
    let free = |fan: &[[u32; 3]]| {
        let inner = fan.iter().skip(1).map(|[a, _, c]| ordered([*a, *c]));
        inner.into_iter().all(|edge| edges.at(edge).is_empty())
    };
    let fans = (0..count).map(from).filter(|fan| free(fan) && least(fan) > SLIVER);
    fans.max_by(|a, b| least(a).total_cmp(&least(b)))
}
