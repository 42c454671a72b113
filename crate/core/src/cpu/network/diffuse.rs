//! One round in which every pull is shared with the neighbours: `p_i ← a p_i + (1 - a) mean_j p_j`, so that long waves
//! grow before short ones. network.md §5. Twin: shaders/diffuse.wgsl.

use super::polish::OWN;
use crate::cpu::{Cpu, Kernel};
use crate::operation::Diffuse;
use crate::topology::Graph;
use glam::Vec3;

/// A pull [n, 3] of vertex `i`, shared with those of its neighbours.
#[inline(always)]
pub(super) fn diffused(graph: Graph<&[u32]>, pulls: &[[f32; 3]], i: usize) -> Vec3 {
    let neighbours = graph.of(i);
    let sum: Vec3 = neighbours.iter().map(|j| Vec3::from_array(pulls[*j as usize])).sum();
    Vec3::from_array(pulls[i]) * OWN + sum * ((1.0 - OWN) / neighbours.len().max(1) as f32)
}

impl Kernel for Diffuse<&[f32], &mut [f32], &[u32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { offsets, neighbours, pulls, diffused: after } = self;
        let (graph, pulls) = (Graph { offsets, neighbours }, pulls.as_chunks::<3>().0);
        cpu.threads.share(pulls.len(), [after], &mut cpu.scratch, |rows, [after], _| {
            for (i, after) in rows.zip(after.as_chunks_mut::<3>().0) {
                *after = diffused(graph, pulls, i).to_array();
            }
        });
    }
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Diffuse<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// Of pulls within a metre.
    const TOLERANCE: f64 = 1e-6;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let mut operand = |n: usize| {
            let Graph { offsets, neighbours } = Graph::new(n, &crate::suite::triangles(rng, n));
            Self { offsets, neighbours, pulls: crate::suite::numbers(rng, 3 * n, 1.0), diffused: vec![0.5; 3 * n] }
        };
        [1, 2, 67, 257].map(&mut operand).into()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let pulls = crate::suite::points(&self.pulls);
        let graph = Graph { offsets: &self.offsets[..], neighbours: &self.neighbours };
        vec![Some((0..pulls.len()).flat_map(|i| wide(graph, &pulls, i).to_array()).collect())]
    }
}

/// [`diffused`] in f64.
#[cfg(feature = "suite")]
pub(super) fn wide(graph: Graph<&[u32]>, pulls: &[glam::DVec3], i: usize) -> glam::DVec3 {
    let neighbours = graph.of(i);
    let mean = neighbours.iter().map(|j| pulls[*j as usize]).sum::<glam::DVec3>() / neighbours.len().max(1) as f64;
    f64::from(OWN) * pulls[i] + f64::from(1.0 - OWN) * mean
}
