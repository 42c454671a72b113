//! h⁰ and the edge potentials, whose differences are the edge features `e_ij`. network.md §3.

use crate::cpu::{Cpu, Kernel};
use crate::operation::Features;

impl Kernel for Features<&[f32], &mut [f32]> {
    fn run(self, _: &mut Cpu) {
        let Self { v, rest, mean, deviation, edge_scale, nodes, potentials } = self;
        let rows = v.as_chunks::<3>().0.iter().zip(rest.as_chunks::<3>().0);
        let outputs = nodes.as_chunks_mut::<3>().0.iter_mut().zip(potentials.as_chunks_mut::<6>().0);
        for ((v, rest), (node, potential)) in rows.zip(outputs) {
            for c in 0..3 {
                node[c] = (v[c] - mean[c]) / deviation[c];
                potential[c] = v[c] / edge_scale;
                potential[3 + c] = rest[c] / edge_scale;
            }
        }
    }
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Features<Vec<f32>, Vec<f32>> {
    /// Quotients up to ten.
    const TOLERANCE: f64 = 5e-6;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let mut operand = |n: usize| Self {
            v: crate::suite::numbers(rng, 3 * n, 1.0),
            rest: crate::suite::numbers(rng, 3 * n, 1.0),
            mean: [0.1, 0.9, 0.0],
            deviation: [0.3, 0.5, 0.2],
            edge_scale: 0.3,
            nodes: vec![0.0; 3 * n],
            potentials: vec![0.0; 6 * n],
        };
        [1, 67, 130].map(&mut operand).into()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let [v, rest] = [&self.v, &self.rest].map(|values| crate::suite::wide(values));
        let [mean, deviation] = [self.mean, self.deviation].map(|axes| axes.map(f64::from));
        let scale = f64::from(self.edge_scale);
        let nodes = v.iter().enumerate().map(|(i, v)| (v - mean[i % 3]) / deviation[i % 3]);
        let rows = v.as_chunks::<3>().0.iter().zip(rest.as_chunks::<3>().0);
        let potentials = rows.flat_map(|(v, rest)| v.iter().chain(rest).map(|c| c / scale).collect::<Vec<_>>());
        vec![Some(nodes.collect()), Some(potentials.collect())]
    }
}
