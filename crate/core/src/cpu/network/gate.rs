//! `β = sigmoid(w_g · [ĥ ; r ; ĥ - r])`, `h = ReLU(LayerNorm((1-β) ĥ + β r))`, eps 1e-5. network.md §3.

use crate::cpu::vector::{dot, sum};
use fearless_simd::{Simd, SimdBase, SimdFloat};

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
    let features = norm_weight.len();
    let (gate_attended, rest) = gate.split_at(features);
    let (gate_skip, gate_difference) = rest.split_at(features);
    // w3 · (ĥ - r) is split in two products; the difference is never stored.
    let logit = dot(simd, gate_attended, attended) + dot(simd, gate_skip, skip) + dot(simd, gate_difference, attended)
        - dot(simd, gate_difference, skip);
    let beta = 1.0 / (1.0 + (-logit).exp());
    for ((output, attended), skip) in output.iter_mut().zip(attended).zip(skip) {
        *output = attended + beta * (skip - attended);
    }
    let mean = sum(simd, output) / features as f32;
    output.iter_mut().for_each(|value| *value -= mean);
    let variance = dot(simd, output, output) / features as f32;
    normalise(simd, 1.0 / (variance + EPSILON).sqrt(), norm_weight, norm_bias, output);
}

/// output = max(0, weight · output · scale + bias).
#[inline(always)]
fn normalise<S: Simd>(simd: S, scale: f32, weight: &[f32], bias: &[f32], output: &mut [f32]) {
    let lanes = S::f32s::LEN;
    let (factor, zero) = (S::f32s::splat(simd, scale), S::f32s::splat(simd, 0.0));
    let whole = output.len() / lanes * lanes;
    for at in (0..whole).step_by(lanes) {
        let load = |slice: &[f32]| S::f32s::from_slice(simd, &slice[at..at + lanes]);
        let value = (load(output) * factor).mul_add(load(weight), load(bias));
        value.max(zero).store_slice(&mut output[at..at + lanes]);
    }
    for at in whole..output.len() {
        output[at] = (output[at] * scale * weight[at] + bias[at]).max(0.0);
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
