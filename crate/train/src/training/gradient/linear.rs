//! `y = act(W x + b)`: `dW = dy xᵀ`, `db = Σ dy`, `dx = Wᵀ dy`.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

/// Zeroes the gradient where ReLU cut: y, dy [rows, outputs].
pub fn mask(y: &[f32], dy: &mut [f32]) {
    dy.iter_mut().zip(y).filter(|(_, y)| **y <= 0.0).for_each(|(dy, _)| *dy = 0.0);
}

/// x [rows, inputs], weight [inputs, outputs], dy [rows, outputs] -> dx (overwritten; empty: not wanted), dweight,
/// dbias.
pub fn linear(x: &[f32], weight: &[f32], dy: &[f32], dx: &mut [f32], dweight: &mut [f32], dbias: &mut [f32]) {
    let outputs = dbias.len();
    let (rows, inputs) = (dy.len() / outputs, weight.len() / outputs);
    for dy in dy.chunks_exact(outputs) {
        dbias.iter_mut().zip(dy).for_each(|(dbias, dy)| *dbias += dy);
    }
    let matrix = |values, rows, columns| MatRef::from_row_major_slice(values, rows, columns);
    let (x, dy) = (matrix(x, rows, inputs), matrix(dy, rows, outputs));
    let dweight = MatMut::from_row_major_slice_mut(dweight, inputs, outputs);
    matmul(dweight, Accum::Add, x.transpose(), dy, 1.0, Par::Seq);
    if !dx.is_empty() {
        let dx = MatMut::from_row_major_slice_mut(dx, rows, inputs);
        matmul(dx, Accum::Replace, dy, matrix(weight, inputs, outputs).transpose(), 1.0, Par::Seq);
    }
}
