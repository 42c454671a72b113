//! The polish, all its steps at once, without a body: `x_(k+1) = x_k + w S² p(x_k) + μ_k (x_k - x_(k-1))`, μ_0 = 0,
//! where `S = a 1 + (1 - a) mean_j` shares with the neighbours, `p = mean_j h(x_j - x_i)`, and
//! `h(d) = d (½ - l̄² / (d² + l̄²))` has the derivative `H = (½ - l̄² q) 1 + 2 l̄² q² d dᵀ`, `q = 1 / (d² + l̄²)`.
//!
//! Backwards, with λ_k the gradient towards x_k: `λ_k = (1 + μ_k) λ_(k+1) - μ_(k+1) λ_(k+2) + w Jᵀ Sᵀ² λ_(k+1)`,
//! where `(Jᵀ λ)_i = Σ_j H_ij (λ_j / degree_j - λ_i / degree_i)`.

use super::super::tape::{Id, IndexId, Shared, Step, Tape};
use ctsn_core::cpu::Cpu;
use ctsn_core::cpu::network::polish::{MOMENTUM, OWN, RATE};
use ctsn_core::operation::{Diffuse, Polish, Pull};
use ctsn_core::topology::Graph;
use glam::Vec3;

/// How the garment was cut.
#[derive(Clone, Copy)]
pub struct Cut<'a> {
    /// Its edges.
    pub graph: Graph<&'a [u32]>,
    /// Their squared lengths, in the order of the neighbours.
    pub squares: &'a [f32],
}

/// The same on the tape.
#[derive(Clone, Copy)]
pub struct Recorded {
    /// Where the neighbours of each vertex start.
    pub offsets: IndexId,
    /// Neighbours.
    pub neighbours: IndexId,
    /// Squared lengths of the edges to them.
    pub squares: Id,
}

impl Recorded {
    pub(in crate::training) fn of<'a>(&self, tape: &'a Tape, shared: &'a Shared) -> Cut<'a> {
        let [offsets, neighbours] = [self.offsets, self.neighbours].map(|id| tape.indices_of(id));
        Cut { graph: Graph { offsets, neighbours }, squares: shared.get(self.squares) }
    }
}

impl Tape {
    /// from [n, 3], of so many numbers -> polished [n, 3].
    pub fn polish(&mut self, cut: Recorded, from: &Id, length: usize, steps: usize) -> Id {
        let [trail, polished] = [steps * length, length].map(|length| self.buffer(&vec![0.0; length]));
        self.keep("polish", Step::Polish { cut, from: *from, trail, polished }, vec![*from], vec![trail, polished]);
        polished
    }
}

/// from [n, 3] -> what each step starts from, [steps, n, 3], and the last one's result [n, 3].
pub fn forward(cpu: &mut Cpu, cut: &Cut, from: &[f32], trail: &mut [f32], polished: &mut [f32]) {
    let Cut { graph: Graph { offsets, neighbours }, squares } = *cut;
    let [mut pulls, mut diffused, mut moves, mut near] = [0; 4].map(|_| vec![0.0; from.len()]);
    polished.copy_from_slice(from);
    for (k, start) in trail.chunks_exact_mut(from.len()).enumerate() {
        start.copy_from_slice(polished);
        let pull = Pull { offsets, neighbours, squares, positions: &*start, near: &near[..], pulls: &mut pulls[..] };
        cpu.compute(pull);
        cpu.compute(Diffuse { offsets, neighbours, pulls: &pulls[..], diffused: &mut diffused[..] });
        let (share, pulls, moves) = (&[1.0][..], &diffused[..], &mut moves[..]);
        // Nothing is near, so which way the cloth faces does not matter.
        let (first, facing, near, positions) = (k == 0, &*start, &mut near[..], &mut *polished);
        cpu.compute(Polish { offsets, neighbours, share, first, facing, pulls, moves, near, positions });
    }
}

/// g [n, 3] towards the result -> dfrom (added to).
pub fn backward(cut: &Cut, trail: &[f32], g: &[f32], dfrom: &mut [f32]) {
    let g = g.as_chunks::<3>().0;
    let mut after: Vec<Vec3> = vec![Vec3::ZERO; g.len()];
    let mut current: Vec<Vec3> = g.iter().map(|g| Vec3::from_array(*g)).collect();
    let (mut once, mut twice) = (after.clone(), after.clone());
    let degree = |i: usize| cut.graph.of(i).len().max(1) as f32;
    // Sᵀ
    let share = |from: &[Vec3], to: &mut [Vec3]| {
        for (i, to) in to.iter_mut().enumerate() {
            let others: Vec3 = cut.graph.of(i).iter().map(|j| from[*j as usize] / degree(*j as usize)).sum();
            *to = from[i] * OWN + others * (1.0 - OWN);
        }
    };
    let mut momentum = 0.0;
    for (k, x) in trail.chunks_exact(3 * g.len()).enumerate().rev() {
        let x = x.as_chunks::<3>().0;
        share(&current, &mut once);
        share(&once, &mut twice);
        twice.iter_mut().enumerate().for_each(|(i, by)| *by *= RATE / degree(i));
        let here = if k > 0 { MOMENTUM } else { 0.0 };
        let mut squares = cut.squares.iter();
        for (i, after) in after.iter_mut().enumerate() {
            let at = Vec3::from_array(x[i]);
            let mut sum = current[i] * (1.0 + here) - *after * momentum;
            for (j, square) in cut.graph.of(i).iter().zip(&mut squares) {
                let along = Vec3::from_array(x[*j as usize]) - at;
                let by = twice[*j as usize] - twice[i];
                let q = 1.0 / (along.length_squared() + square);
                sum += by * (0.5 - square * q) + along * (2.0 * square * q * q * along.dot(by));
            }
            *after = sum;
        }
        std::mem::swap(&mut after, &mut current);
        momentum = here;
    }
    for (d, by) in dfrom.as_chunks_mut::<3>().0.iter_mut().zip(current) {
        *d = (Vec3::from_array(*d) + by).to_array();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ctsn_core::topology::Graph;

    #[test]
    fn its_gradient_is_that_of_central_differences() {
        let mut rng = fastrand::Rng::with_seed(3);
        // A strip of 12 triangles.
        let triangles: Vec<u32> = (0..12).flat_map(|i| [i, i + 1 + i % 2, i + 2 - i % 2]).collect();
        let Graph { offsets, neighbours } = Graph::new(14, &triangles);
        let squares: Vec<f32> = (0..14)
            .flat_map(|i| neighbours[offsets[i] as usize..offsets[i + 1] as usize].iter().map(move |j| i + *j as usize))
            .map(|sum| 0.5 + 0.01 * sum as f32)
            .collect();
        let cut = Cut { graph: Graph { offsets: &offsets, neighbours: &neighbours }, squares: &squares };
        let [from, g, noise] = [0; 3].map(|_| (0..42).map(|_| rng.f32() * 2.0 - 1.0).collect::<Vec<f32>>());
        let (mut trail, mut polished, mut gradient) = (vec![0.0; 6 * 42], vec![0.0; 42], vec![0.0; 42]);
        forward(&mut Cpu::new(), &cut, &from, &mut trail, &mut polished);
        backward(&cut, &trail, &g, &mut gradient);
        let product = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| f64::from(a * b)).sum::<f64>();
        let length = product(&gradient, &gradient).sqrt() as f32;
        let direction: Vec<f32> = gradient.iter().zip(&noise).map(|(g, noise)| g / length + 0.1 * noise).collect();
        let mut at = |step: f32| {
            let moved: Vec<f32> = from.iter().zip(&direction).map(|(x, d)| x + step * d).collect();
            forward(&mut Cpu::new(), &cut, &moved, &mut trail, &mut polished);
            product(&polished, &g)
        };
        let difference = (at(2e-3) - at(-2e-3)) / 4e-3;
        let analytic = product(&gradient, &direction);
        assert!((difference - analytic).abs() < 5e-3 * analytic.abs(), "{difference} against {analytic}");
    }
}
