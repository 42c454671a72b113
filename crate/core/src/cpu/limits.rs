//! Work that a processor can do at its best: what kernels are measured against.

use super::Level;
use super::vector::sum;
use fearless_simd::{Simd, SimdBase, SimdFloat, dispatch};

/// Multiply-adds at once, as many as hide one another's delay in two units; Chromium's wasm has no registers for more.
const CHAINS: usize = 8;

/// Multiply-adds in registers, `rounds` times [`CHAINS`] vectors: how many floating-point operations that was, and a
/// number made of all results, so that none is left out.
pub fn multiply_adds(level: Level, rounds: usize, factor: f32) -> (f64, f32) {
    dispatch!(level, simd => multiply_adds_kernel(simd, rounds, factor))
}

#[inline(always)]
fn multiply_adds_kernel<S: Simd>(simd: S, rounds: usize, factor: f32) -> (f64, f32) {
    let factor = S::f32s::splat(simd, factor);
    let mut chains = [factor; CHAINS];
    for _ in 0..rounds {
        for chain in &mut chains {
            *chain = chain.mul_add(factor, factor);
        }
    }
    let all = chains.into_iter().fold(factor, |all, chain| all + chain);
    ((2 * rounds * CHAINS * S::f32s::LEN) as f64, all.reduce_sum())
}

/// Sum of `values`: what is read is all that it costs.
pub fn read(level: Level, values: &[f32]) -> f32 {
    dispatch!(level, simd => sum(simd, values))
}
