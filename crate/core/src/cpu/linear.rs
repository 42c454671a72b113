//! `y = act(W x + b)`, rows independent. network.md §2, §3.
//! Register tile of 4 rows × 2 vectors: 8 accumulators. With 10 or more, Chromium's wasm spills and falls to half (measured).

use crate::device::Activation;
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, dispatch};

/// x [rows, inputs], weight [inputs, outputs], bias [outputs] -> y [rows, outputs].
pub fn linear(level: Level, x: &[f32], weight: &[f32], bias: &[f32], activation: Activation, y: &mut [f32]) {
    dispatch!(level, simd => kernel(simd, x, weight, bias, activation == Activation::Relu, y));
}

#[inline(always)]
fn kernel<S: Simd>(simd: S, x: &[f32], weight: &[f32], bias: &[f32], relu: bool, y: &mut [f32]) {
    let (lanes, outputs) = (S::f32s::LEN, bias.len());
    let inputs = weight.len() / outputs;
    let tiled = y.len() / outputs / 4 * 4;
    let (x_tiled, x_rest) = x.split_at(tiled * inputs);
    let (y_tiled, y_rest) = y.split_at_mut(tiled * outputs);
    let mut column = 0;
    while column + 2 * lanes <= outputs {
        columns::<S, 4, 2>(simd, x_tiled, weight, bias, column, relu, y_tiled);
        columns::<S, 1, 2>(simd, x_rest, weight, bias, column, relu, y_rest);
        column += 2 * lanes;
    }
    while column + lanes <= outputs {
        columns::<S, 4, 1>(simd, x_tiled, weight, bias, column, relu, y_tiled);
        columns::<S, 1, 1>(simd, x_rest, weight, bias, column, relu, y_rest);
        column += lanes;
    }
    for (x, y) in x.chunks_exact(inputs).zip(y.chunks_exact_mut(outputs)) {
        for c in column..outputs {
            let sum = x.iter().enumerate().fold(bias[c], |sum, (i, x)| sum + x * weight[i * outputs + c]);
            y[c] = if relu { sum.max(0.0) } else { sum };
        }
    }
}

/// VECTORS whole vectors of output columns from `column` on, for rows in groups of ROWS.
#[inline(always)]
fn columns<S: Simd, const ROWS: usize, const VECTORS: usize>(
    simd: S,
    x: &[f32],
    weight: &[f32],
    bias: &[f32],
    column: usize,
    relu: bool,
    y: &mut [f32],
) {
    let (lanes, outputs) = (S::f32s::LEN, bias.len());
    let inputs = weight.len() / outputs;
    let zero = S::f32s::splat(simd, 0.0);
    let start: [S::f32s; VECTORS] =
        std::array::from_fn(|v| S::f32s::from_slice(simd, &bias[column + v * lanes..][..lanes]));
    for (x, y) in x.chunks_exact(ROWS * inputs).zip(y.chunks_exact_mut(ROWS * outputs)) {
        let rows: [&[f32]; ROWS] = std::array::from_fn(|r| &x[r * inputs..][..inputs]);
        let mut sums = [start; ROWS];
        for (i, weight) in weight.chunks_exact(outputs).enumerate() {
            let weight = &weight[column..][..VECTORS * lanes];
            let w: [S::f32s; VECTORS] =
                std::array::from_fn(|v| S::f32s::from_slice(simd, &weight[v * lanes..][..lanes]));
            for r in 0..ROWS {
                let x = S::f32s::splat(simd, rows[r][i]);
                for v in 0..VECTORS {
                    sums[r][v] = x.mul_add(w[v], sums[r][v]);
                }
            }
        }
        for r in 0..ROWS {
            for v in 0..VECTORS {
                let sum = if relu { sums[r][v].max(zero) } else { sums[r][v] };
                sum.store_slice(&mut y[r * outputs + column + v * lanes..][..lanes]);
            }
        }
    }
}
