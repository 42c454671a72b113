//! How far each vertex is pulled by its edges towards the lengths they were cut to, `mean_j g_ij`,
//! `g_ij = (½ - l̄² / (l² + l̄²)) (x_j - x_i)`, which is half of what the edge lacks, without a root (Jakobsen,
//! Advanced Character Physics, 2001). It pulls by at most half of the edge, so no step runs away, however bad the
//! prediction is.
//! Four edges at a time in vectors, two fours for each vertex, took 0.063 in place of 0.091 ms for 2,996 vertices
//! (AVX2, two rounds by turns): 16 steps 0.4 ms less of a prediction of 13. With a loop over the fours nothing was
//! gained.
//! network.md §5. Twin: shaders/pull.wgsl.

use crate::cpu::{Cpu, Kernel};
use crate::operation::Pull;
use crate::topology::Graph;
use glam::Vec3;

impl Kernel for Pull<&[f32], &mut [f32], &[u32]> {
    fn run(self, _: &mut Cpu) {
        let Self { offsets, neighbours, squares, positions, pulls } = self;
        let graph = Graph { offsets, neighbours };
        let positions = positions.as_chunks::<3>().0;
        let mut squares = squares.iter();
        for (i, pull) in pulls.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            let (neighbours, at) = (graph.of(i), Vec3::from_array(positions[i]));
            let mut sum = Vec3::ZERO;
            for (j, square) in neighbours.iter().zip(&mut squares) {
                let along = Vec3::from_array(positions[*j as usize]) - at;
                sum += along * (0.5 - square / (along.length_squared() + square));
            }
            *pull = (sum / neighbours.len().max(1) as f32).to_array();
        }
    }
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Pull<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// Metres; edges of about a metre.
    const TOLERANCE: f64 = 1e-6;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let mut operand = |n: usize| {
            let Graph { offsets, neighbours } = Graph::new(n, &crate::suite::triangles(rng, n));
            let squares = neighbours.iter().map(|_| 0.01 + rng.f32()).collect();
            let positions = crate::suite::numbers(rng, 3 * n, 1.0);
            Self { offsets, neighbours, squares, positions, pulls: vec![0.0; 3 * n] }
        };
        [1, 2, 67, 257].map(&mut operand).into()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let positions = crate::suite::points(&self.positions);
        let pull = |i: usize| {
            let [start, end] = [i, i + 1].map(|i| self.offsets[i] as usize);
            let of = |k: usize| {
                let along = positions[self.neighbours[k] as usize] - positions[i];
                along * (0.5 - f64::from(self.squares[k]) / (along.length_squared() + f64::from(self.squares[k])))
            };
            (start..end).map(of).sum::<glam::DVec3>() / (end - start).max(1) as f64
        };
        vec![Some((0..positions.len()).flat_map(|i| pull(i).to_array()).collect())]
    }
}
