//! Attention of one vertex where every head is of whole vectors and the heads come in fours: no number is summed or
//! compared across the lanes of a vector. The products of all edges and heads are summed many at a time, by adding
//! neighbouring lanes of pairs of them; the softmax goes over edges, with a head in each lane.

use super::exp::exp;
use crate::cpu::vector::room;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x4};

/// Room for one vertex.
#[derive(Default)]
pub struct Scratch {
    /// Products of query and key, not yet summed [edges, C, lanes], in whole squares.
    products: Vec<f32>,
    /// Scores, then their exponentials [edges, C], in whole vectors.
    scores: Vec<f32>,
    /// 1 / the sum of these over the edges [C].
    shares: Vec<f32>,
}

/// Vectors of a head that are gathered at once.
const VECTORS: usize = 4;

/// Whether [`attend`] knows heads of `d` features.
#[inline(always)]
pub fn suits<S: Simd>(heads: usize, d: usize) -> bool {
    heads.is_multiple_of(4) && d.is_multiple_of(S::f32s::LEN)
}

/// `Σ_j α_ij v_j` of a vertex i that has neighbours -> attended [F]; `D` features per head, `projected` [n, 4F].
#[cfg_attr(target_arch = "wasm32", inline(never))]
#[cfg_attr(not(target_arch = "wasm32"), inline(always))]
pub fn attend<S: Simd, const D: usize>(
    simd: S,
    (i, neighbours): (usize, &[u32]),
    projected: &[f32],
    scratch: &mut Scratch,
    attended: &mut [f32],
) {
    let features = attended.len();
    let (heads, lanes) = (features / D, S::f32s::LEN);
    let count = (neighbours.len() * heads).next_multiple_of(lanes);
    let products = room(&mut scratch.products, count * lanes);
    let query = &projected[i * 4 * features..][..features];
    let edges = products.chunks_exact_mut(heads * lanes);
    for (products, j) in edges.zip(neighbours) {
        let key = &projected[(*j as usize * 4 + 1) * features..][..features];
        let heads = query.chunks_exact(D).zip(key.chunks_exact(D));
        for ((query, key), product) in heads.zip(products.chunks_exact_mut(lanes)) {
            let load = |values: &[f32], at: usize| S::f32s::from_slice(simd, &values[at..at + lanes]);
            let mut sum = load(query, 0) * load(key, 0);
            for at in (lanes..D).step_by(lanes) {
                sum = load(query, at).mul_add(load(key, at), sum);
            }
            sum.store_slice(product);
        }
    }
    let scores = room(&mut scratch.scores, count);
    for (scores, products) in scores.chunks_exact_mut(lanes).zip(products.chunks_exact(lanes * lanes)) {
        sums::<S>(simd, products).store_slice(scores);
    }
    softmax(simd, 1.0 / (D as f32).sqrt(), neighbours.len() * heads, scores, room(&mut scratch.shares, heads));
    let width = D.min(VECTORS * lanes);
    for (part, attended) in attended.chunks_exact_mut(width).enumerate() {
        let head = part * width / D;
        let mut sum = [S::f32s::splat(simd, 0.0); VECTORS];
        for (j, scores) in neighbours.iter().zip(scores.chunks_exact(heads)) {
            let value = &projected[(*j as usize * 4 + 2) * features + part * width..][..width];
            let score = S::f32s::splat(simd, scores[head]);
            for v in 0..width / lanes {
                sum[v] = S::f32s::from_slice(simd, &value[v * lanes..][..lanes]).mul_add(score, sum[v]);
            }
        }
        let share = S::f32s::splat(simd, scratch.shares[head]);
        for v in 0..width / lanes {
            (sum[v] * share).store_slice(&mut attended[v * lanes..][..lanes]);
        }
    }
}

/// The sum of each vector of a square, one in a lane.
#[inline(always)]
fn sums<S: Simd>(simd: S, square: &[f32]) -> S::f32s {
    let lanes = S::f32s::LEN;
    let mut rows = [S::f32s::splat(simd, 0.0); 16];
    for row in 0..lanes {
        rows[row] = S::f32s::from_slice(simd, &square[row * lanes..][..lanes]);
    }
    for half in [8, 4, 2, 1] {
        if half < lanes {
            for row in 0..half {
                let (a, b) = (rows[2 * row], rows[2 * row + 1]);
                rows[row] = a.unzip_low(b) + a.unzip_high(b);
            }
        }
    }
    rows[0]
}

/// Scores [edges, C] of `count` numbers -> the exponentials of their softmax, times `scale` first, and 1 / their sums
/// [C].
#[inline(always)]
fn softmax<S: Simd>(simd: S, scale: f32, count: usize, scores: &mut [f32], shares: &mut [f32]) {
    let heads = shares.len();
    let scale = f32x4::splat(simd, scale);
    for at in (0..heads).step_by(4) {
        let mut largest = f32x4::splat(simd, f32::MIN);
        for scores in scores[..count].chunks_exact(heads) {
            let scores = f32x4::from_slice(simd, &scores[at..at + 4]);
            largest = scores.simd_gt(largest).select(scores, largest);
        }
        for scores in scores[..count].chunks_exact_mut(heads) {
            let scores = &mut scores[at..at + 4];
            ((f32x4::from_slice(simd, scores) - largest) * scale).store_slice(scores);
        }
    }
    // What fills up the last vector is left over from other vertices: never read.
    for scores in scores.chunks_exact_mut(S::f32s::LEN) {
        exp(simd, S::f32s::from_slice(simd, scores)).store_slice(scores);
    }
    for at in (0..heads).step_by(4) {
        let mut sum = f32x4::splat(simd, 0.0);
        for scores in scores[..count].chunks_exact(heads) {
            sum += f32x4::from_slice(simd, &scores[at..at + 4]);
        }
        (f32x4::splat(simd, 1.0) / sum).store_slice(&mut shares[at..at + 4]);
    }
}
