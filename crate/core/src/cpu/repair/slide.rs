//! One round in which cloth that was pushed out of the body takes back the lengths it was cut to, as in a step of the
//! polish, and what must move still reaches its gap: a sleeve that is pushed out all around an arm is not stretched,
//! but drawn over it. (Four rounds after two of [`Spread`](crate::operation::Spread): a repaired T-shirt is strained by
//! 1.20 % in place of 1.25, by 1.22 with two rounds, by 1.18 with eight.) Twin: shaders/slide.wgsl.

use crate::cpu::{Cpu, Kernel};
use crate::operation::Slide;
use crate::topology::Graph;
use glam::Vec3;

/// w of the polish, far below [`its`](crate::cpu::network::polish::RATE): pulls are not shared here.
pub const RATE: f32 = 2.0;

impl Kernel for Slide<&[f32], &mut [f32], &[u32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { offsets, neighbours, squares, share, positions, push, before, after } = self;
        let graph = Graph { offsets, neighbours };
        let [positions, push, before] = [positions, push, before].map(|points| points.as_chunks::<3>().0);
        let displaced = |i: usize| Vec3::from_array(positions[i]) + Vec3::from_array(before[i]);
        let rate = share[0] * RATE;
        cpu.threads.share(before.len(), [after], &mut cpu.scratch, |rows, [after], _| {
            let mut squares = squares[offsets[rows.start] as usize..].iter();
            for (i, after) in rows.zip(after.as_chunks_mut::<3>().0) {
                let (neighbours, at) = (graph.of(i), displaced(i));
                let mut sum = Vec3::ZERO;
                for (j, square) in neighbours.iter().zip(&mut squares) {
                    let along = displaced(*j as usize) - at;
                    sum += along * (0.5 - square / (along.length_squared() + square));
                }
                let by = Vec3::from_array(before[i]) + sum * (rate / neighbours.len().max(1) as f32);
                let push = Vec3::from_array(push[i]);
                let missing = match push.length_squared() {
                    0.0 => 0.0,
                    needed => (1.0 - by.dot(push) / needed).max(0.0),
                };
                *after = (by + push * missing).to_array();
            }
        });
    }
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Slide<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// Metres; edges of about a metre, and quotients of two displacements of millimetres.
    const TOLERANCE: f64 = 2e-6;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let mut operand = |(n, share): (usize, f32)| {
            let Graph { offsets, neighbours } = Graph::new(n, &crate::suite::triangles(rng, n));
            let squares = neighbours.iter().map(|_| 0.01 + rng.f32()).collect();
            // Most vertices need nothing.
            let mut push = crate::suite::numbers(rng, 3 * n, 0.01);
            push.as_chunks_mut::<3>().0.iter_mut().skip(1).step_by(3).for_each(|push| *push = [0.0; 3]);
            let (positions, before) = (crate::suite::numbers(rng, 3 * n, 1.0), crate::suite::numbers(rng, 3 * n, 0.01));
            Self { offsets, neighbours, squares, share: vec![share], positions, push, before, after: vec![0.0; 3 * n] }
        };
        [(1, 1.0), (2, 0.3), (67, 1.0), (257, 0.0), (257, 1.0)].map(&mut operand).into()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let [positions, push, before] =
            [&self.positions, &self.push, &self.before].map(|points| crate::suite::points(points));
        let after = |i: usize| {
            let [start, end] = [i, i + 1].map(|i| self.offsets[i] as usize);
            let pull = |k: usize| {
                let (j, square) = (self.neighbours[k] as usize, f64::from(self.squares[k]));
                let along = positions[j] + before[j] - positions[i] - before[i];
                along * (0.5 - square / (along.length_squared() + square))
            };
            let pulls = (start..end).map(pull).sum::<glam::DVec3>() / (end - start).max(1) as f64;
            let by = before[i] + f64::from(self.share[0]) * f64::from(RATE) * pulls;
            let needed = push[i].length_squared();
            let missing = if needed > 0.0 { (1.0 - by.dot(push[i]) / needed).max(0.0) } else { 0.0 };
            by + push[i] * missing
        };
        vec![Some((0..push.len()).flat_map(|i| after(i).to_array()).collect())]
    }
}
