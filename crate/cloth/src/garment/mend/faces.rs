//! Copies of faces, edges in more than two of them, and faces that look the other way.

use super::at;
use super::patch::Patch;
use ctsn_rig::mesh::triangle::cross;
use ctsn_rig::mesh::{Components, Edges, Side};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// What is cut apart is moved apart by this share of the way to the middle of its own faces, at most so many metres:
/// cloth cannot begin in one place with other cloth.
const APART: (f64, f64) = (0.2, 0.003);

/// Removes faces of the same three vertices as an earlier one.
pub(super) fn remove_copies(patch: &mut Patch, said: &mut Vec<String>) {
    let mut seen = BTreeSet::new();
    let sorted = |mut corners: [u32; 3]| {
        corners.sort_unstable();
        corners
    };
    let kept: Vec<bool> = patch.faces.iter().map(|face| seen.insert(sorted(face.corners))).collect();
    let places: Vec<String> = (0..kept.len()).filter(|face| !kept[*face]).map(|face| patch.name(face)).collect();
    if !places.is_empty() {
        said.push(at("duplicated faces removed (by vertices)", places));
        patch.retain(|face| kept[face]);
    }
}

/// Cuts edges in more than two faces, and vertices where fans of faces only touch: the two flattest faces at an edge
/// stay together, every other gets vertices of its own.
pub(super) fn split(patch: &mut Patch, said: &mut Vec<String>) {
    let edges = Edges::new(&patch.triangles());
    let corner = |side: &Side, vertex: u32| {
        let at = patch.faces[side.triangle].corners.iter().position(|corner| *corner == vertex);
        3 * side.triangle + at.unwrap_or(0)
    };
    let mut fans = Components::new(3 * patch.faces.len());
    let mut crowded = Vec::new();
    for ([a, b], sides) in edges.iter() {
        let pair = match sides {
            [_] => continue,
            [one, two] => [one, two],
            more => {
                crowded.push(format!("{}-{}", patch.numbers[a as usize], patch.numbers[b as usize]));
                flattest(patch, [a, b], more)
            }
        };
        [a, b].iter().for_each(|&end| fans.join(pair.map(|side| corner(side, end))));
    }
    let mut first: BTreeMap<u32, usize> = BTreeMap::new();
    let mut copies: BTreeMap<usize, u32> = BTreeMap::new();
    let mut touching = Vec::new();
    for at in 0..3 * patch.faces.len() {
        let (fan, vertex) = (fans.of(at), patch.faces[at / 3].corners[at % 3]);
        if *first.entry(vertex).or_insert(fan) == fan {
            continue;
        }
        let copy = *copies.entry(fan).or_insert_with(|| {
            touching.push(patch.numbers[vertex as usize].to_string());
            patch.copy(vertex)
        });
        patch.faces[at / 3].corners[at % 3] = copy;
    }
    for copy in copies.values() {
        let own = patch.faces.iter().filter(|face| face.corners.contains(copy)).flat_map(|face| face.corners);
        let places: Vec<DVec3> = own.map(|vertex| patch.positions[vertex as usize]).collect();
        let way = places.iter().sum::<DVec3>() / places.len().max(1) as f64 - patch.positions[*copy as usize];
        patch.positions[*copy as usize] += (APART.0 * way).clamp_length_max(APART.1);
    }
    if !crowded.is_empty() {
        said.push(at("edges in more than two faces cut apart (by vertices)", crowded));
    } else if !touching.is_empty() {
        said.push(at("vertices where pieces only touched cut apart", touching));
    }
}

/// The two faces at an edge that are most nearly in one plane, on either side of it.
fn flattest<'a>(patch: &Patch, edge: [u32; 2], sides: &'a [Side]) -> [&'a Side; 2] {
    let [a, b] = edge.map(|vertex| patch.positions[vertex as usize]);
    let along = (b - a).normalize_or_zero();
    let away = |side: &Side| (patch.positions[side.opposite as usize] - a).reject_from(along).normalize_or_zero();
    let pairs = sides.iter().enumerate().flat_map(|(at, one)| sides[at + 1..].iter().map(move |two| [one, two]));
    let folded = |[one, two]: &[&Side; 2]| away(one).dot(away(two));
    pairs.min_by(|a, b| folded(a).total_cmp(&folded(b))).unwrap_or([&sides[0], &sides[1]])
}

/// Turns faces until all of a piece look to the side that most of its area looks to. Where that cannot be (a band with
/// half a twist), edges remain of which the check tells.
pub(super) fn wind(patch: &mut Patch, said: &mut Vec<String>) {
    let edges = Edges::new(&patch.triangles());
    let mut beside: Vec<Vec<(usize, bool)>> = vec![Vec::new(); patch.faces.len()];
    for (_, sides) in edges.iter() {
        if let [one, two] = sides {
            let same = one.forward != two.forward;
            beside[one.triangle].push((two.triangle, same));
            beside[two.triangle].push((one.triangle, same));
        }
    }
    let mut turned: Vec<Option<bool>> = vec![None; patch.faces.len()];
    for start in 0..patch.faces.len() {
        if turned[start].is_some() {
            continue;
        }
        turned[start] = Some(false);
        let mut piece = vec![start];
        let mut at = 0;
        while at < piece.len() {
            let own = turned[piece[at]] == Some(true);
            for &(next, same) in &beside[piece[at]] {
                if turned[next].is_none() {
                    turned[next] = Some(own == same);
                    piece.push(next);
                }
            }
            at += 1;
        }
        let area = |which: bool| -> f64 {
            let faces = piece.iter().filter(|face| turned[**face] == Some(which));
            faces.map(|face| cross(patch.corners(*face)).length()).sum()
        };
        if area(true) > area(false) {
            piece.iter().for_each(|&face| turned[face] = turned[face].map(|turned| !turned));
        }
    }
    let faces: Vec<usize> = (0..patch.faces.len()).filter(|face| turned[*face] == Some(true)).collect();
    if !faces.is_empty() {
        said.push(at(
            "faces turned to look as those beside them (by vertices)",
            faces.iter().map(|face| patch.name(*face)).collect(),
        ));
        faces.into_iter().for_each(|face| {
            patch.faces[face].corners.swap(1, 2);
            patch.faces[face].drawn.swap(1, 2);
        });
    }
}
