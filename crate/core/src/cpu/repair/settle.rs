//! `x_i += δ_i`, and a second look where that moved the cloth: pushed out of one part of the body or dragged along by
//! its neighbours, a vertex may have come into another part, or to a place that the first look missed. Twin:
//! shaders/settle.wgsl.

use super::closest::{GAP, NOTHING, Posed, nearer};
use super::collide::{is_elsewhere, parted};
use crate::cpu::{Cpu, Kernel};
use crate::operation::Settle;
use fearless_simd::{Simd, dispatch};
use glam::Vec3;

/// Vertices that moved further than this are looked at again, metres: one in twenty of a cape, one in ten of a skirt.
/// (By the first look alone, a vertex of a cape stayed 4.1 mm inside and one of a skirt 8.4 mm; with 1 mm, one of the
/// cape 2.1 mm; with this, none of the cape and 0.7 mm of the skirt.)
pub const AGAIN: f32 = 5e-4;

/// Poses the rings again where they are not those of this body, so that it does not depend on what `collide` left
/// behind.
impl Kernel for Settle<&[f32], &mut [f32], &[u32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { posed, normals, offsets, corners, seeds, displacement, positions } = self;
        let rings = &mut cpu.rings;
        dispatch!(cpu.level, simd => {
            let body = Posed::new(simd, GAP, [posed, normals], [offsets, corners], rings);
            kernel(simd, displacement, &body, seeds, positions);
        });
    }
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

#[cfg(feature = "suite")]
impl crate::suite::Suite for Settle<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// As of [`Collide`](crate::operation::Collide).
    const TOLERANCE: f64 = 1e-5;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let scene = super::collide::suite::Scene::new(rng, 300);
        let super::collide::suite::Scene { posed, normals, offsets, corners, seeds, positions } = scene;
        // Some move too little for a second look.
        let mut displacement = crate::suite::numbers(rng, positions.len(), 0.005);
        displacement.as_chunks_mut::<3>().0.iter_mut().step_by(3).for_each(|by| *by = by.map(|c| 0.05 * c));
        vec![Self { posed, normals, offsets, corners, seeds, displacement, positions }]
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let body = super::collide::suite::Wide::new(GAP, [&self.posed, &self.normals], [&self.offsets, &self.corners]);
        let look = |point: glam::DVec3| {
            let vertex = body.nearest(point);
            let beside = body.around(vertex).iter().filter_map(|others| body.foot(point, others[0] as usize));
            let wide = || beside.min_by(|a, b| a.0.total_cmp(&b.0));
            body.foot(point, vertex).or_else(wide).map_or(glam::DVec3::ZERO, |found| found.1)
        };
        let (positions, displacement) =
            (crate::suite::points(&self.positions), crate::suite::points(&self.displacement));
        let settled = |(position, by): (&glam::DVec3, &glam::DVec3)| {
            let moved = *position + *by;
            if by.length() > f64::from(AGAIN) { moved + look(moved) } else { moved }
        };
        vec![Some(positions.iter().zip(&displacement).flat_map(|pair| settled(pair).to_array()).collect())]
    }
}
