//! A step in which predicted cloth takes back the lengths it was cut to. A network that learns from cloth which buckles
//! now this way and now that answers the mean of both: the folds are there, as compression, and come out when every
//! edge asks for its length. network.md §5. Twin: shaders/polish.wgsl.
//!
//! Per vertex, over its edges: `x_i += s (w · mean_j g_ij + μ (x_i - x_i before))`,
//! `g_ij = (½ - l̄² / (l² + l̄²)) (x_j - x_i)`, which is half of what the edge lacks, without a root (Jakobsen,
//! Advanced Character Physics, 2001). It pulls by at most half of the edge, so no step runs away, however bad the
//! prediction is.
//!
//! Tried on 14 unseen poses of a T-shirt, 16 steps each: the membrane of triangles in place of edges, by the nearest
//! rotation of each (bending ratio 0.945 in place of 0.930, strain 1.36 % in place of 1.45, E_dist the same, at some
//! four times the cost); edges weighted by the area beside them (no difference to two digits); bending stiffness, of 16
//! times the fabric's (0.73) and more (flat), because at this length of edges the fabric's own is next to nothing;
//! the repair of penetration after every second step (strain 1.45 in place of 1.49 % in the end, for twice the cost);
//! smoothing each step's moves, so that long waves go first (0.83 with one round, 0.69 with two). With two rounds and
//! w = 8 that keeps the lengths as well (strain 0.81 % in place of 0.87, five unseen frames) with fewer short waves
//! (0.90 in place of 0.98, correlation 0.902 in place of 0.897), at three times the cost: next to be tried where meshes
//! are fine and the polish crinkles them. Moving along the surface alone in the first steps (strain 1.1 % and more).

use crate::cpu::{Cpu, Kernel};
use crate::operation::Polish;
use crate::topology::Graph;
use glam::Vec3;

/// w. With the momentum below, up to 3.4 is stable; with 3.5 folds grow where there are none.
pub const RATE: f32 = 2.6;
/// μ of every step but the first.
pub const MOMENTUM: f32 = 0.7;

impl Kernel for Polish<&[f32], &mut [f32], &[u32]> {
    fn run(self, _: &mut Cpu) {
        let Self { offsets, neighbours, squares, share, first, current, other } = self;
        let graph = Graph { offsets, neighbours };
        let current = current.as_chunks::<3>().0;
        let (rate, momentum) = (share[0] * RATE, if first { 0.0 } else { share[0] * MOMENTUM });
        let mut squares = squares.iter();
        for (i, other) in other.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            let (neighbours, at) = (graph.of(i), Vec3::from_array(current[i]));
            let mut sum = Vec3::ZERO;
            for (j, square) in neighbours.iter().zip(&mut squares) {
                let along = Vec3::from_array(current[*j as usize]) - at;
                sum += along * (0.5 - square / (along.length_squared() + square));
            }
            // What was there before the first step may be anything.
            let before = if first { at } else { Vec3::from_array(*other) };
            let by = sum * (rate / neighbours.len().max(1) as f32) + (at - before) * momentum;
            *other = (at + by).to_array();
        }
    }
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Polish<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// Of places within a metre, and moves as long.
    const TOLERANCE: f64 = 2e-6;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let mut operand = |(n, share, first): (usize, f32, bool)| {
            let Graph { offsets, neighbours } = Graph::new(n, &crate::suite::triangles(rng, n));
            let squares = neighbours.iter().map(|_| 0.01 + rng.f32()).collect();
            let (current, mut other) = (crate::suite::numbers(rng, 3 * n, 1.0), crate::suite::numbers(rng, 3 * n, 1.0));
            if first {
                other.fill(f32::NAN);
            }
            Self { offsets, neighbours, squares, share: vec![share], first, current, other }
        };
        [(1, 1.0, true), (2, 1.0, false), (67, 0.3, false), (67, 0.0, false), (257, 1.0, true), (257, 1.0, false)]
            .map(&mut operand)
            .into()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let (current, other) = (crate::suite::points(&self.current), crate::suite::points(&self.other));
        let moved = |i: usize| {
            let [start, end] = [i, i + 1].map(|i| self.offsets[i] as usize);
            let pull = |k: usize| {
                let (along, square) = (current[self.neighbours[k] as usize] - current[i], f64::from(self.squares[k]));
                along * (0.5 - square / (along.length_squared() + square))
            };
            let pulls = (start..end).map(pull).sum::<glam::DVec3>() / (end - start).max(1) as f64;
            let before = if self.first { glam::DVec3::ZERO } else { f64::from(MOMENTUM) * (current[i] - other[i]) };
            current[i] + f64::from(self.share[0]) * (f64::from(RATE) * pulls + before)
        };
        vec![Some((0..current.len()).flat_map(|i| moved(i).to_array()).collect())]
    }
}
