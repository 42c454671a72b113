//! {p : f(p) = 0} -> closed triangle mesh: naive surface nets on a grid, then vertices moved onto the surface.
//! simulation.md §4.1. The grid must resolve the thinnest gap; the remesher chooses the final edge lengths.

use super::loft::{Loft, join, project};
use ctsn_rig::Mesh;
use ctsn_rig::mesh::bounds;
use fast_surface_nets::{SurfaceNetsBuffer, ndshape::RuntimeShape, surface_nets};
use glam::{DVec3, UVec3};

/// Surface of the union of `lofts` on a grid of spacing `cell` metres.
pub fn extract(lofts: &[Loft], cell: f64) -> Mesh {
    let [low, high] = bounds(lofts.iter().flat_map(|loft| loft.bounds));
    let low = low - 2.0 * cell;
    let shape = ((high - low) / cell).ceil().as_uvec3() + 3;
    let mut field = vec![f64::INFINITY; (shape.x * shape.y * shape.z) as usize];
    for loft in lofts {
        let [from, to] = loft.bounds;
        // The smooth union feels a loft this far beyond its bounds.
        let band = loft.blend + 2.0 * cell;
        let (from, to) =
            (((from - low - band) / cell).floor().as_ivec3(), ((to - low + band) / cell).ceil().as_uvec3());
        let (from, to) = (from.max(glam::IVec3::ZERO).as_uvec3(), to.min(shape - 1));
        for z in from.z..=to.z {
            for y in from.y..=to.y {
                for x in from.x..=to.x {
                    let p = low + DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * cell;
                    let at = (x + shape.x * (y + shape.y * z)) as usize;
                    field[at] = join(field[at], loft, p);
                }
            }
        }
    }
    let mut field: Vec<f32> = field.iter().map(|&d| d.min(1.0) as f32).collect();
    while disambiguate(&mut field, shape) {}
    let mut nets = SurfaceNetsBuffer::default();
    let grid = RuntimeShape::<u32, 3>::new(shape.to_array());
    surface_nets(&field, &grid, [0; 3], (shape - 1).to_array(), &mut nets);
    let place = |p: &[f32; 3]| project(lofts, low + DVec3::new(p[0].into(), p[1].into(), p[2].into()) * cell);
    Mesh {
        positions: nets.positions.iter().map(place).collect(),
        triangles: nets.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    }
}

/// Fills cells whose corners of one sign touch only across a diagonal of a face or of the cell: there, surface nets
/// would join two sheets in one edge or vertex. In each such cell the outside corner nearest the surface becomes an
/// inside one. Returns whether any did.
fn disambiguate(field: &mut [f32], shape: UVec3) -> bool {
    const FACES: [[usize; 4]; 6] = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let (along_y, along_z) = (shape.x as usize, (shape.x * shape.y) as usize);
    let corners: [usize; 8] = std::array::from_fn(|c| (c & 1) + (c >> 1 & 1) * along_y + (c >> 2) * along_z);
    let mut changed = false;
    for z in 0..shape.z - 1 {
        for y in 0..shape.y - 1 {
            let row = (shape.x * (y + shape.y * z)) as usize;
            for cell in row..row + shape.x as usize - 1 {
                let inside: [bool; 8] = corners.map(|offset| field[cell + offset] < 0.0);
                let count = inside.iter().filter(|&&i| i).count();
                let crossed = |[a, b, c, d]: [usize; 4]| {
                    inside[a] == inside[c] && inside[b] == inside[d] && inside[a] != inside[b]
                };
                let opposite = |wanted: bool| (0..4).any(|c| inside[c] == wanted && inside[7 - c] == wanted);
                let apart = count == 2 && opposite(true) || count == 6 && opposite(false);
                if count == 0 || count == 8 || !apart && !FACES.into_iter().any(crossed) {
                    continue;
                }
                let outside = corners.iter().map(|offset| cell + offset).filter(|&at| field[at] >= 0.0);
                if let Some(nearest) = outside.min_by(|&a, &b| field[a].total_cmp(&field[b])) {
                    field[nearest] = -1e-6;
                    changed = true;
                }
            }
        }
    }
    changed
}
