//! `y = act(W x + b)`, rows independent. network.md §2, §3.
//! Register tile of 4 rows × 2 vectors: 8 accumulators. With 10 or more, Chromium's wasm spills and falls to half
//! (measured).

use crate::cpu::{Cpu, Kernel};
use crate::operation::{Activation, Linear};
use fearless_simd::{Simd, SimdBase, SimdFloat, dispatch};

impl Kernel for Linear<&[f32], &mut [f32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { x, weight, bias, activation, y } = self;
        dispatch!(cpu.level, simd => kernel(simd, x, weight, bias, activation == Activation::Relu, y));
    }
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

#[cfg(feature = "suite")]
impl crate::suite::Suite for Linear<Vec<f32>, Vec<f32>> {
    /// Sums of up to 130 products of order one, in any order: f32 rounds each by up to 6e-8.
    const TOLERANCE: f64 = 1e-5;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let shapes =
            [[1, 1, 1], [1, 780, 9], [1, 9, 67], [4, 4, 16], [7, 5, 9], [67, 3, 60], [130, 33, 12], [9, 130, 33]];
        let both = shapes.into_iter().flat_map(|shape| [Activation::None, Activation::Relu].map(|act| (shape, act)));
        let mut operand = |([rows, inputs, outputs], activation): ([usize; 3], Activation)| {
            let x = crate::suite::numbers(rng, rows * inputs, 1.0);
            let weight = crate::suite::numbers(rng, inputs * outputs, (3.0 / inputs as f32).sqrt());
            let bias = crate::suite::numbers(rng, outputs, 0.5);
            Self { x, weight, bias, activation, y: vec![0.0; rows * outputs] }
        };
        both.map(&mut operand).collect()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let [x, weight, bias] = [&self.x, &self.weight, &self.bias].map(|values| crate::suite::wide(values));
        let (inputs, outputs) = (weight.len() / bias.len(), bias.len());
        let number = |row: usize, o: usize| {
            let sum = (0..inputs).map(|i| x[row * inputs + i] * weight[i * outputs + o]).sum::<f64>() + bias[o];
            if self.activation == Activation::Relu { sum.max(0.0) } else { sum }
        };
        let rows = self.y.len() / outputs;
        vec![Some(
            (0..rows).flat_map(|row| (0..outputs).map(move |o| (row, o))).map(|(row, o)| number(row, o)).collect(),
        )]
    }
}
