//! Faults of the mesh by itself: faces, edges, holes, pieces.

use super::{Findings, list};
use ctsn_rig::Garment;
use ctsn_rig::gltf::Source;
use ctsn_rig::mesh::triangle::least_angle;
use ctsn_rig::mesh::{Edges, Mesh, Side};
use std::collections::BTreeMap;

/// Angle below which a triangle is a sliver, degrees: refused where it cannot be mended.
pub const SLIVER: f64 = 0.5;

/// Angle below which it is remarked upon, degrees.
const THIN: f64 = 8.0;

/// Holes are shorter than this share of the longest opening, or have at most [`HOLE_EDGES`] edges.
pub const HOLE_SHARE: f64 = 0.12;

/// A loop of so few edges is a missing face or two.
pub const HOLE_EDGES: usize = 6;

/// Checks the mesh that is simulated.
pub(super) fn check(garment: &Garment, source: &Source, findings: &mut Findings) {
    let mesh = &garment.mesh;
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
    slivers(garment, &face, findings);
    let copies = copies(mesh);
    if !copies.is_empty() {
        let faces = list(copies.iter().map(|&t| face(mesh.triangles[t])));
        findings.errors.push(format!("duplicated faces (by vertices): {faces}; delete the copies"));
    }
    let kept = (0..mesh.triangles.len()).filter(|index| !copies.contains(index)).map(|index| mesh.triangles[index]);
    let edges = Edges::new(&kept.collect::<Vec<_>>());
    let named =
        |edges: &mut dyn Iterator<Item = [u32; 2]>| list(edges.map(|[a, b]| format!("{}-{}", number(a), number(b))));
    let crowded = named(&mut edges.iter().filter(|(_, sides)| sides.len() > 2).map(|(edge, _)| edge));
    if !crowded.is_empty() {
        findings.errors.push(format!("non-manifold edges, in more than two faces (by vertices): {crowded}"));
    }
    let turned = |sides: &[Side]| sides.len() == 2 && sides[0].forward == sides[1].forward;
    let turned = named(&mut edges.iter().filter(|(_, sides)| turned(sides)).map(|(edge, _)| edge));
    if !turned.is_empty() {
        let reason = "the faces on either side look opposite ways, make their normals consistent";
        findings.errors.push(format!("edges (by vertices) {turned}: {reason}"));
    }
    holes(mesh, &edges, &number, findings);
    pieces(mesh, &number, findings);
}

/// Triangles so thin that their shape is rounding error, or nearly. The latter of a mesh made here are nobody's to
/// mend.
fn slivers(garment: &Garment, face: &impl Fn([u32; 3]) -> String, findings: &mut Findings) {
    let mesh = &garment.mesh;
    let least = |t: &[u32; 3]| least_angle(t.map(|v| mesh.positions[v as usize]));
    let between =
        |low: f64, high: f64| list(mesh.triangles.iter().filter(|t| (low..high).contains(&least(t))).map(|t| face(*t)));
    let (refused, remarked) = (between(0.0, SLIVER), between(SLIVER, THIN));
    if !refused.is_empty() {
        findings.errors.push(format!("slivers, an angle below {SLIVER}° (faces by vertices): {refused}"));
    }
    if !remarked.is_empty() && garment.drawn.is_none() {
        let reason = "even triangles simulate faster";
        findings.warnings.push(format!("thin faces, an angle below {THIN}° (by vertices): {remarked}; {reason}"));
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
    let length = |[a, b]: [u32; 2]| mesh.positions[a as usize].distance(mesh.positions[b as usize]);
    let measured = |rim: Vec<[u32; 2]>| (rim.iter().fold(0.0, |sum, edge| sum + length(*edge)), rim);
    let loops: Vec<(f64, Vec<[u32; 2]>)> = edges.rims().into_iter().map(measured).collect();
    let longest = loops.iter().fold(0.0, |longest: f64, (length, _)| longest.max(*length));
    if loops.is_empty() && !mesh.triangles.is_empty() {
        let reason = "a closed body, or cloth with two sides; wanted one sheet, open where it is put on";
        findings.warnings.push(format!("no opening: {reason}"));
    }
    for (length, rim) in &loops {
        if *length < HOLE_SHARE * longest || rim.len() <= HOLE_EDGES {
            let vertices = list(rim.iter().map(|[v, _]| number(*v).to_string()));
            let (count, around) = (rim.len(), 1e3 * length);
            findings.warnings.push(format!("a hole of {count} edges, {around:.0} mm around, at vertices {vertices}"));
        }
    }
}

/// Connected pieces: buttons and pockets fall on their own.
fn pieces(mesh: &Mesh, number: &impl Fn(u32) -> u32, findings: &mut Findings) {
    let components = mesh.components();
    let mut sizes: BTreeMap<usize, usize> = BTreeMap::new();
    (0..mesh.positions.len()).for_each(|vertex| *sizes.entry(components.of(vertex)).or_default() += 1);
    if sizes.len() > 1 {
        let named =
            list(sizes.iter().map(|(first, size)| format!("{size} vertices with vertex {}", number(*first as u32))));
        let reason = "nothing holds them together";
        findings.warnings.push(format!("{} pieces that are not connected: {named}; {reason}", sizes.len()));
    }
}
