//! The drawn surface: every drawn vertex has the position and normal of its cloth vertex. Twin: shaders/surface.wgsl.

use crate::cpu::{Cpu, Kernel};
use crate::operation::Surface;

impl Kernel for Surface<&[f32], &mut [f32], &[u32]> {
    fn run(self, _: &mut Cpu) {
        for (values, drawn) in [(self.positions, self.drawn_positions), (self.normals, self.drawn_normals)] {
            let values = values.as_chunks::<3>().0;
            for (drawn, vertex) in drawn.as_chunks_mut::<3>().0.iter_mut().zip(self.vertex) {
                *drawn = values[*vertex as usize];
            }
        }
    }
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Surface<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// Numbers are copied.
    const TOLERANCE: f64 = 0.0;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let mut operand = |(n, drawn): (usize, usize)| Self {
            vertex: (0..drawn).map(|_| rng.u32(..n as u32)).collect(),
            positions: crate::suite::numbers(rng, 3 * n, 1.0),
            normals: crate::suite::numbers(rng, 3 * n, 1.0),
            drawn_positions: vec![0.0; 3 * drawn],
            drawn_normals: vec![0.0; 3 * drawn],
        };
        [(1, 1), (5, 3), (67, 130)].map(&mut operand).into()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let drawn = |values: &[f32]| {
            let values = crate::suite::points(values);
            Some(self.vertex.iter().flat_map(|vertex| values[*vertex as usize].to_array()).collect())
        };
        vec![drawn(&self.positions), drawn(&self.normals)]
    }
}
