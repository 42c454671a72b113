//! Constants as the shaders read them: rows padded with zeros to whole vec4, and what neighbouring invocations read
//! side by side.

use ctsn_core::pose::{Range, Rig};

/// Numbers in whole vec4.
pub fn whole(numbers: usize) -> usize {
    numbers.next_multiple_of(4)
}

/// Rows of `columns` numbers -> the same `stride` numbers apart, zeros between them.
pub fn strided(values: &[f32], columns: usize, stride: usize) -> Vec<f32> {
    let mut packed = vec![0.0; values.len() / columns * stride];
    for (row, packed) in values.chunks_exact(columns).zip(packed.chunks_exact_mut(stride)) {
        packed[..columns].copy_from_slice(row);
    }
    packed
}

/// [rows, columns] -> [rows, columns padded], then rows of zeros up to `count` in all.
pub fn rows(values: &[f32], columns: usize, count: usize) -> Vec<f32> {
    let mut packed = strided(values, columns, whole(columns));
    packed.resize(count * whole(columns), 0.0);
    packed
}

/// [n, 3, count] -> [count / 4, 3n] of vec4.
pub fn basis(values: &[f32], count: usize) -> Vec<f32> {
    let numbers = values.len() / count;
    let mut packed = vec![0.0; numbers * whole(count)];
    for (i, row) in values.chunks_exact(count).enumerate() {
        for (j, value) in row.iter().enumerate() {
            packed[4 * (j / 4 * numbers + i) + j % 4] = *value;
        }
    }
    packed
}

/// [n, width] -> [width, n].
pub fn slots<T: Copy>(values: &[T], width: usize) -> Vec<T> {
    (0..width).flat_map(|slot| values.iter().skip(slot).step_by(width).copied()).collect()
}

/// `W_eᵀ` [6, F], gate [3F], norm weight and bias [F] -> three vec4 per feature: W_e of V and norm weight; W_e of T_C
/// and norm bias; the gate's three.
pub fn layer(edge: &[f32], gate: &[f32], norm_weight: &[f32], norm_bias: &[f32]) -> Vec<f32> {
    let features = norm_weight.len();
    let feature = |f: usize| {
        let edge = |c: usize| edge[c * features + f];
        let gate = |part: usize| gate[part * features + f];
        [
            edge(0),
            edge(1),
            edge(2),
            norm_weight[f],
            edge(3),
            edge(4),
            edge(5),
            norm_bias[f],
            gate(0),
            gate(1),
            gate(2),
            0.0,
        ]
    };
    (0..features).flat_map(feature).collect()
}

/// Mean of the pose vector, its standard deviation, then the range: bounds, and where the joints are. Boundless for a
/// rig without.
pub fn standard(rig: &Rig) -> Vec<f32> {
    let boundless = || {
        let bound = |bound| vec![bound; rig.mean.len()];
        Range::new(&rig.inverse_bind, bound(f32::MIN), bound(f32::MAX))
    };
    let Range { min, max, origins } = rig.range.clone().unwrap_or_else(boundless);
    let origins = origins.iter().flat_map(|origin| origin.extend(0.0).to_array()).collect();
    [rig.mean.clone(), rig.std.clone(), min, max, origins].concat()
}

/// Triangles [t, 3] -> first corner of each of `n` vertices [n + 1], and the corners of the triangles around it, in
/// their order.
pub fn corners(n: usize, triangles: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let mut around = vec![Vec::new(); n];
    for triangle in triangles.as_chunks::<3>().0 {
        triangle.iter().for_each(|vertex| around[*vertex as usize].extend_from_slice(triangle));
    }
    let mut offsets = vec![0; n + 1];
    (0..n).for_each(|i| offsets[i + 1] = offsets[i] + around[i].len() as u32);
    (offsets, around.concat())
}
