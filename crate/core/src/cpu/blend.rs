//! `Δ[i] = Σ_j w_j B_j[i]`, the weights shared by all vertices (network.md §2) or one row per vertex (§3), and `T = rest + c·Δ` (§4), where the
//! confidence c is 1 among the poses seen in training.
//! Twin: shaders/blend.wgsl.

use super::vector::dot;
use fearless_simd::{Level, Simd, dispatch};

/// weights [count] or [n, count], basis [n, 3, count], rest [n, 3] -> residual and template [n, 3].
pub fn blend(
    level: Level,
    weights: &[f32],
    basis: &[f32],
    rest: &[f32],
    confidence: f32,
    residual: &mut [f32],
    template: &mut [f32],
) {
    dispatch!(level, simd => kernel(simd, weights, basis, residual));
    for ((template, rest), residual) in template.iter_mut().zip(rest).zip(residual) {
        *template = rest + confidence * *residual;
    }
}

#[inline(always)]
fn kernel<S: Simd>(simd: S, weights: &[f32], basis: &[f32], residual: &mut [f32]) {
    let count = basis.len() / residual.len();
    let shared = weights.len() == count;
    for (i, (residual, basis)) in residual.chunks_exact_mut(3).zip(basis.chunks_exact(3 * count)).enumerate() {
        let weights = if shared { weights } else { &weights[i * count..][..count] };
        for (residual, basis) in residual.iter_mut().zip(basis.chunks_exact(count)) {
            *residual = dot(simd, weights, basis);
        }
    }
}
