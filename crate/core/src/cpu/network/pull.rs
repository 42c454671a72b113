//! How far each vertex is pulled by its edges towards the lengths they were cut to, `mean_j g_ij`,
//! `g_ij = (½ - l̄² / (l² + l̄²)) (x_j - x_i)`, which is half of what the edge lacks, without a root (Jakobsen,
//! Advanced Character Physics, 2001). It pulls by at most half of the edge, so no step runs away, however bad the
//! prediction is. What would bring a vertex nearer to the body than its gap is taken off: no step can go there, and
//! shared with the neighbours it would draw them along. (Left on, unseen frames of a tight T-shirt of 4,002 vertices:
//! 3.76 mm, 7.2°, strain 2.96 %, energy 18.7 times the simulation's; taken off, 3.62 mm, 7.1°, 2.76 %, 4.0. Where the
//! vertex is deeper than its gap, to ask for the way out as well, so that the neighbours go along: 3.63 mm, 7.0°, 2.75
//! %, 3.8, and 1 % less bending.)
//! Four edges at a time in vectors, two fours for each vertex, took 0.063 in place of 0.091 ms for 2,996 vertices
//! (AVX2, two rounds by turns): 16 steps 0.4 ms less of a prediction of 13. With a loop over the fours nothing was
//! gained.
//! network.md §5. Twin: shaders/pull.wgsl.

use super::polish::{RATE, REACH};
use crate::cpu::repair::closest::GAP;
use crate::cpu::threads::of;
use crate::cpu::{Cpu, Kernel};
use crate::operation::Pull;
use crate::topology::Graph;
use glam::Vec3;

impl Kernel for Pull<&[f32], &mut [f32], &[u32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { offsets, neighbours, squares, positions, near, pulls } = self;
        let graph = Graph { offsets, neighbours };
        let positions = positions.as_chunks::<3>().0;
        cpu.threads.share(pulls.len() / 3, [pulls], &mut cpu.scratch, |rows, [pulls], _| {
            let mut squares = squares[offsets[rows.start] as usize..].iter();
            let pulls = pulls.as_chunks_mut::<3>().0.iter_mut().zip(of(near, &rows, 3).as_chunks::<3>().0);
            for (i, (pull, near)) in rows.zip(pulls) {
                let (neighbours, at) = (graph.of(i), Vec3::from_array(positions[i]));
                let mut sum = Vec3::ZERO;
                for (j, square) in neighbours.iter().zip(&mut squares) {
                    let along = Vec3::from_array(positions[*j as usize]) - at;
                    sum += along * (0.5 - square / (along.length_squared() + square));
                }
                *pull = followed(sum / neighbours.len().max(1) as f32, Vec3::from_array(*near)).to_array();
            }
        });
    }
}

/// As much of a pull as a vertex can follow that lacks so much to [`REACH`].
#[inline(always)]
fn followed(pull: Vec3, near: Vec3) -> Vec3 {
    let lack = near.length();
    if lack == 0.0 {
        return pull;
    }
    let (up, room) = (near / lack, (REACH - GAP - lack).max(0.0));
    pull + up * (-room / RATE - pull.dot(up)).max(0.0)
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
            // Some at their gap and deeper, some above it; every third is far from the body.
            let mut near = crate::suite::numbers(rng, 3 * n, 0.01);
            near.as_chunks_mut::<3>().0.iter_mut().step_by(3).for_each(|near| *near = [0.0; 3]);
            Self { offsets, neighbours, squares, positions, near, pulls: vec![0.0; 3 * n] }
        };
        [1, 2, 67, 257].map(&mut operand).into()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let [positions, near] = [&self.positions, &self.near].map(|it| crate::suite::points(it));
        let free = |i: usize| {
            let [start, end] = [i, i + 1].map(|i| self.offsets[i] as usize);
            let of = |k: usize| {
                let along = positions[self.neighbours[k] as usize] - positions[i];
                along * (0.5 - f64::from(self.squares[k]) / (along.length_squared() + f64::from(self.squares[k])))
            };
            (start..end).map(of).sum::<glam::DVec3>() / (end - start).max(1) as f64
        };
        let most = f64::from(REACH) - f64::from(GAP);
        let pull = |i: usize| match near[i].try_normalize() {
            Some(up) => {
                let least = -(most - near[i].length()).max(0.0) / f64::from(RATE);
                free(i) + up * (least - free(i).dot(up)).max(0.0)
            }
            None => free(i),
        };
        vec![Some((0..positions.len()).flat_map(|i| pull(i).to_array()).collect())]
    }
}
