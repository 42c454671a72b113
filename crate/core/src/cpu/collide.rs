//! How far cloth vertices must move to lie outside the posed body: the gradient of `E_B` (paper, § Penetration Handling) in one step.
//! The closest body point is searched by walking over the body's surface from a few seeds kept with the model, so that it depends on
//! nothing but the pose, and cloth does not find a part of the body that it never came near. Twin: shaders/collide.wgsl.

use super::closest::{NOTHING, Posed, nearer};
use fearless_simd::{Level, Select, Simd, SimdBase, SimdFloat, SimdMask, dispatch};
use glam::Vec3;

/// The body's first vertices, spread evenly over it: cloth that hangs free is searched from the nearest of them, too,
/// if that is nearer than its seed on another part. (From its own
/// places alone, the back of a robe did not find a foot lifted higher than in training: 35 mm inside. 24 of them
/// left a vertex 2.1 mm inside.)
pub const LANDMARKS: usize = 64;
/// Distance from its own places beyond which cloth hangs free, or is too deep inside to trust them, metres. (With 0.08, a robe kept a
/// vertex 2.8 mm inside.)
pub const FREE: f32 = 0.03;
/// The last seed lies on another part of the body, which is not looked at where it is so much further away than what was found, metres.
/// (It spares a fifth of the work, and nothing changes.)
pub const ELSEWHERE: f32 = 0.1;

/// positions [n, 3], seeds [n, width] (body vertices) -> push [n, 3], the displacement to the gap; zero where there is room.
pub fn collide(level: Level, positions: &[f32], body: &Posed, seeds: &[u32], push: &mut [f32]) {
    dispatch!(level, simd => kernel(simd, positions, body, seeds, push));
}

#[inline(always)]
fn kernel<S: Simd>(simd: S, positions: &[f32], body: &Posed, seeds: &[u32], push: &mut [f32]) {
    let landmarks = Landmarks::new(body);
    let positions = positions.as_chunks::<3>().0;
    let seeds = seeds.chunks_exact(seeds.len() / positions.len().max(1));
    for ((point, seeds), push) in positions.iter().zip(seeds).zip(push.as_chunks_mut::<3>().0) {
        *push = displacement(simd, Vec3::from_array(*point), body, seeds, &landmarks).to_array();
    }
}

/// The displacement that brings `point` to the gap. Where the cloth comes near another part of the body than its own, as in an armpit, the
/// nearer part decides. So it does where cloth hangs free. (Where the part it is deeper inside of decides, as of a union of parts, a search that
/// ended on the far side of a limb threw cloth 47 mm off, and a skirt trembled by 11 % more instead of 1.)
#[inline(always)]
fn displacement<S: Simd>(simd: S, point: Vec3, body: &Posed, seeds: &[u32], landmarks: &Landmarks) -> Vec3 {
    let (own, other) = parted(seeds);
    let mut found = NOTHING;
    let mut start = body.nearest(point, own);
    // One call for both parts: written twice, the module of the page was 20 kB larger.
    for part in 0..2 {
        found = nearer(found, body.around(simd, point, body.walk(simd, point, start)));
        if part > 0 {
            break;
        }
        start = body.nearest(point, &[other]);
        if found.0 > FREE * FREE {
            let landmark = landmarks.nearest(simd, point);
            start = if landmark.1 < start.1 { landmark } else { start };
        } else if other == own[0] || is_elsewhere(start.1, found.0) {
            break;
        }
    }
    found.1
}

/// A vertex's own seeds, and the one on another part of the body, the first again where there is none.
#[inline(always)]
pub fn parted(seeds: &[u32]) -> (&[u32], u32) {
    (&seeds[..(seeds.len() - 1).max(1)], seeds[seeds.len() - 1])
}

/// Whether a place is too far away to lead to a part nearer than what was found: squared distances.
#[inline(always)]
pub fn is_elsewhere(place: f32, found: f32) -> bool {
    let bound = found.sqrt() + ELSEWHERE;
    place > bound * bound
}

/// Positions of the landmarks by axis, so that many are compared at once.
struct Landmarks([[f32; LANDMARKS]; 3]);

impl Landmarks {
    #[inline(always)]
    fn new(body: &Posed) -> Self {
        let mut axes = [[f32::INFINITY; LANDMARKS]; 3];
        for (i, position) in body.positions.iter().take(LANDMARKS).enumerate() {
            (0..3).for_each(|axis| axes[axis][i] = position[axis]);
        }
        Self(axes)
    }

    /// The nearest one and its squared distance.
    #[inline(always)]
    fn nearest<S: Simd>(&self, simd: S, point: Vec3) -> (u32, f32) {
        let lanes = S::f32s::LEN;
        let (px, py, pz) =
            (S::f32s::splat(simd, point.x), S::f32s::splat(simd, point.y), S::f32s::splat(simd, point.z));
        let mut best = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, f32::INFINITY));
        let [x, y, z] = &self.0;
        for first in (0..LANDMARKS).step_by(lanes) {
            let x = S::f32s::from_slice(simd, &x[first..first + lanes]) - px;
            let y = S::f32s::from_slice(simd, &y[first..first + lanes]) - py;
            let z = S::f32s::from_slice(simd, &z[first..first + lanes]) - pz;
            let squared = x.mul_add(x, y.mul_add(y, z * z));
            best = (squared.simd_lt(best.1).select(S::f32s::splat(simd, first as f32), best.0), squared.min(best.1));
        }
        let least = best.1.reduce_min();
        let lane = best.1.simd_eq(S::f32s::splat(simd, least)).to_bitmask().trailing_zeros() as usize % lanes;
        (best.0.as_slice()[lane] as u32 + lane as u32, least)
    }
}
