//! `Δ[i] = Σ_j w_j B_j[i]`, the weights shared by all vertices (network.md §2) or one row per vertex (§3), and `T =
//! rest + s·Δ` (§4). The share s is 1 among the poses seen in training and where nothing is faded. Twin:
//! shaders/blend.wgsl.
//! Bases stay f32: of a coarse prediction of 5,056 vertices they take 0.03 ms natively and 0.06 ms in Chromium, where
//! f16 has no instruction.

use crate::cpu::threads::of;
use crate::cpu::vector::dot;
use crate::cpu::{Cpu, Kernel};
use crate::operation::Blend;
use fearless_simd::{Simd, dispatch};

impl Kernel for Blend<&[f32], &mut [f32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { weights, basis, rest, share, residual, template } = self;
        let (level, share, n) = (cpu.level, share[0], rest.len() / 3);
        let (count, shared) = (basis.len() / rest.len(), 3 * n * weights.len() == basis.len());
        cpu.threads.share(n, [residual, template], &mut cpu.scratch, |rows, [residual, template], _| {
            let weights = if shared { weights } else { of(weights, &rows, count) };
            dispatch!(level, simd => kernel(simd, weights, of(basis, &rows, 3 * count), residual));
            for ((template, rest), residual) in template.iter_mut().zip(of(rest, &rows, 3)).zip(residual) {
                *template = rest + share * *residual;
            }
        });
    }
}

#[inline(always)]
fn kernel<S: Simd>(simd: S, weights: &[f32], basis: &[f32], residual: &mut [f32]) {
    let count = basis.len() / residual.len();
    let shared = weights.len() == count;
    for (i, (residual, basis)) in residual.chunks_exact_mut(3).zip(basis.chunks_exact(3 * count)).enumerate() {
        let weights = if shared { weights } else { &weights[i * count..][..count] };
        for (residual, basis) in residual.iter_mut().zip(basis.chunks_exact(count)) {
            *residual = dot(simd, weights, basis);
        }
    }
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Blend<Vec<f32>, Vec<f32>> {
    /// Sums of up to 129 products below 0.1, and a rest of order one.
    const TOLERANCE: f64 = 2e-6;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        // Weights shared by all vertices or one row each; all of the residual, a part of it, none.
        let shapes = [(1, 1, true), (5, 6, false), (67, 13, true), (130, 129, false), (130, 8, false)];
        let all = shapes.into_iter().flat_map(|shape| [1.0, 0.3, 0.0].map(|share| (shape, share)));
        let mut operand = |((n, count, shared), share): ((usize, usize, bool), f32)| Self {
            weights: crate::suite::numbers(rng, if shared { count } else { n * count }, 1.0),
            basis: crate::suite::numbers(rng, 3 * n * count, 0.1),
            rest: crate::suite::numbers(rng, 3 * n, 1.0),
            share: vec![share],
            residual: vec![0.0; 3 * n],
            template: vec![0.0; 3 * n],
        };
        all.map(&mut operand).collect()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let [weights, basis, rest] = [&self.weights, &self.basis, &self.rest].map(|values| crate::suite::wide(values));
        let count = basis.len() / rest.len();
        let row = |i: usize| if weights.len() == count { 0 } else { i / 3 * count };
        let sum = |i: usize| (0..count).map(|j| weights[row(i) + j] * basis[i * count + j]).sum::<f64>();
        let residual: Vec<f64> = (0..rest.len()).map(sum).collect();
        let share = f64::from(self.share[0]);
        let template = rest.iter().zip(&residual).map(|(rest, residual)| rest + share * residual).collect();
        vec![Some(residual), Some(template)]
    }
}
