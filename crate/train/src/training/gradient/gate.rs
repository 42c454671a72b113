//! The gate and LayerNorm backwards: `z = ĥ + β (r - ĥ)`, `β = sigmoid(w_g · [ĥ ; r ; ĥ - r])`,
//! `h = ReLU(γ (z - μ)/σ + b)`.

use ctsn_core::cpu::Level;
use ctsn_core::cpu::network::gate::EPSILON;
use ctsn_core::cpu::vector::{axpy, dot, sum};
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

/// g [n, F] -> dattended [n, F] and dprojected [n, 4F] (r columns), overwritten; dgate [3F], dnorm weight and bias [F].
pub fn gate(level: Level, inputs: &Inputs, g: &[f32], targets: [&mut [f32]; 5]) {
    dispatch!(level, simd => kernel(simd, inputs, g, targets));
}

#[inline(always)]
fn kernel<S: Simd>(simd: S, inputs: &Inputs, g: &[f32], targets: [&mut [f32]; 5]) {
    let [dattended, dprojected, dgate, dnorm_weight, dnorm_bias] = targets;
    let features = inputs.norm_weight.len();
    let [w_attended, w_skip, w_difference] = [0, 1, 2].map(|part| &inputs.gate[part * features..][..features]);
    let [mut difference, mut z, mut dz] = [(); 3].map(|()| vec![0.0; features]);
    for (i, g) in g.chunks_exact(features).enumerate() {
        let attended = &inputs.attended[i * features..][..features];
        let skip = &inputs.projected[(i * 4 + 3) * features..][..features];
        let output = &inputs.output[i * features..][..features];
        let pairs = difference.iter_mut().zip(attended).zip(skip);
        pairs.for_each(|((difference, attended), skip)| *difference = attended - skip);
        let logit = dot(simd, w_attended, attended) + dot(simd, w_skip, skip) + dot(simd, w_difference, &difference);
        let beta = 1.0 / (1.0 + (-logit).exp());
        z.copy_from_slice(attended);
        axpy(simd, -beta, &difference, &mut z);
        normalise(simd, &mut z, &mut dz, inputs.norm_weight, output, g, dnorm_weight, dnorm_bias);
        // β falls on the difference: dβ = -dz · (ĥ - r).
        let dlogit = -dot(simd, &dz, &difference) * beta * (1.0 - beta);
        for (part, x) in [attended, skip, &difference].into_iter().enumerate() {
            axpy(simd, dlogit, x, &mut dgate[part * features..][..features]);
        }
        let dattended = &mut dattended[i * features..][..features];
        let dskip = &mut dprojected[(i * 4 + 3) * features..][..features];
        for (target, share, own, sign) in [(dattended, 1.0 - beta, w_attended, 1.0), (dskip, beta, w_skip, -1.0)] {
            let parts = target.iter_mut().zip(&dz).zip(own.iter().zip(w_difference));
            parts.for_each(|((target, dz), (own, both))| *target = share * dz + dlogit * (own + sign * both));
        }
    }
}

/// LayerNorm and ReLU of one row backwards: z becomes (z - μ)/σ, dz its gradient.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "operands of one inner kernel")]
fn normalise<S: Simd>(
    simd: S,
    z: &mut [f32],
    dz: &mut [f32],
    weight: &[f32],
    output: &[f32],
    g: &[f32],
    dweight: &mut [f32],
    dbias: &mut [f32],
) {
    let count = z.len() as f32;
    let mean = sum(simd, z) / count;
    z.iter_mut().for_each(|z| *z -= mean);
    let inverse = 1.0 / (dot(simd, z, z) / count + EPSILON).sqrt();
    z.iter_mut().for_each(|z| *z *= inverse);
    let passed = dz.iter_mut().zip(output).zip(g);
    passed.for_each(|((dz, output), g)| *dz = if *output > 0.0 { *g } else { 0.0 });
    axpy(simd, 1.0, dz, dbias);
    dweight.iter_mut().zip(&*dz).zip(&*z).for_each(|((dweight, g), z)| *dweight += g * z);
    dz.iter_mut().zip(weight).for_each(|(dz, weight)| *dz *= weight);
    let (mean, along) = (sum(simd, dz) / count, dot(simd, dz, z) / count);
    dz.iter_mut().zip(&*z).for_each(|(dz, z)| *dz = inverse * (*dz - mean - z * along));
}
