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

/// Room for one vertex.
#[derive(Default)]
pub struct Scratch {
    alpha: Vec<f32>,
    dalpha: Vec<f32>,
}

/// g [n, F] -> dprojected [n, 4F] (q, k, v columns, zero before: nothing else reads them), dedge [6, F].
pub fn attend(
    level: Level,
    inputs: &Inputs,
    g: &[f32],
    scratch: &mut Scratch,
    dprojected: &mut [f32],
    dedge: &mut [f32],
) {
    dispatch!(level, simd => {
        // As in the forward operation, a length known to the compiler.
        match dedge.len() / 6 / inputs.heads {
            8 => kernel::<_, 8>(simd, inputs, g, scratch, dprojected),
            16 => kernel::<_, 16>(simd, inputs, g, scratch, dprojected),
            32 => kernel::<_, 32>(simd, inputs, g, scratch, dprojected),
            _ => kernel::<_, 0>(simd, inputs, g, scratch, dprojected),
        }
        edges(simd, inputs, g, dprojected, dedge);
    });
}

/// D: features per head where they are known, else 0.
#[inline(always)]
fn kernel<S: Simd, const D: usize>(simd: S, inputs: &Inputs, g: &[f32], scratch: &mut Scratch, dprojected: &mut [f32]) {
    let features = g.len() / (inputs.graph.offsets.len() - 1);
    let d = if D > 0 { D } else { features / inputs.heads };
    let Scratch { alpha, dalpha } = scratch;
    let projected = inputs.projected;
    for (i, g) in g.chunks_exact(features).enumerate() {
        let neighbours = inputs.graph.of(i);
        if neighbours.is_empty() {
            continue;
        }
        let query = &projected[i * 4 * features..][..features];
        let degree = neighbours.len();
        scores(simd, query, projected, g, neighbours, d, alpha, dalpha);
        for (e, j) in neighbours.iter().map(|j| *j as usize * 4 * features).enumerate() {
            let key = &projected[j + features..][..features];
            for (c, at) in (0..features).step_by(d).enumerate() {
                axpy(simd, dalpha[c * degree + e], &key[at..at + d], &mut dprojected[i * 4 * features + at..][..d]);
            }
            let (dkey, dvalue) = dprojected[j + features..][..2 * features].split_at_mut(features);
            for (c, at) in (0..features).step_by(d).enumerate() {
                axpy(simd, dalpha[c * degree + e], &query[at..at + d], &mut dkey[at..at + d]);
                axpy(simd, alpha[c * degree + e], &g[at..at + d], &mut dvalue[at..at + d]);
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

/// dedge [6, F] from `dU = dk' + dv' - g`: `U = W_e potentials`.
#[inline(always)]
fn edges<S: Simd>(simd: S, inputs: &Inputs, g: &[f32], dprojected: &[f32], dedge: &mut [f32]) {
    let features = dedge.len() / 6;
    let rows = dprojected.chunks_exact(4 * features).zip(g.chunks_exact(features));
    for (i, (potential, (dprojected, g))) in inputs.potentials.as_chunks::<6>().0.iter().zip(rows).enumerate() {
        // A vertex without neighbours has ĥ = 0, whatever its U.
        let own = if inputs.graph.of(i).is_empty() { 0.0 } else { -1.0 };
        for (potential, dedge) in potential.iter().zip(dedge.chunks_exact_mut(features)) {
            axpy(simd, *potential, &dprojected[features..2 * features], dedge);
            axpy(simd, *potential, &dprojected[2 * features..3 * features], dedge);
            axpy(simd, own * potential, g, dedge);
        }
    }
}
