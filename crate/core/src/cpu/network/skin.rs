//! Linear blend skinning `x_i = Σ_j W[i,j] A_j T_i`, then `N⁻¹` where the world is wanted. network.md §4.

use crate::cpu::threads::of;
use crate::cpu::{Cpu, Kernel};
use crate::operation::{Skin, Space};
use fearless_simd::{Simd, SimdBase, SimdFloat, dispatch, f32x4};

impl Kernel for Skin<&[f32], &mut [f32], &[u32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { rest, joints, weights, transforms, space, positions } = self;
        let (level, n) = (cpu.level, rest.len() / 3);
        let width = weights.len() / n;
        cpu.threads.share(n, [positions], &mut cpu.scratch, |rows, [positions], _| {
            let (joints, weights) = (of(joints, &rows, width), of(weights, &rows, width));
            let rest = of(rest, &rows, 3);
            dispatch!(level, simd => kernel(simd, rest, joints, weights, transforms, space, positions));
        });
    }
}

#[inline(always)]
fn kernel<S: Simd>(
    simd: S,
    rest: &[f32],
    joints: &[u32],
    weights: &[f32],
    transforms: &[f32],
    space: Space,
    positions: &mut [f32],
) {
    let transforms = transforms.as_chunks::<12>().0;
    let back: &[[f32; 4]] = transforms[transforms.len() - 1].as_chunks().0;
    let (rest, positions) = (rest.as_chunks::<3>().0, positions.as_chunks_mut::<3>().0);
    let width = weights.len() / rest.len();
    let slots = joints.chunks_exact(width).zip(weights.chunks_exact(width));
    for ((rest, position), (joints, weights)) in rest.iter().zip(positions).zip(slots) {
        let mut rows = [f32x4::splat(simd, 0.0); 3];
        for (joint, weight) in joints.iter().zip(weights) {
            let (transform, weight) = (&transforms[*joint as usize], f32x4::splat(simd, *weight));
            for r in 0..3 {
                rows[r] = f32x4::from_slice(simd, &transform[4 * r..][..4]).mul_add(weight, rows[r]);
            }
        }
        // No closures: natively they were not compiled for the level, which took twice the time.
        let rows = [rows[0].as_array(), rows[1].as_array(), rows[2].as_array()];
        let [x, y, z] = [apply(rows[0], rest), apply(rows[1], rest), apply(rows[2], rest)];
        let blended = [x, y, z];
        *position = match space {
            Space::Body => blended,
            Space::World => [apply(&back[0], &blended), apply(&back[1], &blended), apply(&back[2], &blended)],
        };
    }
}

/// One row of a 3×4 transform applied to a point.
#[inline(always)]
fn apply(row: &[f32; 4], point: &[f32; 3]) -> f32 {
    row[0] * point[0] + row[1] * point[1] + row[2] * point[2] + row[3]
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Skin<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// Two transforms, one after the other, of places within two metres.
    const TOLERANCE: f64 = 5e-6;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let shapes = [(1, 1, 1), (5, 3, 2), (67, 5, 3), (130, 65, 9)];
        let both = shapes.into_iter().flat_map(|shape| [Space::Body, Space::World].map(|space| (shape, space)));
        let mut operand = |((n, joints, width), space): ((usize, usize, usize), Space)| Self {
            rest: crate::suite::numbers(rng, 3 * n, 1.0),
            joints: (0..n * width).map(|_| rng.u32(..joints as u32)).collect(),
            // They need not add up to one, and some are negative.
            weights: (0..n * width).map(|_| (rng.f32() + 0.4) / width as f32 - 0.1).collect(),
            transforms: (0..=joints).flat_map(|_| crate::suite::transform(rng)).collect(),
            space,
            positions: vec![0.0; 3 * n],
        };
        both.map(&mut operand).collect()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let (rest, transforms) = (crate::suite::points(&self.rest), crate::suite::wide(&self.transforms));
        let width = self.weights.len() / rest.len();
        let apply = |transform: usize, point: glam::DVec3| {
            let row = |r: usize| glam::DVec4::from_slice(&transforms[12 * transform + 4 * r..]).dot(point.extend(1.0));
            glam::DVec3::new(row(0), row(1), row(2))
        };
        let place = |(i, point): (usize, &glam::DVec3)| {
            let slots = i * width..(i + 1) * width;
            let sum = slots.map(|slot| f64::from(self.weights[slot]) * apply(self.joints[slot] as usize, *point)).sum();
            let back = transforms.len() / 12 - 1;
            if self.space == Space::World { apply(back, sum) } else { sum }
        };
        vec![Some(rest.iter().enumerate().flat_map(|entry| place(entry).to_array()).collect())]
    }
}
