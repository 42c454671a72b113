//! One round of spreading a displacement over the cloth, so that what is pushed out of the body leaves no dent: every
//! vertex follows its neighbours, and those that must move still reach their gap. Twin: shaders/spread.wgsl.

use crate::cpu::{Cpu, Kernel};
use crate::operation::Spread;
use crate::topology::Graph;
use glam::Vec3;

/// Share of its neighbours' mean displacement that a vertex takes over in a round.
/// Tried and rejected: to take over at most 10 mm from each neighbour, since legs that pass through a cape throw all
/// around them to and fro. Slow motion of three capes trembled by 4.7 to 5.6 % more, not 5.1 to 6.0, but edges of a box
/// and arms in sleeves showed between the vertices.
pub const FOLLOW: f32 = 0.7;

impl Kernel for Spread<&[f32], &mut [f32], &[u32]> {
    fn run(self, _: &mut Cpu) {
        let graph = Graph { offsets: self.offsets, neighbours: self.neighbours };
        let (push, before) = (self.push.as_chunks::<3>().0, self.before.as_chunks::<3>().0);
        for (i, after) in self.after.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            let neighbours = graph.of(i);
            let sum: Vec3 = neighbours.iter().map(|j| Vec3::from_array(before[*j as usize])).sum();
            let mean = sum * (FOLLOW / neighbours.len().max(1) as f32);
            let push = Vec3::from_array(push[i]);
            let missing = match push.length() {
                0.0 => 0.0,
                needed => (1.0 - mean.dot(push) / (needed * needed)).max(0.0),
            };
            *after = (mean + push * missing).to_array();
        }
    }
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Spread<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// Metres; displacements of millimetres, and quotients of two of them.
    const TOLERANCE: f64 = 1e-8;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let mut operand = |n: usize| {
            let Graph { offsets, neighbours } = Graph::new(n, &crate::suite::triangles(rng, n));
            // Most vertices need nothing.
            let mut push = crate::suite::numbers(rng, 3 * n, 0.01);
            push.as_chunks_mut::<3>().0.iter_mut().skip(1).step_by(3).for_each(|push| *push = [0.0; 3]);
            Self { offsets, neighbours, push, before: crate::suite::numbers(rng, 3 * n, 0.01), after: vec![0.0; 3 * n] }
        };
        [1, 2, 67, 257].map(&mut operand).into()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let (push, before) = (crate::suite::points(&self.push), crate::suite::points(&self.before));
        let after = |i: usize| {
            let neighbours = &self.neighbours[self.offsets[i] as usize..self.offsets[i + 1] as usize];
            let sum: glam::DVec3 = neighbours.iter().map(|j| before[*j as usize]).sum();
            let mean = sum * f64::from(FOLLOW) / neighbours.len().max(1) as f64;
            let needed = push[i].length_squared();
            let missing = if needed > 0.0 { (1.0 - mean.dot(push[i]) / needed).max(0.0) } else { 0.0 };
            mean + push[i] * missing
        };
        vec![Some((0..push.len()).flat_map(|i| after(i).to_array()).collect())]
    }
}
