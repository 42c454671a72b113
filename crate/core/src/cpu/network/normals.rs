//! Area-weighted vertex normals: the sum of the cross products of the triangles around a vertex, made unit length.

use crate::cpu::{Cpu, Kernel};
use crate::operation::Normals;

/// Twice the area, m², around a vertex that has a normal: the squares of less lose their digits in f32.
const LEAST: f32 = 1e-18;

/// Square of the least sine between two sides of a triangle that counts. Hardware that multiplies and adds at once, as
/// GPUs do, leaves the rounding of a product where sides are parallel, and it has a direction.
const PARALLEL: f32 = 1e-12;

/// +Y where a vertex has no area around it, or more than f32 can hold.
impl Kernel for Normals<&[f32], &mut [f32], &[u32]> {
    fn run(self, _: &mut Cpu) {
        let (positions, normals) = (self.positions.as_chunks::<3>().0, self.normals.as_chunks_mut::<3>().0);
        normals.fill([0.0; 3]);
        for triangle in self.triangles.as_chunks::<3>().0 {
            let [a, b, c] = triangle.map(|i| positions[i as usize]);
            let (u, v): ([f32; 3], [f32; 3]) =
                (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
            let area = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            let counts = square(&area) > PARALLEL * square(&u) * square(&v);
            let normal = if counts { area } else { [0.0; 3] };
            for i in triangle {
                let sum = &mut normals[*i as usize];
                (0..3).for_each(|c| sum[c] += normal[c]);
            }
        }
        for normal in normals {
            let length = square(normal).sqrt();
            let told = length > LEAST && length.is_finite();
            *normal = if told { normal.map(|c| c / length) } else { [0.0, 1.0, 0.0] };
        }
    }
}

fn square(v: &[f32; 3]) -> f32 {
    v.iter().map(|c| c * c).sum()
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Normals<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// Of up to 40 triangles around a vertex, most of which cancel out.
    const TOLERANCE: f64 = 1e-4;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let mut soup = |n: usize| {
            let triangles = crate::suite::triangles(rng, n);
            Self { positions: crate::suite::numbers(rng, 3 * n, 1.0), triangles, normals: vec![0.5; 3 * n] }
        };
        let soups = [1, 2, 67, 257].map(&mut soup);
        let (positions, triangles) = crate::suite::sphere(0.05, 24, 13);
        let sphere = Self { normals: vec![0.5; positions.len()], positions, triangles };
        // More area than f32 can hold, and less than its square can.
        let [huge, tiny] = [1e22, 1e-9].map(|scale| {
            let positions = sphere.positions.iter().map(|c| c * scale).collect();
            Self { positions, ..sphere.clone() }
        });
        [&soups[..], &[sphere, huge, tiny]].concat()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let points = crate::suite::points(&self.positions);
        let mut sums = vec![glam::DVec3::ZERO; points.len()];
        for triangle in self.triangles.as_chunks::<3>().0 {
            let [a, b, c] = triangle.map(|i| points[i as usize]);
            triangle.iter().for_each(|i| sums[*i as usize] += (b - a).cross(c - a));
        }
        let told = |sum: &glam::DVec3| sum.length() > f64::from(LEAST) && sum.length() < 1e38;
        let normal = |sum: &glam::DVec3| if told(sum) { sum.normalize() } else { glam::DVec3::Y };
        vec![Some(sums.iter().flat_map(|sum| normal(sum).to_array()).collect())]
    }
}
