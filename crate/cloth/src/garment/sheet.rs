//! A square of cloth hung from a rail: the longer side of the body's bounding box. It covers nothing, its upper edge is
//! pinned.

use super::{bounds, unwrap};
use crate::Result;
use ctsn_rig::{Character, Garment, Mesh};
use glam::DVec3;

/// Side of the sheet in lengths of the rail.
const SIDE: f64 = 0.96;
/// Distance from the rail, metres.
const AWAY: f64 = 0.006;

/// A sheet of about so many vertices, in rows of even triangles, before the rail's middle.
pub(super) fn sheet(rail: &Character, vertices: usize) -> Result<Garment> {
    let (low, high, _) = bounds(rail)?;
    let (size, middle) = (high - low, (low + high) / 2.0);
    let (along, front, depth) =
        if size.x >= size.z { (DVec3::X, DVec3::Z, size.z) } else { (DVec3::NEG_Z, DVec3::X, size.x) };
    let side = SIDE * size.x.max(size.z);
    let corner = middle - along * (side / 2.0) + front * (depth / 2.0 + AWAY);
    // Rows are nearer to each other than vertices in a row, by the height of an even triangle.
    let height = 0.75_f64.sqrt();
    let columns = ((height * vertices as f64).sqrt() - 1.2).round().max(1.0);
    let rows = (columns / height).round() as usize;
    let mut mesh = Mesh::default();
    let mut above = Vec::new();
    for row in 0..=rows {
        let at = |across: f64| corner + side * (along * (across / columns) + DVec3::NEG_Y * (row as f64 / rows as f64));
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(shares(columns as usize, row % 2 == 1).map(at));
        let below: Vec<u32> = (first..mesh.positions.len() as u32).collect();
        if row > 0 {
            weave(&above, &below, &mut mesh.triangles);
        }
        above = below;
    }
    let pins = (0..=columns as u32).collect();
    Ok(Garment { surface: unwrap::unwrap(&mesh), mesh, pins, drawn: None })
}

/// Places of the vertices of a row, in columns: between those of an even row for an odd one, and at both ends.
fn shares(columns: usize, odd: bool) -> impl Iterator<Item = f64> {
    let count = columns + 1 + usize::from(odd);
    (0..count).map(move |i| if odd { (i as f64 - 0.5).clamp(0.0, columns as f64) } else { i as f64 })
}

/// Triangles between two rows, one of which has a vertex more.
fn weave(above: &[u32], below: &[u32], triangles: &mut Vec<[u32; 3]>) {
    let facing = |a: u32, b: u32, c: u32| if above.len() < below.len() { [a, b, c] } else { [a, c, b] };
    let (few, many) = if above.len() < below.len() { (above, below) } else { (below, above) };
    for (i, tip) in few.iter().enumerate() {
        triangles.push(facing(*tip, many[i], many[i + 1]));
        triangles.extend(few.get(i + 1).map(|next| facing(*tip, many[i + 1], *next)));
    }
}
