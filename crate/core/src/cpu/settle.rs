//! `x_i += δ_i`, and a second look where that moved the cloth: pushed out of one part of the body or dragged along by its neighbours,
//! a vertex may have come into another part, or to a place that the first look missed. Twin: shaders/settle.wgsl.

use super::closest::{NOTHING, Posed, nearer};
use super::collide::{is_elsewhere, parted};
use fearless_simd::{Level, Simd, dispatch};
use glam::Vec3;

/// Distance moved beyond which a vertex is looked at again, metres: one in twenty of a cape, one in ten of a skirt. (By the first look alone, a
/// cape kept a vertex 4.1 mm inside and a skirt one 8.4 mm; with 1 mm the cape one of 2.1 mm, with this none and 0.7 mm.)
pub const AGAIN: f32 = 5e-4;

/// displacement [n, 3], seeds [n, width] (body vertices) -> positions [n, 3], moved.
pub fn settle(level: Level, displacement: &[f32], body: &Posed, seeds: &[u32], positions: &mut [f32]) {
    dispatch!(level, simd => kernel(simd, displacement, body, seeds, positions));
}

#[inline(always)]
fn kernel<S: Simd>(simd: S, displacement: &[f32], body: &Posed, seeds: &[u32], positions: &mut [f32]) {
    let positions = positions.as_chunks_mut::<3>().0;
    let seeds = seeds.chunks_exact(seeds.len() / positions.len().max(1));
    for ((position, by), seeds) in positions.iter_mut().zip(displacement.as_chunks::<3>().0).zip(seeds) {
        let by = Vec3::from_array(*by);
        let moved = Vec3::from_array(*position) + by;
        let more = if by.length_squared() > AGAIN * AGAIN { look(simd, moved, body, seeds) } else { Vec3::ZERO };
        *position = (moved + more).to_array();
    }
}

/// The displacement that brings `point` to the gap.
#[inline(always)]
fn look<S: Simd>(simd: S, point: Vec3, body: &Posed, seeds: &[u32]) -> Vec3 {
    let (own, other) = parted(seeds);
    let mut found = NOTHING;
    let mut start = body.nearest(point, own);
    for part in 0..2 {
        let place = body.leap(simd, point, body.walk(simd, point, start));
        found = nearer(found, body.widely(simd, point, place.0));
        start = body.nearest(point, &[other]);
        if part > 0 || other == own[0] || is_elsewhere(start.1, place.1) {
            break;
        }
    }
    found.1
}
