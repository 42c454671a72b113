//! `ĥ_i = concat_c Σ_j α_ij (v_c + ε_c)`, `α = softmax_j(q_c · (k_c + ε_c) / √d)`; then gate and LayerNorm, while ĥ_i
//! is at hand. network.md §3.
//! The edge features are differences, so `ε_ij = U_j - U_i` with `U = W_e potentials`: U_i drops out of the softmax and
//! is taken off ĥ_i once, since Σ_j α_ij = 1. That is exact, and saves a product per edge.

use super::exp::exp;
use super::gate::gate;
use super::heads;
use crate::cpu::vector::{axpy, dot, room};
use crate::cpu::{Cpu, Kernel};
use crate::operation::Attend;
use crate::topology::Graph;
use fearless_simd::{Simd, SimdBase, SimdFloat, dispatch};

/// Room for one vertex.
#[derive(Default)]
pub struct Scratch {
    heads: heads::Scratch,
    /// [C, edges].
    scores: Vec<f32>,
}

/// What is only read.
#[derive(Clone, Copy)]
struct Read<'a> {
    graph: Graph<&'a [u32]>,
    heads: usize,
    potentials: &'a [[f32; 6]],
    edge: &'a [f32],
    gate: &'a [f32],
    norm_weight: &'a [f32],
    norm_bias: &'a [f32],
}

/// Leaves projected as q | k + U | v + U | r, where a vertex has neighbours.
impl Kernel for Attend<&[f32], &mut [f32], &[u32]> {
    fn run(self, cpu: &mut Cpu) {
        let Attend { offsets, neighbours, heads, potentials, edge, gate, norm_weight, norm_bias, .. } = self;
        let (graph, potentials) = (Graph { offsets, neighbours }, potentials.as_chunks::<6>().0);
        let read = &Read { graph, heads, potentials, edge, gate, norm_weight, norm_bias };
        let (Attend { projected, attended, output, .. }, level) = (self, cpu.level);
        if cpu.threads.count() == 1 {
            let scratch = &mut cpu.scratch[0].attend;
            return dispatch!(level, simd => in_turn(simd, read, projected, scratch, attended, output));
        }
        // Before all: a neighbour may be another thread's.
        cpu.threads.share(potentials.len(), [&mut *projected], &mut cpu.scratch, |rows, [projected], _| {
            dispatch!(level, simd => fold(simd, edge, &potentials[rows], projected));
        });
        let projected = &*projected;
        cpu.threads.share(
            potentials.len(),
            [attended, output],
            &mut cpu.scratch,
            |rows, [attended, output], scratch| {
                let (scratch, first) = (&mut scratch.attend, rows.start);
                dispatch!(level, simd => part(simd, read, first, projected, scratch, attended, output));
            },
        );
    }
}

/// All vertices, in one pass over memory: neighbours are near by, so what is folded no earlier than needed is read from
/// the cache again.
#[inline(always)]
fn in_turn<S: Simd>(
    simd: S,
    read: &Read,
    projected: &mut [f32],
    scratch: &mut Scratch,
    attended: &mut [f32],
    output: &mut [f32],
) {
    let features = read.norm_bias.len();
    let rows = attended.chunks_exact_mut(features).zip(output.chunks_exact_mut(features));
    let mut folded = 0;
    for (i, (attended, output)) in rows.enumerate() {
        if let Some(last) = read.graph.of(i).last() {
            for j in folded..=*last as usize {
                let (key, value) = projected[(4 * j + 1) * features..][..2 * features].split_at_mut(features);
                add_edge(simd, 1.0, read.edge, &read.potentials[j], [key, value]);
            }
            folded = folded.max(*last as usize + 1);
        }
        vertex(simd, read, i, projected, scratch, attended, output);
    }
}

/// The vertices from `first`, of folded rows.
#[inline(always)]
fn part<S: Simd>(
    simd: S,
    read: &Read,
    first: usize,
    projected: &[f32],
    scratch: &mut Scratch,
    attended: &mut [f32],
    output: &mut [f32],
) {
    let features = read.norm_bias.len();
    let rows = attended.chunks_exact_mut(features).zip(output.chunks_exact_mut(features));
    for (i, (attended, output)) in rows.enumerate() {
        vertex(simd, read, first + i, projected, scratch, attended, output);
    }
}

/// k + U | v + U of some vertices.
#[inline(always)]
fn fold<S: Simd>(simd: S, edge: &[f32], potentials: &[[f32; 6]], projected: &mut [f32]) {
    let features = edge.len() / 6;
    for (potential, projected) in potentials.iter().zip(projected.chunks_exact_mut(4 * features)) {
        let (key, value) = projected[features..3 * features].split_at_mut(features);
        add_edge(simd, 1.0, edge, potential, [key, value]);
    }
}

/// ĥ and h of one vertex.
#[inline(always)]
fn vertex<S: Simd>(
    simd: S,
    read: &Read,
    i: usize,
    projected: &[f32],
    scratch: &mut Scratch,
    attended: &mut [f32],
    output: &mut [f32],
) {
    let (of, features) = ((i, read.graph.of(i)), attended.len());
    let d = features / read.heads;
    attended.fill(0.0);
    if !of.1.is_empty() {
        let suits = heads::suits::<S>(read.heads, d);
        // A length known to the compiler spares the loops over one or two vectors: the whole takes half the time.
        match d {
            8 if suits => heads::attend::<S, 8>(simd, of, projected, &mut scratch.heads, attended),
            16 if suits => heads::attend::<S, 16>(simd, of, projected, &mut scratch.heads, attended),
            32 if suits => heads::attend::<S, 32>(simd, of, projected, &mut scratch.heads, attended),
            64 if suits => heads::attend::<S, 64>(simd, of, projected, &mut scratch.heads, attended),
            _ => attend(simd, of, d, projected, &mut scratch.scores, attended),
        }
        add_edge(simd, -1.0, read.edge, &read.potentials[i], [attended]);
    }
    let skip = &projected[(i * 4 + 3) * features..][..features];
    gate(simd, attended, skip, read.gate, read.norm_weight, read.norm_bias, output);
}

/// y += sign · `W_e` potential, of one vertex, for each y [F].
#[cfg_attr(target_arch = "wasm32", inline(never))]
#[cfg_attr(not(target_arch = "wasm32"), inline(always))]
fn add_edge<S: Simd, const N: usize>(simd: S, sign: f32, edge: &[f32], potential: &[f32; 6], y: [&mut [f32]; N]) {
    let (lanes, features) = (S::f32s::LEN, edge.len() / 6);
    let whole = features / lanes * lanes;
    let mut scales = [S::f32s::splat(simd, 0.0); 6];
    for p in 0..6 {
        scales[p] = S::f32s::splat(simd, sign * potential[p]);
    }
    for at in (0..whole).step_by(lanes) {
        let mut sum = S::f32s::splat(simd, 0.0);
        for p in 0..6 {
            sum = scales[p].mul_add(S::f32s::from_slice(simd, &edge[p * features + at..][..lanes]), sum);
        }
        for n in 0..N {
            (S::f32s::from_slice(simd, &y[n][at..at + lanes]) + sum).store_slice(&mut y[n][at..at + lanes]);
        }
    }
    for at in whole..features {
        let sum = (0..6).map(|p| potential[p] * edge[p * features + at]).sum::<f32>();
        for n in 0..N {
            y[n][at] += sign * sum;
        }
    }
}

/// `Σ_j α_ij v_j` of a vertex that has neighbours, added to zeros; d features per head, of any number.
#[cfg_attr(target_arch = "wasm32", inline(never))]
#[cfg_attr(not(target_arch = "wasm32"), inline(always))]
fn attend<S: Simd>(
    simd: S,
    (i, neighbours): (usize, &[u32]),
    d: usize,
    projected: &[f32],
    scores: &mut Vec<f32>,
    attended: &mut [f32],
) {
    let (features, edges) = (attended.len(), neighbours.len().next_multiple_of(S::f32s::LEN));
    let part = |j: usize, part: usize| projected[(j * 4 + part) * features..][..features].chunks_exact(d);
    let scores = room(scores, features / d * edges);
    scores.fill(f32::MIN);
    for (e, j) in neighbours.iter().enumerate() {
        for (c, (query, key)) in part(i, 0).zip(part(*j as usize, 1)).enumerate() {
            scores[c * edges + e] = dot(simd, query, key);
        }
    }
    let scale = 1.0 / (d as f32).sqrt();
    for scores in scores.chunks_exact_mut(edges) {
        softmax(simd, scale, scores);
    }
    for (e, j) in neighbours.iter().enumerate() {
        for (c, (value, attended)) in part(*j as usize, 2).zip(attended.chunks_exact_mut(d)).enumerate() {
            axpy(simd, scores[c * edges + e], value, attended);
        }
    }
}

/// Softmax of scores, times `scale` first. Whole vectors: those that fill it up are `f32::MIN`, and as good as zero
/// afterwards.
#[inline(always)]
pub fn softmax<S: Simd>(simd: S, scale: f32, scores: &mut [f32]) {
    let lanes = S::f32s::LEN;
    let scale = S::f32s::splat(simd, scale);
    let mut largest = S::f32s::splat(simd, f32::MIN);
    // No `fold`: the compiler leaves it outside, where SIMD is slow.
    for scores in scores.chunks_exact(lanes) {
        largest = largest.max(S::f32s::from_slice(simd, scores));
    }
    let largest = S::f32s::splat(simd, largest.reduce_max());
    let mut total = S::f32s::splat(simd, 0.0);
    for scores in scores.chunks_exact_mut(lanes) {
        let power = exp(simd, (S::f32s::from_slice(simd, scores) - largest) * scale);
        power.store_slice(scores);
        total += power;
    }
    let share = S::f32s::splat(simd, 1.0 / total.reduce_sum());
    for scores in scores.chunks_exact_mut(lanes) {
        (S::f32s::from_slice(simd, scores) * share).store_slice(scores);
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
        let small = [[1, 1, 1], [2, 1, 3], [5, 2, 4], [24, 2, 8]];
        let large = [[67, 4, 16], [99, 2, 32], [67, 2, 64], [67, 3, 5], [130, 2, 33], [99, 70, 1], [50, 1, 130]];
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
        small.into_iter().chain(large).map(&mut operand).collect()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let [projected, potentials, edge] =
            [&self.projected, &self.potentials, &self.edge].map(|values| crate::suite::wide(values));
        let (features, n) = (self.norm_bias.len(), self.offsets.len() - 1);
        let d = features / self.heads;
        // Column `f` of part q, k, v or r of vertex `i`; ε_ij.
        let part = |i: usize, part: usize, f: usize| projected[(4 * i + part) * features + f];
        let difference = |i: usize, j: usize, c: usize| potentials[6 * j + c] - potentials[6 * i + c];
        let term = |i, j, f| -> f64 { (0..6).map(|c| difference(i, j, c) * edge[c * features + f]).sum() };
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
