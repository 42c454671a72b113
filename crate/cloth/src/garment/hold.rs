//! What holds a garment up: shoulders, backs and heads that it lies on, or springs. Where nothing does and nobody
//! pinned it, the highest opening around the body is taken for its waistband; what has none would fall, and is said to.

use super::check::{Findings, Outside, Place, list};
use ctsn_rig::gltf::Source;
use ctsn_rig::mesh::{Edges, triangle};
use ctsn_rig::{Garment, Mesh};
use glam::DVec3;
use std::collections::BTreeMap;

/// Cloth lies on the body where it is nearer to it than the first, in body extents, and the body looks up by at least
/// the second, cosine of the slope.
const LIES: [f64; 2] = [0.035, 0.72];
/// What lies is at least this share of a garment's area.
const SHARE: f64 = 0.01;
/// A band is this near to the body, median of its vertices, in body extents; and goes around something: the body's
/// outward directions along it add up to less than this share.
const BAND: [f64; 2] = [0.03, 0.5];
/// Pieces of less than this share of the vertices are trimmings.
const PIECE: f64 = 0.1;

/// Pins each piece of a garment that nothing holds by its band, or adds the error that it falls; trimmings, such as
/// buttons, as a whole. Pieces of a garment with pins are as its maker wanted them, but for trimmings.
pub(super) fn hold(
    outside: &Outside,
    garment: &mut Garment,
    source: &Source,
    said: &mut Vec<String>,
    findings: &mut Findings,
) {
    let pinned = garment.pins.clone();
    let body = outside.body;
    let places = outside.places(&garment.mesh.positions);
    let components = garment.mesh.components();
    let mut pieces: BTreeMap<usize, usize> = BTreeMap::new();
    (0..places.len()).for_each(|vertex| *pieces.entry(components.of(vertex)).or_default() += 1);
    let mut trimmings = Vec::new();
    for (piece, size) in pieces {
        let own = |vertex: u32| components.of(vertex as usize) == piece;
        if pinned.iter().any(|pin| own(*pin)) || lies(&garment.mesh, &places, body, &own) {
            continue;
        }
        if (size as f64) < PIECE * places.len() as f64 {
            garment.pins.extend((0..places.len() as u32).filter(|vertex| own(*vertex)));
            trimmings.push(format!("{size} vertices with vertex {}", source.numbers[piece]));
            continue;
        }
        if !pinned.is_empty() {
            continue;
        }
        let number = source.numbers[piece];
        match band(&garment.mesh, &places, body, &own) {
            Some(band) => {
                let height = band.iter().map(|&v| garment.mesh.positions[v as usize].y).sum::<f64>() / band.len() as f64;
                let vertices = list(band.iter().map(|&v| source.numbers[v as usize].to_string()));
                said.push(format!(
                    "a waistband was found and pinned: {} vertices, {height:.2} m high: {vertices} (an attribute _PIN says otherwise)",
                    band.len()
                ));
                garment.pins.extend(band);
            }
            None => findings.errors.push(format!(
                "nothing holds it up: the piece with vertex {number} lies on no part of the body and has no opening close \
                 around it, so it would fall; mark what holds it by the vertex attribute _PIN"
            )),
        }
    }
    if !trimmings.is_empty() {
        let count = trimmings.len();
        said.push(format!(
            "{count} small pieces that nothing holds pinned as they are: {}",
            list(trimmings.into_iter())
        ));
    }
    garment.pins.sort_unstable();
    garment.pins.dedup();
}

/// Whether enough of a piece lies on the body.
fn lies(mesh: &Mesh, places: &[Place], body: f64, own: &impl Fn(u32) -> bool) -> bool {
    let (mut lying, mut total) = (0.0, 0.0);
    for face in mesh.triangles.iter().filter(|face| own(face[0])) {
        let area = triangle::area(face.map(|v| mesh.positions[v as usize]));
        let on = |v: &u32| places[*v as usize].distance < LIES[0] * body && places[*v as usize].normal.y > LIES[1];
        total += area;
        lying += if face.iter().all(on) { area } else { 0.0 };
    }
    lying > SHARE * total
}

/// The vertices of a piece's highest opening that goes close around the body.
fn band(mesh: &Mesh, places: &[Place], body: f64, own: &impl Fn(u32) -> bool) -> Option<Vec<u32>> {
    let rims = Edges::new(&mesh.triangles).rims();
    let rims = rims.iter().map(|rim| rim.iter().map(|edge| edge[0]).collect::<Vec<u32>>());
    let around = |rim: &Vec<u32>| {
        let mut distances: Vec<f64> = rim.iter().map(|&v| places[v as usize].distance.abs()).collect();
        distances.sort_by(f64::total_cmp);
        let outwards = rim.iter().map(|&v| places[v as usize].normal).sum::<DVec3>() / rim.len() as f64;
        distances[distances.len() / 2] < BAND[0] * body && outwards.with_y(0.0).length() < BAND[1]
    };
    let height = |rim: &Vec<u32>| rim.iter().map(|&v| mesh.positions[v as usize].y).sum::<f64>() / rim.len() as f64;
    let bands = rims.filter(|rim| rim.len() > 2 && own(rim[0]) && around(rim));
    bands.max_by(|a, b| height(a).total_cmp(&height(b)))
}
