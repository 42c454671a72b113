//! Extracts the closed shell from the field, cuts it at regions and keeps the outer piece.
//! One boundary loop per region: of what lies in one only the piece that holds its end falls away.

use super::field::Field;
use super::region::Region;
use ctsn_rig::mesh::{Mesh, ordered, triangle};
use fast_surface_nets::ndshape::RuntimeShape;
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// An open mesh and, for each vertex on its rim, the region it lies on.
pub(crate) struct Piece {
    /// The mesh, metres, outwards.
    pub mesh: Mesh,
    /// Region per vertex, by its number.
    pub rim: Vec<Option<usize>>,
}

/// Components with less than this share of the largest one's area are crumbs.
const CRUMB: f64 = 0.01;

/// The field's zero set, largest component, facing outwards.
pub(crate) fn extract(field: &Field) -> Mesh {
    largest(zero_set(field)).mesh
}

/// The field's zero set, every component but crumbs: a body may be of several parts.
pub(super) fn extract_parts(field: &Field) -> Piece {
    chosen(zero_set(field), |area, _, best| area >= CRUMB * best)
}

/// The field's zero set, facing outwards.
fn zero_set(field: &Field) -> Piece {
    let shape = RuntimeShape::<u32, 3>::new(field.size.map(|n| n as u32));
    let mut buffer = SurfaceNetsBuffer::default();
    surface_nets(&field.values, &shape, [0; 3], field.size.map(|n| n as u32 - 1), &mut buffer);
    let place = |p: &[f32; 3]| field.origin + Vec3::from(*p).as_dvec3() * field.cell;
    let positions = buffer.positions.iter().map(place).collect();
    let mut triangles: Vec<[u32; 3]> = buffer.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    let mut mesh = Mesh { positions, triangles: Vec::new() };
    let volume = |t: &[u32; 3]| triangle::volume(t.map(|i| mesh.positions[i as usize]));
    if triangles.iter().map(volume).sum::<f64>() < 0.0 {
        triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    mesh.triangles = triangles;
    Piece { rim: vec![None; mesh.positions.len()], mesh }
}

/// Cuts at every region in turn.
pub(crate) fn cut(mesh: Mesh, regions: &[Region]) -> Piece {
    let mut piece = Piece { rim: vec![None; mesh.positions.len()], mesh };
    for (index, region) in regions.iter().enumerate() {
        piece = cut_one(piece, region, index);
    }
    largest(piece)
}

/// Removes what lies in one region, connected to its end.
fn cut_one(piece: Piece, region: &Region, index: usize) -> Piece {
    let Piece { mesh, mut rim } = piece;
    let height: Vec<f64> = mesh.positions.iter().map(|p| region.past(*p)).collect();
    let bare = (0..height.len()).filter(|&v| height[v] > 0.0);
    let seed =
        bare.min_by(|&a, &b| mesh.positions[a].distance(region.end).total_cmp(&mesh.positions[b].distance(region.end)));
    let Some(seed) = seed else { return Piece { mesh, rim } };
    let mut gone = vec![false; height.len()];
    let rings = mesh.rings();
    gone[seed] = true;
    let mut queue = vec![seed];
    while let Some(vertex) = queue.pop() {
        for next in rings.of(vertex).iter().map(|next| *next as usize) {
            if height[next] > 0.0 && !gone[next] {
                gone[next] = true;
                queue.push(next);
            }
        }
    }
    let mut positions = mesh.positions;
    let mut crossing: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    let mut cross = |a: u32, b: u32| {
        *crossing.entry(ordered([a, b])).or_insert_with(|| {
            let (ha, hb) = (height[a as usize], height[b as usize]);
            positions.push(positions[a as usize].lerp(positions[b as usize], ha / (ha - hb)));
            rim.push(Some(index));
            positions.len() as u32 - 1
        })
    };
    let mut triangles = Vec::with_capacity(mesh.triangles.len());
    for triangle in &mesh.triangles {
        let mut kept = Vec::with_capacity(4);
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            if !gone[a as usize] {
                kept.push(a);
            }
            if gone[a as usize] != gone[b as usize] {
                kept.push(cross(a, b));
            }
        }
        (2..kept.len()).for_each(|k| triangles.push([kept[0], kept[k - 1], kept[k]]));
    }
    Piece { mesh: Mesh { positions, triangles }, rim }
}

/// The connected component of largest area.
fn largest(piece: Piece) -> Piece {
    chosen(piece, |_, is_largest, _| is_largest)
}

/// The connected components that are `wanted` by their area, whether it is the largest and the largest area; vertices
/// renumbered in their order.
fn chosen(piece: Piece, wanted: impl Fn(f64, bool, f64) -> bool) -> Piece {
    let Piece { mesh, rim } = piece;
    let components = mesh.components();
    let mut area = vec![0.0; mesh.positions.len()];
    for (t, corners) in mesh.triangles.iter().zip(mesh.corners()) {
        area[components.of(t[0] as usize)] += triangle::cross(corners).length();
    }
    let best = (0..area.len()).max_by(|&a, &b| area[a].total_cmp(&area[b])).unwrap_or(0);
    let keep = |t: &[u32; 3]| {
        let component = components.of(t[0] as usize);
        wanted(area[component], component == best, area[best])
    };
    let kept: Vec<[u32; 3]> = mesh.triangles.into_iter().filter(|t| keep(t)).collect();
    compact(&mesh.positions, &rim, kept)
}

/// Drops the vertices no triangle uses.
fn compact(positions: &[DVec3], rim: &[Option<usize>], triangles: Vec<[u32; 3]>) -> Piece {
    let mut number = vec![u32::MAX; positions.len()];
    triangles.iter().flatten().for_each(|&v| number[v as usize] = 0);
    let kept: Vec<usize> = (0..positions.len()).filter(|&v| number[v] == 0).collect();
    kept.iter().enumerate().for_each(|(index, &v)| number[v] = index as u32);
    Piece {
        mesh: Mesh {
            positions: kept.iter().map(|&v| positions[v]).collect(),
            triangles: triangles.iter().map(|t| t.map(|v| number[v as usize])).collect(),
        },
        rim: kept.iter().map(|&v| rim[v]).collect(),
    }
}
