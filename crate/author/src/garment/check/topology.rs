//! Faults of the mesh by itself: faces, edges, holes, pieces.

use super::{Findings, list};
use crate::gltf::Source;
use crate::rig::Mesh;
use std::collections::BTreeMap;

/// Angles below which a triangle is a sliver, degrees: refused, and remarked upon.
const SLIVER: [f64; 2] = [0.5, 8.0];

/// Holes are shorter than this share of the longest opening, or have at most [`HOLE_EDGES`] edges.
const HOLE_SHARE: f64 = 0.12;

/// A loop of so few edges is a missing face or two.
const HOLE_EDGES: usize = 6;

/// Triangles at an edge and whether each runs from the lower to the higher vertex.
type Edges = BTreeMap<(u32, u32), Vec<(usize, bool)>>;

/// Checks the mesh.
pub(super) fn check(mesh: &Mesh, source: &Source, findings: &mut Findings) {
    let number = |v: u32| source.numbers[v as usize];
    let face = |t: [u32; 3]| format!("{}-{}-{}", number(t[0]), number(t[1]), number(t[2]));
    let warnings = &mut findings.warnings;
    if !source.unused.is_empty() {
        let vertices = list(source.unused.iter().map(u32::to_string));
        warnings.push(format!("vertices that no face uses, left out: {vertices}"));
    }
    if !source.degenerate.is_empty() {
        let faces = list(source.degenerate.iter().map(|[a, b, c]| format!("{a}-{b}-{c}")));
        warnings.push(format!("faces without an area, left out: {faces}"));
    }
    slivers(mesh, &face, findings);
    let copies = copies(mesh);
    if !copies.is_empty() {
        let faces = list(copies.iter().map(|&t| face(mesh.triangles[t])));
        findings.errors.push(format!("duplicated faces (by vertices): {faces}; delete the copies"));
    }
    let mut edges = Edges::new();
    for (index, t) in mesh.triangles.iter().enumerate().filter(|(index, _)| !copies.contains(index)) {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            edges.entry((a.min(b), a.max(b))).or_default().push((index, a < b));
        }
    }
    let named =
        |edges: &mut dyn Iterator<Item = (u32, u32)>| list(edges.map(|(a, b)| format!("{}-{}", number(a), number(b))));
    let crowded = named(&mut edges.iter().filter(|(_, sides)| sides.len() > 2).map(|(edge, _)| *edge));
    if !crowded.is_empty() {
        findings.errors.push(format!("non-manifold edges, in more than two faces (by vertices): {crowded}"));
    }
    let turned = |sides: &[(usize, bool)]| sides.len() == 2 && sides[0].1 == sides[1].1;
    let turned = named(&mut edges.iter().filter(|(_, sides)| turned(sides)).map(|(edge, _)| *edge));
    if !turned.is_empty() {
        let reason = "the faces on either side look opposite ways, make their normals consistent";
        findings.errors.push(format!("edges (by vertices) {turned}: {reason}"));
    }
    holes(mesh, &edges, &number, findings);
    pieces(mesh, &number, findings);
}

/// Triangles so thin that their shape is rounding error, or nearly.
fn slivers(mesh: &Mesh, face: &impl Fn([u32; 3]) -> String, findings: &mut Findings) {
    let least = |t: &[u32; 3]| super::super::quality::least_angle(&mesh.positions, *t);
    let between =
        |low: f64, high: f64| list(mesh.triangles.iter().filter(|t| (low..high).contains(&least(t))).map(|t| face(*t)));
    let (refused, remarked) = (between(0.0, SLIVER[0]), between(SLIVER[0], SLIVER[1]));
    if !refused.is_empty() {
        findings.errors.push(format!("slivers, an angle below {}° (faces by vertices): {refused}", SLIVER[0]));
    }
    if !remarked.is_empty() {
        let reason = "even triangles simulate faster";
        findings
            .warnings
            .push(format!("thin faces, an angle below {}° (by vertices): {remarked}; {reason}", SLIVER[1]));
    }
}

/// Triangles with the same three vertices as an earlier one.
fn copies(mesh: &Mesh) -> Vec<usize> {
    let mut seen = std::collections::BTreeSet::new();
    let sorted = |t: &[u32; 3]| {
        let mut t = *t;
        t.sort_unstable();
        t
    };
    (0..mesh.triangles.len()).filter(|&index| !seen.insert(sorted(&mesh.triangles[index]))).collect()
}

/// Boundary loops: openings a garment is meant to have, and holes it is not.
fn holes(mesh: &Mesh, edges: &Edges, number: &impl Fn(u32) -> u32, findings: &mut Findings) {
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (&(a, b), sides) in edges {
        if let &[(_, forward)] = &sides[..] {
            let (from, to) = if forward { (a, b) } else { (b, a) };
            next.entry(from).or_default().push(to);
        }
    }
    let mut loops: Vec<(f64, Vec<u32>)> = Vec::new();
    while let Some((&start, _)) = next.iter().find(|(_, ends)| !ends.is_empty()) {
        let (mut at, mut walk, mut length) = (start, Vec::new(), 0.0);
        while let Some(to) = next.get_mut(&at).and_then(Vec::pop) {
            walk.push(at);
            length += mesh.positions[at as usize].distance(mesh.positions[to as usize]);
            at = to;
            if at == start {
                break;
            }
        }
        loops.push((length, walk));
    }
    let longest = loops.iter().fold(0.0, |longest: f64, (length, _)| longest.max(*length));
    if loops.is_empty() && !mesh.triangles.is_empty() {
        let reason = "a closed body, or cloth with two sides; wanted one sheet, open where it is put on";
        findings.warnings.push(format!("no opening: {reason}"));
    }
    for (length, walk) in &loops {
        if *length < HOLE_SHARE * longest || walk.len() <= HOLE_EDGES {
            let vertices = list(walk.iter().map(|v| number(*v).to_string()));
            let (count, around) = (walk.len(), 1e3 * length);
            findings.warnings.push(format!("a hole of {count} edges, {around:.0} mm around, at vertices {vertices}"));
        }
    }
}

/// Connected pieces: buttons and pockets fall on their own.
fn pieces(mesh: &Mesh, number: &impl Fn(u32) -> u32, findings: &mut Findings) {
    let mut piece: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    // Lowest number of a piece, spread until nothing changes.
    loop {
        let mut changed = false;
        for t in &mesh.triangles {
            let least = t.iter().map(|&v| piece[v as usize]).min().unwrap_or_default();
            for &v in t {
                changed |= piece[v as usize] != least;
                piece[v as usize] = least;
            }
        }
        if !changed {
            break;
        }
    }
    let mut sizes: BTreeMap<u32, usize> = BTreeMap::new();
    piece.iter().for_each(|first| *sizes.entry(*first).or_default() += 1);
    if sizes.len() > 1 {
        let named = list(sizes.iter().map(|(first, size)| format!("{size} vertices with vertex {}", number(*first))));
        let reason = "nothing holds them together";
        findings.warnings.push(format!("{} pieces that are not connected: {named}; {reason}", sizes.len()));
    }
}
