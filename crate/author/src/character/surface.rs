//! {p : f(p) = 0} -> closed triangle mesh: naive surface nets on a grid, then vertices moved onto the surface.
//! simulation.md §4.1. The grid must resolve the thinnest gap; the remesher chooses the final edge lengths.

use super::loft::{Loft, join, project};
use crate::rig::Mesh;
use fast_surface_nets::{SurfaceNetsBuffer, ndshape::RuntimeShape, surface_nets};
use glam::DVec3;

/// Surface of the union of `lofts` on a grid of spacing `cell` metres.
pub fn extract(lofts: &[Loft], cell: f64) -> Mesh {
    let (low, high) = lofts.iter().fold((DVec3::MAX, DVec3::MIN), |(l, h), loft| (l.min(loft.bounds[0]), h.max(loft.bounds[1])));
    let low = low - 2.0 * cell;
    let shape = ((high - low) / cell).ceil().as_uvec3() + 3;
    let mut field = vec![f64::INFINITY; (shape.x * shape.y * shape.z) as usize];
    for loft in lofts {
        let [from, to] = loft.bounds;
        // A band beyond the loft within which the smooth union still feels it.
        let band = loft.blend + 2.0 * cell;
        let (from, to) = (((from - low - band) / cell).floor().as_ivec3(), ((to - low + band) / cell).ceil().as_uvec3());
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
    let field: Vec<f32> = field.iter().map(|&d| d.min(1.0) as f32).collect();
    let mut nets = SurfaceNetsBuffer::default();
    let grid = RuntimeShape::<u32, 3>::new(shape.to_array());
    surface_nets(&field, &grid, [0; 3], (shape - 1).to_array(), &mut nets);
    let place = |p: &[f32; 3]| project(lofts, low + DVec3::new(p[0].into(), p[1].into(), p[2].into()) * cell);
    Mesh {
        positions: nets.positions.iter().map(place).collect(),
        triangles: nets.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    }
}
