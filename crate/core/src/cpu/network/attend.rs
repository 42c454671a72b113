//! `ĥ_i = concat_c Σ_j α_ij (v_c + ε_c)`, `α = softmax_j(q_c · (k_c + ε_c) / √d)`. network.md §3.
//! The edge features are differences, so `ε_ij = U_j - U_i` with `U = W_e potentials`: U_i drops out of the softmax and
//! is taken off ĥ_i once, since Σ_j α_ij = 1. That is exact, and saves a product per edge.

use super::exp::exp;
use super::gate::gate;
use crate::cpu::vector::{axpy, dot};
use crate::cpu::{Cpu, Kernel};
use crate::operation::Attend;
use crate::topology::Graph;
use fearless_simd::{Simd, dispatch};

/// Room for one call.
#[derive(Default)]
pub struct Scratch {
    /// U per vertex [n, F].
    edges: Vec<f32>,
    /// Scores of one vertex [C, degree].
    scores: Vec<f32>,
}

/// Leaves projected as q | k + U | v + U | r.
impl Kernel for Attend<&[f32], &mut [f32], &[u32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { offsets, neighbours, heads, projected, potentials, edge, attended, output, .. } = self;
        let (graph, scratch) = (Graph { offsets, neighbours }, &mut cpu.scratch);
        scratch.edges.resize(attended.len(), 0.0);
        dispatch!(cpu.level, simd => {
            fold(simd, projected, potentials, edge, &mut scratch.edges);
            // A length known to the compiler spares the loops over one or two vectors: the whole takes half the time.
            match attended.len() / (offsets.len() - 1).max(1) / heads {
                8 => kernel::<_, 8>(simd, graph, heads, projected, scratch, attended),
                16 => kernel::<_, 16>(simd, graph, heads, projected, scratch, attended),
                32 => kernel::<_, 32>(simd, graph, heads, projected, scratch, attended),
                _ => kernel::<_, 0>(simd, graph, heads, projected, scratch, attended),
            }
        });
        let (gate_weight, norm_weight, norm_bias) = (self.gate, self.norm_weight, self.norm_bias);
        dispatch!(cpu.level, simd => gate(simd, attended, projected, gate_weight, norm_weight, norm_bias, output));
    }
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
    graph: Graph<&[u32]>,
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

#[cfg(feature = "suite")]
impl crate::suite::Suite for Attend<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// LayerNorm divides by the deviation of the features, which may be a tenth of them: ten times what sums of order
    /// one are off by.
    const TOLERANCE: f64 = 1e-4;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        // Vertices, heads, features per head: lengths known to the kernel and others; more heads than lanes; a head
        // wider than a workgroup.
        let shapes = [
            [1, 1, 1],
            [2, 1, 3],
            [5, 2, 4],
            [24, 2, 8],
            [67, 4, 16],
            [99, 2, 32],
            [67, 3, 5],
            [130, 2, 33],
            [99, 70, 1],
            [50, 1, 130],
        ];
        let mut operand = |[n, heads, per_head]: [usize; 3]| {
            let (features, triangles) = (heads * per_head, crate::suite::triangles(rng, n));
            let Graph { offsets, neighbours } = Graph::new(n, &triangles);
            let mut numbers = |count: usize, scale: f32| crate::suite::numbers(rng, count, scale);
            Self {
                offsets,
                neighbours,
                heads,
                projected: numbers(n * 4 * features, 1.0),
                potentials: numbers(n * 6, 2.0),
                edge: numbers(6 * features, 0.3),
                gate: numbers(3 * features, 0.3),
                norm_weight: numbers(features, 0.5).iter().map(|weight| 1.0 + weight).collect(),
                norm_bias: numbers(features, 0.3),
                attended: vec![0.0; n * features],
                output: vec![0.0; n * features],
            }
        };
        shapes.map(&mut operand).into()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let [projected, potentials, edge] =
            [&self.projected, &self.potentials, &self.edge].map(|values| crate::suite::wide(values));
        let (features, n) = (self.norm_bias.len(), self.offsets.len() - 1);
        let d = features / self.heads;
        // Column `f` of part q, k, v or r of vertex `i`; ε_ij.
        let part = |i: usize, part: usize, f: usize| projected[(4 * i + part) * features + f];
        let term = |i: usize, j: usize, f: usize| -> f64 {
            (0..6).map(|c| (potentials[6 * j + c] - potentials[6 * i + c]) * edge[c * features + f]).sum()
        };
        let mut output = Vec::new();
        for i in 0..n {
            let neighbours = &self.neighbours[self.offsets[i] as usize..self.offsets[i + 1] as usize];
            let score = |j: usize, c: usize| -> f64 {
                let product = |f: usize| part(i, 0, f) * (part(j, 1, f) + term(i, j, f));
                ((c * d..(c + 1) * d).map(product).sum::<f64>() / (d as f64).sqrt()).exp()
            };
            let attended = |f: usize| -> f64 {
                let scores: Vec<f64> = neighbours.iter().map(|j| score(*j as usize, f / d)).collect();
                let values = neighbours.iter().map(|j| part(*j as usize, 2, f) + term(i, *j as usize, f));
                let sum: f64 = scores.iter().zip(values).map(|(score, value)| score * value).sum();
                if neighbours.is_empty() { 0.0 } else { sum / scores.iter().sum::<f64>() }
            };
            let attended: Vec<f64> = (0..features).map(attended).collect();
            let skip: Vec<f64> = (0..features).map(|f| part(i, 3, f)).collect();
            output.extend(super::gate::truth(&attended, &skip, &self.gate, &self.norm_weight, &self.norm_bias));
        }
        // Devices may leave the edge term in q | k | v | r, and ĥ unwritten.
        vec![None, None, Some(output)]
    }
}
