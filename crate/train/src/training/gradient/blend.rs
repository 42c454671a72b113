//! `T[i] = rest[i] + c Σ_j w_j B_j[i]`: `dw_j = c Σ_i g_i · B_j[i]`, `dB_j[i] = c w_j g_i`.
//! A basis that does not learn is zero (an ablation), and with it dw.

use ctsn_core::cpu::Level;
use ctsn_core::cpu::vector::axpy;
use fearless_simd::{Simd, dispatch};

/// weights [count] or [n, count], basis [n, 3, count], share s, g [n, 3] -> dweights (overwritten), dbasis.
pub fn blend(
    level: Level,
    weights: &[f32],
    basis: &[f32],
    share: f32,
    g: &[f32],
    dweights: &mut [f32],
    dbasis: &mut [f32],
) {
    dispatch!(level, simd => kernel(simd, weights, basis, share, g, dweights, dbasis));
}

#[inline(always)]
fn kernel<S: Simd>(
    simd: S,
    weights: &[f32],
    basis: &[f32],
    share: f32,
    g: &[f32],
    dweights: &mut [f32],
    dbasis: &mut [f32],
) {
    let count = basis.len() / g.len();
    dweights.fill(0.0);
    let step = if weights.len() == count { 0 } else { count };
    let rows = basis.chunks_exact(3 * count).zip(dbasis.chunks_exact_mut(3 * count));
    for (i, (g, (basis, dbasis))) in g.chunks_exact(3).zip(rows).enumerate() {
        let weights = &weights[i * step..][..count];
        let dweights = &mut dweights[i * step..][..count];
        for (g, (basis, dbasis)) in g.iter().zip(basis.chunks_exact(count).zip(dbasis.chunks_exact_mut(count))) {
            axpy(simd, share * g, basis, dweights);
            axpy(simd, share * g, weights, dbasis);
        }
    }
}
