//! `exp` in SIMD: `2^k · e^r` with a degree-6 polynomial, relative error below 2e-7 for arguments in [-80, 0]. The
//! standard library's scalar exp costs more than the whole attention in wasm (120,000 calls a frame at n = 5,000).

use fearless_simd::{Simd, SimdBase, SimdFloat};

/// `e^x` of x ≤ 0; below -80 a number under 2e-35.
#[inline(always)]
pub fn exp<S: Simd>(simd: S, x: S::f32s) -> S::f32s {
    let splat = |value: f32| S::f32s::splat(simd, value);
    let x = x.max(splat(-80.0));
    // Adding 1.5 · 2^23 rounds x / ln 2 to the integer k and leaves it in the low bits of the sum.
    let shifted = x.mul_add(splat(std::f32::consts::LOG2_E), splat(12_582_912.0));
    let k = shifted - splat(12_582_912.0);
    let r = k.mul_add(splat(-0.693_359_4), x);
    let r = k.mul_add(splat(2.121_944_4e-4), r);
    let mut p = splat(1.0 / 720.0);
    for c in [1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0] {
        p = p.mul_add(r, splat(c));
    }
    p * S::f32s::from_bits((shifted.to_bits() << 23) + splat(1.0).to_bits())
}
