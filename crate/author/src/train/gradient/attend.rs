//! Attention backwards, with the edge term in the nodes (`k' = k + U`, `v' = v + U`, see the forward operation):
//! `dα_j = g·v'_j`, `ds = α (dα - Σ α dα) / √d`, `dq = Σ ds k'`, `dk'_j += ds q`, `dv'_j += α g`, `dU = dk' + dv' - g`.

use ctsn_core::cpu::Level;
use ctsn_core::cpu::attend::softmax;
use ctsn_core::cpu::vector::{axpy, dot};
use ctsn_core::topology::Graph;
use fearless_simd::{Simd, dispatch};

/// What the forward operation read.
pub struct Inputs<'a> {
    /// Neighbours.
    pub graph: &'a Graph<Vec<u32>>,
    /// C.
    pub heads: usize,
    /// q | k' | v' | r [n, 4F], as the forward operation leaves it.
    pub projected: &'a [f32],
    /// [n, 6].
    pub potentials: &'a [f32],
}

/// Room for one call.
#[derive(Default)]
pub struct Scratch {
    alpha: Vec<f32>,
    dalpha: Vec<f32>,
    dpotential: Vec<f32>,
}

/// g [n, F] -> dprojected [n, 4F] (q, k, v columns), dedge [6, F].
pub fn attend(
    level: Level,
    inputs: &Inputs,
    g: &[f32],
    scratch: &mut Scratch,
    dprojected: &mut [f32],
    dedge: &mut [f32],
) {
    dispatch!(level, simd => {
        scratch.dpotential.clear();
        scratch.dpotential.resize(g.len(), 0.0);
        kernel(simd, inputs, g, scratch, dprojected);
        edges(simd, inputs, &scratch.dpotential, dedge);
    });
}

#[inline(always)]
fn kernel<S: Simd>(simd: S, inputs: &Inputs, g: &[f32], scratch: &mut Scratch, dprojected: &mut [f32]) {
    let features = g.len() / (inputs.graph.offsets.len() - 1);
    let d = features / inputs.heads;
    let Scratch { alpha, dalpha, dpotential } = scratch;
    let projected = inputs.projected;
    for (i, g) in g.chunks_exact(features).enumerate() {
        let neighbours = inputs.graph.of(i);
        if neighbours.is_empty() {
            continue;
        }
        let query = &projected[i * 4 * features..][..features];
        scores(simd, query, projected, g, neighbours, d, alpha, dalpha);
        axpy(simd, -1.0, g, &mut dpotential[i * features..][..features]);
        let degree = neighbours.len();
        for (e, j) in neighbours.iter().map(|j| *j as usize).enumerate() {
            for (c, at) in (0..features).step_by(d).enumerate() {
                let (alpha, ds) = (alpha[c * degree + e], dalpha[c * degree + e]);
                let (g, query) = (&g[at..at + d], &query[at..at + d]);
                let key = &projected[(j * 4 + 1) * features + at..][..d];
                axpy(simd, ds, key, &mut dprojected[i * 4 * features + at..][..d]);
                axpy(simd, ds, query, &mut dprojected[(j * 4 + 1) * features + at..][..d]);
                axpy(simd, alpha, g, &mut dprojected[(j * 4 + 2) * features + at..][..d]);
                let dpotential = &mut dpotential[j * features + at..][..d];
                axpy(simd, ds, query, dpotential);
                axpy(simd, alpha, g, dpotential);
            }
        }
    }
}

/// Attention of one vertex again, α [C, degree], and the gradient of its scores, `ds` [C, degree].
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "operands of one inner kernel")]
fn scores<S: Simd>(
    simd: S,
    query: &[f32],
    projected: &[f32],
    g: &[f32],
    neighbours: &[u32],
    d: usize,
    alpha: &mut Vec<f32>,
    dalpha: &mut Vec<f32>,
) {
    let (features, degree) = (query.len(), neighbours.len());
    let scale = 1.0 / (d as f32).sqrt();
    alpha.resize(features / d * degree, 0.0);
    dalpha.resize(features / d * degree, 0.0);
    for (e, j) in neighbours.iter().enumerate() {
        let key_value = &projected[(*j as usize * 4 + 1) * features..][..2 * features];
        for (c, at) in (0..features).step_by(d).enumerate() {
            alpha[c * degree + e] = dot(simd, &query[at..at + d], &key_value[at..at + d]) * scale;
            dalpha[c * degree + e] = dot(simd, &g[at..at + d], &key_value[features + at..][..d]);
        }
    }
    softmax(simd, alpha, degree);
    for (alpha, dalpha) in alpha.chunks_exact(degree).zip(dalpha.chunks_exact_mut(degree)) {
        let mean: f32 = alpha.iter().zip(&*dalpha).map(|(alpha, dalpha)| alpha * dalpha).sum();
        dalpha.iter_mut().zip(alpha).for_each(|(dalpha, alpha)| *dalpha = alpha * (*dalpha - mean) * scale);
    }
}

/// dedge [6, F] from dU [n, F]: `U = W_e potentials`.
#[inline(always)]
fn edges<S: Simd>(simd: S, inputs: &Inputs, dpotential: &[f32], dedge: &mut [f32]) {
    let features = dedge.len() / 6;
    for (potential, du) in inputs.potentials.as_chunks::<6>().0.iter().zip(dpotential.chunks_exact(features)) {
        for (potential, dedge) in potential.iter().zip(dedge.chunks_exact_mut(features)) {
            axpy(simd, *potential, du, dedge);
        }
    }
}
