//! The gate and LayerNorm backwards: `z = ĥ + β (r - ĥ)`, `β = sigmoid(w_g · [ĥ ; r ; ĥ - r])`, `h = ReLU(γ (z - μ)/σ + b)`.

use ctsn_core::cpu::Level;
use ctsn_core::cpu::gate::EPSILON;
use ctsn_core::cpu::vector::{axpy, dot};
use fearless_simd::{Simd, dispatch};

/// What the forward operation read and wrote.
pub struct Inputs<'a> {
    /// ĥ [n, F].
    pub attended: &'a [f32],
    /// q | k | v | r [n, 4F].
    pub projected: &'a [f32],
    /// `w_g` [3F].
    pub gate: &'a [f32],
    /// LayerNorm weight [F].
    pub norm_weight: &'a [f32],
    /// h [n, F].
    pub output: &'a [f32],
}

/// g [n, F] -> dattended [n, F], dprojected [n, 4F] (r columns), dgate [3F], dnorm weight and bias [F].
pub fn gate(level: Level, inputs: &Inputs, g: &[f32], targets: [&mut [f32]; 5]) {
    dispatch!(level, simd => kernel(simd, inputs, g, targets));
}

#[inline(always)]
fn kernel<S: Simd>(simd: S, inputs: &Inputs, g: &[f32], targets: [&mut [f32]; 5]) {
    let [dattended, dprojected, dgate, dnorm_weight, dnorm_bias] = targets;
    let features = inputs.norm_weight.len();
    let mut difference = vec![0.0; features];
    let mut z = vec![0.0; features];
    let mut dz = vec![0.0; features];
    for (i, g) in g.chunks_exact(features).enumerate() {
        let attended = &inputs.attended[i * features..][..features];
        let skip = &inputs.projected[(i * 4 + 3) * features..][..features];
        let output = &inputs.output[i * features..][..features];
        (0..features).for_each(|c| difference[c] = attended[c] - skip[c]);
        let [w_attended, w_skip, w_difference] = [0, 1, 2].map(|part| &inputs.gate[part * features..][..features]);
        let logit = dot(simd, w_attended, attended) + dot(simd, w_skip, skip) + dot(simd, w_difference, &difference);
        let beta = 1.0 / (1.0 + (-logit).exp());
        (0..features).for_each(|c| z[c] = attended[c] - beta * difference[c]);
        normalise(&mut z, &mut dz, inputs.norm_weight, output, g, dnorm_weight, dnorm_bias);
        // β falls on the difference: dβ = -dz · (ĥ - r).
        let dlogit = -dot(simd, &dz, &difference) * beta * (1.0 - beta);
        for (part, x) in [attended, skip, &difference].into_iter().enumerate() {
            axpy(simd, dlogit, x, &mut dgate[part * features..][..features]);
        }
        let dattended = &mut dattended[i * features..][..features];
        let dskip = &mut dprojected[(i * 4 + 3) * features..][..features];
        for c in 0..features {
            dattended[c] += (1.0 - beta) * dz[c] + dlogit * (w_attended[c] + w_difference[c]);
            dskip[c] += beta * dz[c] + dlogit * (w_skip[c] - w_difference[c]);
        }
    }
}

/// LayerNorm and ReLU of one row backwards: z becomes (z - μ)/σ, dz its gradient.
#[inline(always)]
fn normalise(
    z: &mut [f32],
    dz: &mut [f32],
    weight: &[f32],
    output: &[f32],
    g: &[f32],
    dweight: &mut [f32],
    dbias: &mut [f32],
) {
    let count = z.len() as f32;
    let mean = z.iter().sum::<f32>() / count;
    let variance = z.iter().map(|z| (z - mean) * (z - mean)).sum::<f32>() / count;
    let inverse = 1.0 / (variance + EPSILON).sqrt();
    let (mut sum, mut product) = (0.0, 0.0);
    for c in 0..z.len() {
        z[c] = (z[c] - mean) * inverse;
        let g = if output[c] > 0.0 { g[c] } else { 0.0 };
        dweight[c] += g * z[c];
        dbias[c] += g;
        dz[c] = g * weight[c];
        sum += dz[c];
        product += dz[c] * z[c];
    }
    for c in 0..z.len() {
        dz[c] = inverse * (dz[c] - sum / count - z[c] * product / count);
    }
}
