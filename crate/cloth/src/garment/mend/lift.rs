//! Cloth where it can begin: right side out, out of the body, out of itself. What is lifted takes its neighbours along,
//! less and less, so that no crest is left in the cloth's rest shape.

use crate::garment::check::{Findings, INWARDS, Outside, Place, inside, inwards, list, mistaken};
use crate::simulate::{Elements, untangle};
use ctsn_rig::gltf::Source;
use ctsn_rig::{Drawn, Garment};
use glam::DVec3;

/// Cloth deeper than the first is lifted until it is as far outside as the second, in body extents: 1 and 2 mm of a
/// human. The outer skin is that exact.
const LIFT: [f64; 2] = [0.0006, 0.0012];
/// Rounds of lifting and untangling, each of which may undo a little of the other.
const ROUNDS: usize = 6;
/// Steps by which a lift spreads over the neighbours, each by half.
const SPREAD: usize = 4;

/// Puts a garment where it can begin, or adds the errors why it cannot be.
pub(in crate::garment) fn place(
    outside: &Outside,
    garment: &mut Garment,
    source: &Source,
    said: &mut Vec<String>,
    findings: &mut Findings,
) {
    findings.errors.extend(mistaken(outside, garment));
    if !findings.errors.is_empty() {
        return;
    }
    let places = outside.places(&garment.mesh.positions);
    let (share, _) = inwards(&garment.mesh, &places);
    if share > INWARDS {
        said.push(format!("turned right side out: {:.0} % of its area looked at the body", 100.0 * share));
        garment.mesh.triangles.iter_mut().chain(&mut garment.surface.triangles).for_each(|face| face.swap(1, 2));
        garment.drawn.iter_mut().for_each(Drawn::turn);
    }
    let mut deep = Findings::default();
    inside(&places, outside.body, source, &mut deep);
    findings.errors.extend(deep.errors);
    if findings.errors.is_empty() {
        free(outside, garment, source, said);
    }
}

/// Lifts and untangles in turn.
fn free(outside: &Outside, garment: &mut Garment, source: &Source, said: &mut Vec<String>) {
    let mesh = &mut garment.mesh;
    let (elements, rings) = (Elements::new(&mesh.triangles, mesh.positions.len()), mesh.rings());
    let [deep, clear] = LIFT.map(|share| share * outside.body);
    let before = outside.places(&mesh.positions);
    let mut buried: Vec<usize> = (0..before.len()).filter(|&v| before[v].distance < -deep).collect();
    let crossing = elements.crossings(&mesh.positions);
    for _ in 0..ROUNDS {
        let places = outside.places(&mesh.positions);
        let sunk = places.iter().any(|place| place.distance < -deep);
        if sunk {
            lift(&places, deep, clear, &rings, &mut mesh.positions);
        }
        let tangled = !elements.crossings(&mesh.positions).is_empty();
        if tangled {
            untangle(&elements, &rings, &mut mesh.positions);
        }
        if !sunk && !tangled {
            break;
        }
    }
    buried.sort_by(|&a, &b| before[a].distance.total_cmp(&before[b].distance));
    if let Some(&worst) = buried.first() {
        let (share, depth) = (100.0 * buried.len() as f64 / before.len() as f64, -1e3 * before[worst].distance);
        let vertices = list(buried.iter().map(|&v| source.numbers[v].to_string()));
        said.push(format!(
            "{} vertices ({share:.1} %) lifted out of the body, from up to {depth:.0} mm deep, deepest first: {vertices}",
            buried.len()
        ));
    }
    if !crossing.is_empty() {
        let first = |[face, _]: &[u32; 2]| source.numbers[mesh.triangles[*face as usize][0] as usize].to_string();
        let left = elements.crossings(&mesh.positions).len();
        let near = list(crossing.iter().map(first));
        said.push(format!(
            "{} pairs of faces that crossed smoothed apart, {left} are left, near vertices {near}",
            crossing.len()
        ));
    }
}

/// Moves what is deeper than `deep` out until it is `clear` of the body, and its neighbours by half as much, theirs by
/// a quarter.
fn lift(
    places: &[Place],
    deep: f64,
    clear: f64,
    rings: &ctsn_core::topology::Graph<Vec<u32>>,
    positions: &mut [DVec3],
) {
    let mut moves: Vec<DVec3> = places
        .iter()
        .map(|place| if place.distance < -deep { place.out * (clear - place.distance) } else { DVec3::ZERO })
        .collect();
    let fixed: Vec<bool> = moves.iter().map(|moved| *moved != DVec3::ZERO).collect();
    for _ in 0..SPREAD {
        let last = moves.clone();
        for vertex in (0..moves.len()).filter(|vertex| !fixed[*vertex]) {
            let ring = rings.of(vertex);
            let mean = ring.iter().map(|&next| last[next as usize]).sum::<DVec3>() / ring.len().max(1) as f64;
            moves[vertex] = 0.5 * mean;
        }
    }
    positions.iter_mut().zip(moves).for_each(|(position, moved)| *position += moved);
}
