//! `β = sigmoid(w_g · [ĥ ; r ; ĥ - r])`, `h = ReLU(LayerNorm((1-β) ĥ + β r))`, eps 1e-5. network.md §3.

use super::exp::exp;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat};

/// LayerNorm's eps; part of the contract.
pub const EPSILON: f32 = 1e-5;

/// The end of [`Attend`](crate::operation::Attend), of one vertex: ĥ, r [F], gate [3F], norm weight and bias [F] ->
/// h [F].
#[cfg_attr(target_arch = "wasm32", inline(never))]
#[cfg_attr(not(target_arch = "wasm32"), inline(always))]
pub(super) fn gate<S: Simd>(
    simd: S,
    attended: &[f32],
    skip: &[f32],
    gate: &[f32],
    norm_weight: &[f32],
    norm_bias: &[f32],
    output: &mut [f32],
) {
    let features = norm_weight.len() as f32;
    let beta = S::f32s::splat(simd, sigmoid(simd, logit(simd, attended, skip, gate)));
    let mean = mix(simd, beta, attended, skip, output) / features;
    let variance = squares(simd, mean, output) / features;
    normalise(simd, mean, 1.0 / (variance + EPSILON).sqrt(), [norm_weight, norm_bias], output);
}

/// `w_g · [ĥ ; r ; ĥ - r]`, as (w1 + w3) · ĥ + (w2 - w3) · r: the difference is never made.
#[inline(always)]
fn logit<S: Simd>(simd: S, attended: &[f32], skip: &[f32], gate: &[f32]) -> f32 {
    let (lanes, features) = (S::f32s::LEN, attended.len());
    let whole = features / lanes * lanes;
    let [mut first, mut second] = [S::f32s::splat(simd, 0.0); 2];
    for at in (0..whole).step_by(lanes) {
        let load = |slice: &[f32], at: usize| S::f32s::from_slice(simd, &slice[at..at + lanes]);
        let difference = load(gate, 2 * features + at);
        first = load(attended, at).mul_add(load(gate, at) + difference, first);
        second = load(skip, at).mul_add(load(gate, features + at) - difference, second);
    }
    let mut sum = (first + second).reduce_sum();
    for at in whole..features {
        let difference = gate[2 * features + at];
        sum += attended[at] * (gate[at] + difference) + skip[at] * (gate[features + at] - difference);
    }
    sum
}

/// `1 / (1 + e^-x)`, by an exponential of what is not above zero, as [`exp`] wants it.
#[inline(always)]
fn sigmoid<S: Simd>(simd: S, x: f32) -> f32 {
    let power = exp(simd, S::f32s::splat(simd, -x.abs())).as_slice()[0];
    if x < 0.0 { power / (1.0 + power) } else { 1.0 / (1.0 + power) }
}

/// output = ĥ + β (r - ĥ); its sum.
#[inline(always)]
fn mix<S: Simd>(simd: S, beta: S::f32s, attended: &[f32], skip: &[f32], output: &mut [f32]) -> f32 {
    let lanes = S::f32s::LEN;
    let whole = output.len() / lanes * lanes;
    let mut sum = S::f32s::splat(simd, 0.0);
    for at in (0..whole).step_by(lanes) {
        let load = |slice: &[f32]| S::f32s::from_slice(simd, &slice[at..at + lanes]);
        let attended = load(attended);
        let mixed = beta.mul_add(load(skip) - attended, attended);
        mixed.store_slice(&mut output[at..at + lanes]);
        sum += mixed;
    }
    let mut sum = sum.reduce_sum();
    for at in whole..output.len() {
        output[at] = attended[at] + beta.as_slice()[0] * (skip[at] - attended[at]);
        sum += output[at];
    }
    sum
}

/// `Σ (x - mean)²`.
#[inline(always)]
fn squares<S: Simd>(simd: S, mean: f32, values: &[f32]) -> f32 {
    let mut chunks = values.chunks_exact(S::f32s::LEN);
    let (mut sum, means) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, mean));
    for chunk in chunks.by_ref() {
        let difference = S::f32s::from_slice(simd, chunk) - means;
        sum = difference.mul_add(difference, sum);
    }
    sum.reduce_sum() + chunks.remainder().iter().map(|value| (value - mean) * (value - mean)).sum::<f32>()
}

/// output = max(0, weight · (output - mean) · scale + bias).
#[inline(always)]
fn normalise<S: Simd>(simd: S, mean: f32, scale: f32, [weight, bias]: [&[f32]; 2], output: &mut [f32]) {
    let lanes = S::f32s::LEN;
    let (means, factor, zero) = (S::f32s::splat(simd, mean), S::f32s::splat(simd, scale), S::f32s::splat(simd, 0.0));
    let whole = output.len() / lanes * lanes;
    for at in (0..whole).step_by(lanes) {
        let load = |slice: &[f32]| S::f32s::from_slice(simd, &slice[at..at + lanes]);
        let value = ((load(output) - means) * factor).mul_add(load(weight), load(bias));
        value.simd_gt(zero).select(value, zero).store_slice(&mut output[at..at + lanes]);
    }
    for at in whole..output.len() {
        output[at] = ((output[at] - mean) * scale * weight[at] + bias[at]).max(0.0);
    }
}

/// ĥ, r, `w_g`, LayerNorm's weight and bias -> h of one vertex, by definition.
#[cfg(feature = "suite")]
pub(super) fn truth(attended: &[f64], skip: &[f64], gate: &[f32], weight: &[f32], bias: &[f32]) -> Vec<f64> {
    let difference: Vec<f64> = attended.iter().zip(skip).map(|(attended, skip)| attended - skip).collect();
    let joined = attended.iter().chain(skip).chain(&difference);
    let beta = 1.0 / (1.0 + (-joined.zip(gate).map(|(x, w)| x * f64::from(*w)).sum::<f64>()).exp());
    let mixed: Vec<f64> = attended.iter().zip(skip).map(|(a, r)| (1.0 - beta) * a + beta * r).collect();
    let count = mixed.len() as f64;
    let mean = mixed.iter().sum::<f64>() / count;
    let variance = mixed.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    let normed = mixed.iter().map(|x| (x - mean) / (variance + f64::from(EPSILON)).sqrt());
    normed.zip(weight.iter().zip(bias)).map(|(x, (w, b))| (x * f64::from(*w) + f64::from(*b)).max(0.0)).collect()
}
