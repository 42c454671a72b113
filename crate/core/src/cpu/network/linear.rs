//! `y = act(W x + b)`, rows independent. network.md §2, §3.
//!
//! A block of rows stays in the cache while all columns go over it; weights and bias are copied into *panels*, so that
//! what one pass over the inputs reads lies together. In place, rows of 4 KiB put a column's weights into the same few
//! lines of the cache. The copy costs 1 / rows of the product, so it is made anew for each call: weights may change
//! between any two, as training does.

use crate::cpu::threads::of;
use crate::cpu::vector::{axpy, room};
use crate::cpu::{Cpu, Kernel};
use crate::operation::{Activation, Linear};
use fearless_simd::{Simd, SimdBase, SimdFloat, dispatch};

/// Rows that stay in the cache: a whole number of tiles of any height below.
const BLOCK: usize = 192;
/// Rows of a tile, of long vectors and of those of four numbers.
const HIGH: usize = 6;
const LOW: usize = 4;
/// Vectors of a panel.
const VECTORS: usize = 2;

/// What some rows are computed of.
struct Operands<'a> {
    x: &'a [f32],
    weight: &'a [f32],
    bias: &'a [f32],
    relu: bool,
    /// Bias, then weights, of VECTORS vectors of columns after another [panels, inputs + 1, VECTORS · lanes]. Empty
    /// where rows are computed one by one.
    panels: &'a [f32],
}

impl Kernel for Linear<&[f32], &mut [f32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { x, weight, bias, activation, y } = self;
        let (relu, level, inputs) = (activation == Activation::Relu, cpu.level, weight.len() / bias.len());
        let rows = y.len() / bias.len();
        let panels = dispatch!(level, simd => pack(simd, rows, weight, bias, &mut cpu.panels));
        cpu.threads.share(rows, [y], &mut cpu.scratch, |rows, [y], scratch| {
            let x = of(x, &rows, inputs);
            let (operands, tiles) = (Operands { x, weight, bias, relu, panels }, &mut scratch.tiles);
            dispatch!(level, simd => product(simd, &operands, tiles, y));
        });
    }
}

/// Tiles of 12 accumulators where a product and a sum are one instruction, of 8 elsewhere: measured on AVX-512, AVX2
/// and in V8. With one row or vector more, the compiler or V8 keeps them in memory, at a third of the speed. In V8 a
/// tile of x must lie together, too (40 GFLOP/s instead of 32); natively that costs a third where outputs are few.
#[inline(always)]
fn product<S: Simd>(simd: S, operands: &Operands, tiles: &mut Vec<f32>, y: &mut [f32]) {
    if S::f32s::LEN > 4 {
        blocks::<S, HIGH, false>(simd, operands, tiles, y);
    } else {
        blocks::<S, LOW, true>(simd, operands, tiles, y);
    }
}

/// ROWS: height of a tile. TOGETHER: whether its x is copied.
/// A function of its own in wasm: inlined, V8 compiles it half as fast.
#[cfg_attr(target_arch = "wasm32", inline(never))]
#[cfg_attr(not(target_arch = "wasm32"), inline(always))]
fn blocks<S: Simd, const ROWS: usize, const TOGETHER: bool>(
    simd: S,
    operands: &Operands,
    scratch: &mut Vec<f32>,
    y: &mut [f32],
) {
    let Operands { x, weight, bias, relu, panels } = *operands;
    let (inputs, outputs, width) = (weight.len() / bias.len(), bias.len(), VECTORS * S::f32s::LEN);
    let rows = y.len() / outputs;
    if rows < ROWS {
        for (x, y) in x.chunks_exact(inputs).zip(y.chunks_exact_mut(outputs)) {
            row(simd, x, weight, bias, relu, y);
        }
        return;
    }
    for start in (0..rows).step_by(BLOCK) {
        let (tiles, last) = (BLOCK.min(rows - start).div_ceil(ROWS), rows - ROWS);
        // The last tile of all ends with the last row: some rows are computed twice, alike.
        let starts = (0..tiles).map(|tile| (start + tile * ROWS).min(last));
        let copies = room(scratch, if TOGETHER { tiles * ROWS * inputs } else { 0 });
        for (copy, at) in copies.chunks_exact_mut(ROWS * inputs).zip(starts.clone()) {
            let rows = tile_rows::<ROWS>(&x[at * inputs..], inputs);
            for (i, copy) in copy.as_chunks_mut::<ROWS>().0.iter_mut().enumerate().take(inputs) {
                *copy = rows.map(|row| row[i]);
            }
        }
        for (p, panel) in panels.chunks_exact((inputs + 1) * width).enumerate() {
            let columns = p * width..outputs.min((p + 1) * width);
            for (tile, at) in starts.clone().enumerate() {
                let sums = if TOGETHER {
                    let copy = &copies[tile * ROWS * inputs..][..ROWS * inputs];
                    let copy = copy.as_chunks::<ROWS>().0;
                    sums::<S, ROWS>(
                        simd,
                        #[inline(always)]
                        |r, i| copy[i][r],
                        inputs,
                        panel,
                    )
                } else {
                    let rows = tile_rows::<ROWS>(&x[at * inputs..], inputs);
                    sums::<S, ROWS>(
                        simd,
                        #[inline(always)]
                        |r, i| rows[r][i],
                        inputs,
                        panel,
                    )
                };
                for r in 0..ROWS {
                    store(simd, &sums[r], relu, &mut y[(at + r) * outputs..][columns.clone()]);
                }
            }
        }
    }
}

/// The first rows of x.
#[inline(always)]
fn tile_rows<const ROWS: usize>(x: &[f32], inputs: usize) -> [&[f32]; ROWS] {
    std::array::from_fn(|r| &x[r * inputs..][..inputs])
}

/// Bias and weights -> panels; columns beyond the last are zero. No panels where there is no tile of rows.
#[inline(always)]
fn pack<'a, S: Simd>(_: S, rows: usize, weight: &[f32], bias: &[f32], panels: &'a mut Vec<f32>) -> &'a [f32] {
    let (inputs, outputs, width) = (weight.len() / bias.len(), bias.len(), VECTORS * S::f32s::LEN);
    if rows < if S::f32s::LEN > 4 { HIGH } else { LOW } {
        return &[];
    }
    let panels = room(panels, outputs.div_ceil(width) * (inputs + 1) * width);
    for (p, panel) in panels.chunks_exact_mut((inputs + 1) * width).enumerate() {
        let columns = p * width..outputs.min((p + 1) * width);
        let rows = std::iter::once(bias).chain(weight.chunks_exact(outputs));
        for (to, row) in panel.chunks_exact_mut(width).zip(rows) {
            to[..columns.len()].copy_from_slice(&row[columns.clone()]);
            to[columns.len()..].fill(0.0);
        }
    }
    panels
}

/// A tile of `W x + b`, of a panel; `x(row, input)`.
#[inline(always)]
fn sums<S: Simd, const ROWS: usize>(
    simd: S,
    x: impl Fn(usize, usize) -> f32,
    inputs: usize,
    panel: &[f32],
) -> [[S::f32s; VECTORS]; ROWS] {
    let lanes = S::f32s::LEN;
    let load = |row: &[f32]| -> [S::f32s; VECTORS] {
        std::array::from_fn(|v| S::f32s::from_slice(simd, &row[v * lanes..][..lanes]))
    };
    let (bias, weights) = panel.split_at(VECTORS * lanes);
    let mut sums = [load(bias); ROWS];
    for (i, weights) in weights.chunks_exact(VECTORS * lanes).enumerate().take(inputs) {
        let weights = load(weights);
        for r in 0..ROWS {
            let x = S::f32s::splat(simd, x(r, i));
            for v in 0..VECTORS {
                sums[r][v] = x.mul_add(weights[v], sums[r][v]);
            }
        }
    }
    sums
}

/// Sums of a row -> y, which may end before they do.
#[inline(always)]
fn store<S: Simd>(simd: S, sums: &[S::f32s; VECTORS], relu: bool, y: &mut [f32]) {
    let (lanes, zero) = (S::f32s::LEN, S::f32s::splat(simd, 0.0));
    let whole = y.len() == VECTORS * lanes;
    for v in 0..VECTORS {
        let sum = if relu { sums[v].max(zero) } else { sums[v] };
        if whole {
            sum.store_slice(&mut y[v * lanes..][..lanes]);
        } else {
            y.iter_mut().skip(v * lanes).zip(sum.as_slice()).for_each(|(y, sum)| *y = *sum);
        }
    }
}

/// One row alone, weights in place: they are read once.
#[inline(always)]
fn row<S: Simd>(simd: S, x: &[f32], weight: &[f32], bias: &[f32], relu: bool, y: &mut [f32]) {
    y.copy_from_slice(bias);
    for (x, weight) in x.iter().zip(weight.chunks_exact(bias.len())) {
        axpy(simd, *x, weight, y);
    }
    if relu {
        y.iter_mut().for_each(|y| *y = y.max(0.0));
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
