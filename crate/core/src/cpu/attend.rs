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
    /// `k + U | v + U | U` per vertex [n, 3F].
    nodes: Vec<f32>,
    /// Scores of one vertex [C, degree].
    scores: Vec<f32>,
}

/// projected [n, 4F] = q | k | v | r, potentials [n, 6], edge `W_eᵀ` [6, F] -> attended [n, F].
#[expect(clippy::too_many_arguments, reason = "an operation takes its operands plainly, as its shader does")]
pub fn attend(
    level: Level,
    graph: &Graph<Vec<u32>>,
    heads: usize,
    projected: &[f32],
    potentials: &[f32],
    edge: &[f32],
    scratch: &mut Scratch,
    attended: &mut [f32],
) {
    dispatch!(level, simd => {
        fold(simd, projected, potentials, edge, &mut scratch.nodes);
        kernel(simd, graph, heads, projected, &scratch.nodes, &mut scratch.scores, attended);
    });
}

/// Moves the edge term into the nodes: projected, potentials -> `k + U | v + U | U`.
#[inline(always)]
pub fn fold<S: Simd>(simd: S, projected: &[f32], potentials: &[f32], edge: &[f32], nodes: &mut Vec<f32>) {
    let features = edge.len() / 6;
    nodes.resize(projected.len() / 4 * 3, 0.0);
    let rows = projected.chunks_exact(4 * features).zip(potentials.as_chunks::<6>().0);
    for (node, (projected, potential)) in nodes.chunks_exact_mut(3 * features).zip(rows) {
        let (key_value, u) = node.split_at_mut(2 * features);
        u.fill(0.0);
        for (edge, potential) in edge.chunks_exact(features).zip(potential) {
            axpy(simd, *potential, edge, u);
        }
        key_value.copy_from_slice(&projected[features..3 * features]);
        key_value.chunks_exact_mut(features).for_each(|half| axpy(simd, 1.0, u, half));
    }
}

#[inline(always)]
fn kernel<S: Simd>(
    simd: S,
    graph: &Graph<Vec<u32>>,
    heads: usize,
    projected: &[f32],
    nodes: &[f32],
    scores: &mut Vec<f32>,
    attended: &mut [f32],
) {
    let features = attended.len() / (graph.offsets.len() - 1);
    let d = features / heads;
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
            let key = &nodes[*j as usize * 3 * features..][..features];
            for (c, (query, key)) in query.chunks_exact(d).zip(key.chunks_exact(d)).enumerate() {
                scores[c * degree + e] = dot(simd, query, key) * scale;
            }
        }
        softmax(simd, scores, degree);
        for (e, j) in neighbours.iter().enumerate() {
            let value = &nodes[(*j as usize * 3 + 1) * features..][..features];
            for (c, (value, output)) in value.chunks_exact(d).zip(output.chunks_exact_mut(d)).enumerate() {
                axpy(simd, scores[c * degree + e], value, output);
            }
        }
        axpy(simd, -1.0, &nodes[(i * 3 + 2) * features..][..features], output);
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
