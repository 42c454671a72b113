//! `x_i += δ_i`, and a second look where that moved the cloth: pushed out of one part of the body or dragged along by its neighbours,
//! a vertex may have come into another part, or to a place that the first look missed. Twin: shaders/settle.wgsl.

use super::closest::{Posed, nearer};
use super::collide::{is_elsewhere, parted};
use fearless_simd::{Level, Simd, dispatch};
use glam::Vec3;

/// Distance moved beyond which a vertex is looked at again, metres: one in twenty of a cape, one in ten of a skirt. (By the first look alone,
/// vertices stayed 4 and 8 mm inside; with 1 mm, 2.1 mm.)
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
    let place = body.leap(simd, point, body.walk(simd, point, body.nearest(point, own)));
    let found = body.widely(simd, point, place.0);
    let start = body.nearest(point, &[other]);
    if other == own[0] || is_elsewhere(start.1, place.1) {
        return found.1;
    }
    nearer(found, body.widely(simd, point, body.leap(simd, point, body.walk(simd, point, start)).0)).1
}
