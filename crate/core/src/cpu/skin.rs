//! Linear blend skinning `x_i = Σ_j W[i,j] A_j T_i`, then `N⁻¹` where the world is wanted. network.md §4.

use crate::device::Space;
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, dispatch, f32x4};

/// rest [n, 3], joints and weights [n, width], transforms [J + 1, 3, 4] -> positions [n, 3].
pub fn skin(
    level: Level,
    rest: &[f32],
    joints: &[u32],
    weights: &[f32],
    transforms: &[f32],
    space: Space,
    positions: &mut [f32],
) {
    dispatch!(level, simd => kernel(simd, rest, joints, weights, transforms, space, positions));
}

#[inline(always)]
fn kernel<S: Simd>(
    simd: S,
    rest: &[f32],
    joints: &[u32],
    weights: &[f32],
    transforms: &[f32],
    space: Space,
    positions: &mut [f32],
) {
    let transforms = transforms.as_chunks::<12>().0;
    let back = transforms[transforms.len() - 1];
    let (rest, positions) = (rest.as_chunks::<3>().0, positions.as_chunks_mut::<3>().0);
    let width = weights.len() / rest.len();
    let slots = joints.chunks_exact(width).zip(weights.chunks_exact(width));
    for ((rest, position), (joints, weights)) in rest.iter().zip(positions).zip(slots) {
        let mut rows = [f32x4::splat(simd, 0.0); 3];
        for (joint, weight) in joints.iter().zip(weights) {
            let (transform, weight) = (&transforms[*joint as usize], f32x4::splat(simd, *weight));
            for (row, r) in rows.iter_mut().zip([0, 4, 8]) {
                *row = f32x4::from_slice(simd, &transform[r..r + 4]).mul_add(weight, *row);
            }
        }
        let blended = rows.map(|row| apply(row.as_array(), rest));
        *position = match space {
            Space::Body => blended,
            Space::World => [0, 4, 8].map(|r| apply(&[back[r], back[r + 1], back[r + 2], back[r + 3]], &blended)),
        };
    }
}

/// One row of a 3×4 transform applied to a point.
#[inline(always)]
fn apply(row: &[f32; 4], point: &[f32; 3]) -> f32 {
    row[0] * point[0] + row[1] * point[1] + row[2] * point[2] + row[3]
}
