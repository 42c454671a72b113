//! Attention backwards, with the edge term in the nodes (`k' = k + U`, `v' = v + U`, see the forward operation):
//! `dα_j = g·v'_j`, `ds = α (dα - Σ α dα) / √d`, `dq = Σ ds k'`, `dk'_j = Σ_i ds q_i`, `dv'_j = Σ_i α g_i`, `dU = dk' +
//! dv' - g`. First every vertex's own scores, then what it gives its neighbours, gathered: edges run both ways, so each
//! row is written once.

use ctsn_core::cpu::Level;
use ctsn_core::cpu::network::attend::softmax;
use ctsn_core::cpu::vector::{axpy, dot};
use ctsn_core::topology::Graph;
use fearless_simd::{Simd, SimdBase, dispatch};

/// What the forward operation read.
pub struct Inputs<'a> {
    /// Neighbours.
    pub graph: Graph<&'a [u32]>,
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
    /// α, then ds [edges, 2, C].
    edges: Vec<f32>,
    /// α and dα of one vertex [C, degree, rounded up to whole vectors].
    alpha: Vec<f32>,
    dalpha: Vec<f32>,
    /// dU of one vertex [F].
    du: Vec<f32>,
    /// Edges already visited per vertex.
    seen: Vec<u32>,
}

/// g [n, F] -> dprojected [n, 4F] (q, k, v columns, overwritten), dedge [6, F].
pub fn attend(
    level: Level,
    inputs: &Inputs,
    g: &[f32],
    scratch: &mut Scratch,
    dprojected: &mut [f32],
    dedge: &mut [f32],
) {
    scratch.edges.resize(inputs.graph.neighbours.len() * 2 * inputs.heads, 0.0);
    dispatch!(level, simd => {
        // As in the forward operation, a length known to the compiler.
        match dedge.len() / 6 / inputs.heads {
            8 => kernel::<_, 8>(simd, inputs, g, scratch, dprojected, dedge),
            16 => kernel::<_, 16>(simd, inputs, g, scratch, dprojected, dedge),
            32 => kernel::<_, 32>(simd, inputs, g, scratch, dprojected, dedge),
            64 => kernel::<_, 64>(simd, inputs, g, scratch, dprojected, dedge),
            _ => kernel::<_, 0>(simd, inputs, g, scratch, dprojected, dedge),
        }
    });
}

/// D: features per head where they are known, else 0.
#[inline(always)]
fn kernel<S: Simd, const D: usize>(
    simd: S,
    inputs: &Inputs,
    g: &[f32],
    scratch: &mut Scratch,
    dprojected: &mut [f32],
    dedge: &mut [f32],
) {
    let features = dedge.len() / 6;
    let d = if D > 0 { D } else { features / inputs.heads };
    for (i, g) in g.chunks_exact(features).enumerate() {
        let dquery = &mut dprojected[i * 4 * features..][..features];
        own(simd, inputs, i, g, d, scratch, dquery);
    }
    scratch.seen.clear();
    scratch.seen.extend_from_slice(inputs.graph.offsets);
    for (j, (own, dprojected)) in g.chunks_exact(features).zip(dprojected.chunks_exact_mut(4 * features)).enumerate() {
        let (dkey, dvalue) = dprojected[features..3 * features].split_at_mut(features);
        given(simd, inputs, j, g, d, scratch, dkey, dvalue);
        if inputs.graph.of(j).is_empty() {
            continue;
        }
        // U falls on k' and v', and once off ĥ.
        let du = &mut scratch.du;
        du.clear();
        du.extend(dkey.iter().zip(&*dvalue).zip(own).map(|((dkey, dvalue), own)| dkey + dvalue - own));
        for (potential, dedge) in inputs.potentials[6 * j..6 * j + 6].iter().zip(dedge.chunks_exact_mut(features)) {
            axpy(simd, *potential, du, dedge);
        }
    }
}

/// Attention of vertex `i` again, and the gradient of its scores: both kept by edge; dq.
#[inline(always)]
fn own<S: Simd>(simd: S, inputs: &Inputs, i: usize, g: &[f32], d: usize, scratch: &mut Scratch, dquery: &mut [f32]) {
    let (features, heads, neighbours) = (g.len(), inputs.heads, inputs.graph.of(i));
    let projected = |j: u32, part: usize| &inputs.projected[(j as usize * 4 + part) * features..][..features];
    let (query, degree, scale) = (projected(i as u32, 0), neighbours.len(), 1.0 / (d as f32).sqrt());
    let Scratch { edges, alpha, dalpha, .. } = scratch;
    dquery.fill(0.0);
    // Filled up to whole vectors, as softmax wants them.
    let row = degree.next_multiple_of(S::f32s::LEN);
    alpha.clear();
    alpha.resize(heads * row, f32::MIN);
    dalpha.resize(heads * row, 0.0);
    for (e, j) in neighbours.iter().enumerate() {
        let (key, value) = (projected(*j, 1), projected(*j, 2));
        for (c, at) in (0..features).step_by(d).enumerate() {
            alpha[c * row + e] = dot(simd, &query[at..at + d], &key[at..at + d]);
            dalpha[c * row + e] = dot(simd, &g[at..at + d], &value[at..at + d]);
        }
    }
    for alpha in alpha.chunks_exact_mut(row.max(1)) {
        softmax(simd, scale, alpha);
    }
    let edges = &mut edges[inputs.graph.offsets[i] as usize * 2 * heads..][..degree * 2 * heads];
    for c in 0..heads {
        let (alpha, dalpha) = (&alpha[c * row..][..degree], &dalpha[c * row..][..degree]);
        let mean: f32 = alpha.iter().zip(dalpha).map(|(alpha, dalpha)| alpha * dalpha).sum();
        for (edge, (alpha, dalpha)) in edges.chunks_exact_mut(2 * heads).zip(alpha.iter().zip(dalpha)) {
            edge[c] = *alpha;
            edge[heads + c] = alpha * (dalpha - mean) * scale;
        }
    }
    for (j, edge) in neighbours.iter().zip(edges.chunks_exact(2 * heads)) {
        let key = projected(*j, 1);
        for (ds, (key, dquery)) in edge[heads..].iter().zip(key.chunks_exact(d).zip(dquery.chunks_exact_mut(d))) {
            axpy(simd, *ds, key, dquery);
        }
    }
}

/// What vertex `j` gave its neighbours: dk' and dv'. Vertices come in order, and so do the neighbours in every list:
/// the edge from `i` to `j` is the next one of `i` not yet seen.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "operands of one inner kernel")]
fn given<S: Simd>(
    simd: S,
    inputs: &Inputs,
    j: usize,
    g: &[f32],
    d: usize,
    scratch: &mut Scratch,
    dkey: &mut [f32],
    dvalue: &mut [f32],
) {
    let (features, heads) = (dkey.len(), inputs.heads);
    let Scratch { edges, seen, .. } = scratch;
    dkey.fill(0.0);
    dvalue.fill(0.0);
    for i in inputs.graph.of(j).iter().map(|i| *i as usize) {
        let edge = &edges[seen[i] as usize * 2 * heads..][..2 * heads];
        seen[i] += 1;
        let (g, query) = (&g[i * features..][..features], &inputs.projected[i * 4 * features..][..features]);
        for (c, at) in (0..features).step_by(d).enumerate() {
            axpy(simd, edge[heads + c], &query[at..at + d], &mut dkey[at..at + d]);
            axpy(simd, edge[c], &g[at..at + d], &mut dvalue[at..at + d]);
        }
    }
}
