//! The drawn mesh on the cloth: `x = Σ_k b_k p_k + o n`, n the unit normal between those of the three corners.
//! network.md §5. Twin: shaders/ride.wgsl.

use crate::cpu::threads::of;
use crate::cpu::{Cpu, Kernel};
use crate::operation::Ride;

/// Normals that nearly cancel out have no direction between them; below this length none is followed.
pub const LEAST: f32 = 1e-3;

impl Kernel for Ride<&[f32], &mut [f32], &[u32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { corners, coordinates, positions, normals, riders } = self;
        let (positions, normals) = (positions.as_chunks::<3>().0, normals.as_chunks::<3>().0);
        cpu.threads.share(corners.len() / 3, [riders], &mut cpu.scratch, |rows, [riders], _| {
            let corners = of(corners, &rows, 3).as_chunks::<3>().0;
            let coordinates = of(coordinates, &rows, 4).as_chunks::<4>().0;
            let each = corners.iter().zip(coordinates).zip(riders.as_chunks_mut::<3>().0);
            for ((corners, coordinates), rider) in each {
                let [a, b, c] = corners.map(|corner| corner as usize);
                let [u, v, w, offset] = *coordinates;
                let between = |values: &[[f32; 3]]| -> [f32; 3] {
                    std::array::from_fn(|axis| u * values[a][axis] + v * values[b][axis] + w * values[c][axis])
                };
                let (foot, normal) = (between(positions), between(normals));
                let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
                let along = if length > LEAST { offset / length } else { 0.0 };
                *rider = std::array::from_fn(|axis| foot[axis] + along * normal[axis]);
            }
        });
    }
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Ride<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// Sums of three products of numbers within two.
    const TOLERANCE: f64 = 4e-6;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let mut operand = |(n, riders): (usize, usize)| {
            let coordinates = (0..riders).flat_map(|i| {
                // On corners, within triangles, and beyond their edges.
                let [u, v] = if i % 3 == 0 { [1.0, 0.0] } else { [rng.f32() * 2.0 - 0.5, rng.f32() - 0.2] };
                [u, v, 1.0 - u - v, (rng.f32() - 0.5) * 0.1]
            });
            let coordinates = coordinates.collect();
            let normals = (0..n).flat_map(|_| {
                let [x, y, z] = std::array::from_fn(|_| rng.f32() + 0.1);
                glam::Vec3::new(x, y, z).normalize().to_array()
            });
            let normals = normals.collect();
            Self {
                corners: (0..3 * riders).map(|_| rng.u32(..n as u32)).collect(),
                coordinates,
                positions: crate::suite::numbers(rng, 3 * n, 1.0),
                normals,
                riders: vec![0.0; 3 * riders],
            }
        };
        let plain = [(1, 1), (5, 3), (67, 130)].map(&mut operand);
        // Normals that cancel out carry nothing.
        let mut folded = operand((2, 1));
        folded.corners = vec![0, 1, 1];
        folded.coordinates = vec![0.5, 0.25, 0.25, 0.1];
        folded.normals = vec![0.0, 1.0, 0.0, 0.0, -1.0, 0.0];
        [&plain[..], &[folded]].concat()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let (positions, normals) = (crate::suite::points(&self.positions), crate::suite::points(&self.normals));
        let rider = |(corners, coordinates): (&[u32; 3], &[f32; 4])| {
            let [u, v, w, offset] = coordinates.map(f64::from);
            let [a, b, c] = corners.map(|corner| corner as usize);
            let between = |values: &[glam::DVec3]| values[a] * u + values[b] * v + values[c] * w;
            let normal = between(&normals);
            let along =
                if normal.length() > f64::from(LEAST) { normal.normalize() * offset } else { glam::DVec3::ZERO };
            (between(&positions) + along).to_array()
        };
        let riders = self.corners.as_chunks::<3>().0.iter().zip(self.coordinates.as_chunks::<4>().0);
        vec![Some(riders.flat_map(rider).collect())]
    }
}
