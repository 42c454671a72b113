//! Sum, dot product and scaled addition over slices of any length: whole vectors, then the rest.

use fearless_simd::{Simd, SimdBase, SimdFloat};

/// `Σ a_i b_i`; slices of equal length.
#[inline(always)]
pub fn dot<S: Simd>(simd: S, a: &[f32], b: &[f32]) -> f32 {
    let lanes = S::f32s::LEN;
    let (mut a, mut b) = (a.chunks_exact(lanes), b.chunks_exact(lanes));
    let mut sum = S::f32s::splat(simd, 0.0);
    for (a, b) in a.by_ref().zip(b.by_ref()) {
        sum = S::f32s::from_slice(simd, a).mul_add(S::f32s::from_slice(simd, b), sum);
    }
    let tail: f32 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    sum.reduce_sum() + tail
}

/// `Σ a_i`.
#[inline(always)]
pub fn sum<S: Simd>(simd: S, a: &[f32]) -> f32 {
    let mut chunks = a.chunks_exact(S::f32s::LEN);
    let mut sum = S::f32s::splat(simd, 0.0);
    for chunk in chunks.by_ref() {
        sum += S::f32s::from_slice(simd, chunk);
    }
    sum.reduce_sum() + chunks.remainder().iter().sum::<f32>()
}

/// `y += a x`; slices of equal length.
#[inline(always)]
pub fn axpy<S: Simd>(simd: S, a: f32, x: &[f32], y: &mut [f32]) {
    let lanes = S::f32s::LEN;
    let scale = S::f32s::splat(simd, a);
    let (mut x, mut y) = (x.chunks_exact(lanes), y.chunks_exact_mut(lanes));
    for (x, y) in x.by_ref().zip(y.by_ref()) {
        S::f32s::from_slice(simd, x).mul_add(scale, S::f32s::from_slice(simd, y)).store_slice(y);
    }
    for (x, y) in x.remainder().iter().zip(y.into_remainder()) {
        *y += a * x;
    }
}

/// The first `length` numbers of what grows to its final size in the first frame; they hold what they held.
pub fn room(scratch: &mut Vec<f32>, length: usize) -> &mut [f32] {
    if scratch.len() < length {
        scratch.resize(length, 0.0);
    }
    &mut scratch[..length]
}
