//! `ĥ_i = concat_c Σ_j α_ij (v_c + ε_c)`, `α = softmax_j(q_c · (k_c + ε_c) / √d)`. network.md §3.
//! The edge features are differences, so `ε_ij = U_j - U_i` with `U = W_e potentials`: U_i drops out of the softmax and is
//! taken off ĥ_i once, since Σ_j α_ij = 1. That is exact, and saves a product per edge.

use super::exp::exp;
use super::vector::{axpy, dot};
use crate::topology::Graph;
use fearless_simd::{Level, Simd, dispatch};

/// Room for one call.
#[derive(Default)]
pub struct Scratch {
    /// U per vertex [n, F].
    edges: Vec<f32>,
    /// Scores of one vertex [C, degree].
    scores: Vec<f32>,
}

/// projected [n, 4F] = q | k | v | r, potentials [n, 6], edge `W_eᵀ` [6, F] -> attended [n, F];
/// projected becomes q | k + U | v + U | r.
#[expect(clippy::too_many_arguments, reason = "an operation takes its operands plainly, as its shader does")]
pub fn attend(
    level: Level,
    graph: &Graph<Vec<u32>>,
    heads: usize,
    projected: &mut [f32],
    potentials: &[f32],
    edge: &[f32],
    scratch: &mut Scratch,
    attended: &mut [f32],
) {
    scratch.edges.resize(attended.len(), 0.0);
    dispatch!(level, simd => {
        fold(simd, projected, potentials, edge, &mut scratch.edges);
        // A length known to the compiler spares the loops over one or two vectors: the whole takes half the time.
        match attended.len() / (graph.offsets.len() - 1).max(1) / heads {
            8 => kernel::<_, 8>(simd, graph, heads, projected, scratch, attended),
            16 => kernel::<_, 16>(simd, graph, heads, projected, scratch, attended),
            32 => kernel::<_, 32>(simd, graph, heads, projected, scratch, attended),
            _ => kernel::<_, 0>(simd, graph, heads, projected, scratch, attended),
        }
    });
}

/// Moves the edge term into the nodes: `U = W_e potentials`, added to k and v.
#[inline(always)]
fn fold<S: Simd>(simd: S, projected: &mut [f32], potentials: &[f32], edge: &[f32], edges: &mut [f32]) {
    let features = edge.len() / 6;
    let rows = projected.chunks_exact_mut(4 * features).zip(potentials.as_chunks::<6>().0);
    for (u, (projected, potential)) in edges.chunks_exact_mut(features).zip(rows) {
        u.fill(0.0);
        for (edge, potential) in edge.chunks_exact(features).zip(potential) {
            axpy(simd, *potential, edge, u);
        }
        let key_value = projected[features..3 * features].chunks_exact_mut(features);
        key_value.for_each(|half| axpy(simd, 1.0, u, half));
    }
}

/// D: features per head where they are known, else 0.
#[inline(always)]
fn kernel<S: Simd, const D: usize>(
    simd: S,
    graph: &Graph<Vec<u32>>,
    heads: usize,
    projected: &[f32],
    scratch: &mut Scratch,
    attended: &mut [f32],
) {
    let Scratch { edges, scores } = scratch;
    let features = attended.len() / (graph.offsets.len() - 1);
    let d = if D > 0 { D } else { features / heads };
    let scale = 1.0 / (d as f32).sqrt();
    for (i, output) in attended.chunks_exact_mut(features).enumerate() {
        let (query, neighbours) = (&projected[i * 4 * features..][..features], graph.of(i));
        output.fill(0.0);
        let degree = neighbours.len();
        if degree == 0 {
            continue;
        }
        scores.resize(scores.len().max(heads * degree), 0.0);
        let scores = &mut scores[..heads * degree];
        for (e, j) in neighbours.iter().enumerate() {
            let key = &projected[(*j as usize * 4 + 1) * features..][..features];
            for (c, (query, key)) in query.chunks_exact(d).zip(key.chunks_exact(d)).enumerate() {
                scores[c * degree + e] = dot(simd, query, key) * scale;
            }
        }
        softmax(simd, scores, degree);
        for (e, j) in neighbours.iter().enumerate() {
            let value = &projected[(*j as usize * 4 + 2) * features..][..features];
            for (c, (value, output)) in value.chunks_exact(d).zip(output.chunks_exact_mut(d)).enumerate() {
                axpy(simd, scores[c * degree + e], value, output);
            }
        }
        axpy(simd, -1.0, &edges[i * features..][..features], output);
    }
}

/// Softmax of each row of `degree` scores.
#[inline(always)]
pub fn softmax<S: Simd>(simd: S, scores: &mut [f32], degree: usize) {
    for row in scores.chunks_exact_mut(degree) {
        let largest = row.iter().copied().fold(f32::MIN, f32::max);
        row.iter_mut().for_each(|score| *score -= largest);
    }
    exp(simd, scores);
    for row in scores.chunks_exact_mut(degree) {
        let total: f32 = row.iter().sum();
        row.iter_mut().for_each(|score| *score /= total);
    }
}
