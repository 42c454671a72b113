//! What the mesh stream sees around each vertex of the coarse cloth: the places of 16 vertices from its own, turned
//! back by its skinning, less where they are at rest. The latter are zero where the cloth moves rigidly, whichever way
//! a limb points, so what is learned of one pose holds for others: docs/decisions/training.md has figures, and what
//! else was tried. network.md §3. Twin: shaders/surround.wgsl.

use crate::cpu::threads::of;
use crate::cpu::{Cpu, Kernel};
use crate::model::surroundings::{AROUND, DIRECTIONS, INPUTS, STEPS};
use crate::operation::Surround;
use glam::{Mat3, Vec3};

/// An edge that is longer or shorter by so much counts 1.
pub const STRAIN: f32 = 0.2;

impl Kernel for Surround<&[f32], &mut [f32], &[u32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { potentials, places, joints, weights, transforms, around, nodes } = self;
        let (potentials, transforms) = (potentials.as_chunks::<6>().0, transforms.as_chunks::<12>().0);
        let width = weights.len() / potentials.len();
        cpu.threads.share(potentials.len(), [nodes], &mut cpu.scratch, |rows, [nodes], _| {
            let [joints, around] = [(joints, width), (around, AROUND)].map(|(list, width)| of(list, &rows, width));
            let slots = joints.chunks_exact(width).zip(of(weights, &rows, width).chunks_exact(width));
            let rest = of(places, &rows, 3).as_chunks::<3>().0.iter().zip(around.as_chunks::<AROUND>().0);
            let nodes = nodes.as_chunks_mut::<INPUTS>().0.iter_mut();
            for (((i, (joints, weights)), (place, around)), node) in rows.zip(slots).zip(rest).zip(nodes) {
                let back = back(joints, weights, transforms);
                let (start, seen) = node.as_chunks_mut::<3>().0.split_at_mut(2);
                start[0] = *place;
                start[1] = back.y_axis.to_array();
                let [at, at_rest] = split(&potentials[i]);
                for (a, (seen, j)) in seen.iter_mut().zip(around).enumerate() {
                    let [to, to_rest] = split(&potentials[*j as usize]);
                    let strain = back * (to - at) - (to_rest - at_rest);
                    *seen = (strain * (1.0 / (STRAIN * STEPS[a / DIRECTIONS] as f32))).to_array();
                }
            }
        });
    }
}

/// The transposed linear part of a vertex's skinning: it turns back what that turned.
#[inline(always)]
fn back(joints: &[u32], weights: &[f32], transforms: &[[f32; 12]]) -> Mat3 {
    let mut back = Mat3::ZERO;
    for (joint, weight) in joints.iter().zip(weights) {
        let [a, b, c, _, d, e, f, _, g, h, i, _] = transforms[*joint as usize];
        back += Mat3::from_cols_array(&[a, b, c, d, e, f, g, h, i]) * *weight;
    }
    back
}

/// Now and at rest.
#[inline(always)]
fn split(potential: &[f32; 6]) -> [Vec3; 2] {
    let [a, b, c, d, e, f] = *potential;
    [Vec3::new(a, b, c), Vec3::new(d, e, f)]
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Surround<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// Differences of places some ten edges away, turned and divided by 0.2.
    const TOLERANCE: f64 = 5e-5;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let mut operand = |(n, width): (usize, usize)| Self {
            potentials: crate::suite::numbers(rng, 6 * n, 1.0),
            places: crate::suite::numbers(rng, 3 * n, 1.0),
            joints: (0..n * width).map(|_| rng.u32(..5)).collect(),
            weights: crate::suite::numbers(rng, n * width, 1.0),
            transforms: (0..6).flat_map(|_| crate::suite::transform(rng)).collect(),
            around: (0..n * AROUND).map(|_| rng.u32(..n as u32)).collect(),
            nodes: vec![0.0; n * INPUTS],
        };
        [(1, 1), (67, 4), (130, 8)].map(&mut operand).into()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let [potentials, transforms, weights] =
            [&self.potentials, &self.transforms, &self.weights].map(|values| crate::suite::wide(values));
        let (n, width) = (potentials.len() / 6, weights.len() / (potentials.len() / 6));
        let mut nodes = Vec::new();
        for i in 0..n {
            // M[r][c], the linear part of the blended transform.
            let blended = |r: usize, c: usize| -> f64 {
                let slot = |s: usize| {
                    weights[i * width + s] * transforms[12 * self.joints[i * width + s] as usize + 4 * r + c]
                };
                (0..width).map(slot).sum()
            };
            nodes.extend(self.places[3 * i..3 * i + 3].iter().map(|place| f64::from(*place)));
            nodes.extend((0..3).map(|c| blended(1, c)));
            for a in 0..AROUND {
                let j = self.around[i * AROUND + a] as usize;
                let way = |axis: usize| potentials[6 * j + axis] - potentials[6 * i + axis];
                let steps = f64::from(STEPS[a / DIRECTIONS]);
                let turned = |c: usize| (0..3).map(|r| blended(r, c) * way(r)).sum::<f64>();
                nodes.extend((0..3).map(|c| (turned(c) - way(3 + c)) / (f64::from(STRAIN) * steps)));
            }
        }
        vec![Some(nodes)]
    }
}
