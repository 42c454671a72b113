//! Buries the body's vertices that lie inside another part of the body, as behind a bent knee: they are moved so far
//! away that no search finds them. Cloth is pushed out at the nearest place of the body's surface, and where that place
//! is itself inside the body, cloth would be pushed to the inside. (One vertex of a skirt was pushed out of a fold
//! within a thigh, and so stayed 6.4 mm inside.) Whether a vertex is inside is told by the body's winding number, to
//! which each vertex adds as a dipole (Barill et al. 2018). Twin: shaders/bury.wgsl.

use super::collide::LANDMARKS;
use crate::cpu::{Cpu, Kernel};
use crate::operation::Bury;
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, dispatch};
use glam::Vec3;
use std::f32::consts::{PI, TAU};
use std::ops::Range;

/// How many vertices may be buried. They follow the landmarks; they are those beside which cloth was most often while
/// they were inside. (Twice as many left as much cloth inside.)
pub const BURIABLE: usize = 64;
/// How far above its own place on the surface a vertex is tested, in square roots of its area. Nearer, the dipoles
/// around it do not look like a surface. (With 0.5 a vertex of a skirt stayed 6.0 mm inside; with 0.3 the slow motion
/// of a cape trembled by 5.0 % more, not 4.8.)
pub const ABOVE: f32 = 0.4;
/// Winding number from which a vertex is buried. It is 0 outside and 1 inside; in a fold, where dipoles are near, it
/// may be anything. (One in five of the vertices buried under a skirt is outside by the exact number, in creases. With
/// 0.35 a vertex of the skirt stayed 2.2 mm inside.)
pub const INSIDE: f32 = 0.25;
/// Where a buried vertex is put: further away than any scene is wide, metres.
pub const AWAY: f32 = 1e15;

/// Solid angle of a disc of a vertex's area from [`ABOVE`] it.
fn disc() -> f32 {
    TAU * (1.0 - ABOVE / (ABOVE * ABOVE + 1.0 / PI).sqrt())
}

/// Solid angle of the other vertices from which a vertex is buried: what [`INSIDE`] asks, less its own area, a disc.
pub fn least() -> f32 {
    2.0 * TAU * INSIDE + disc()
}

/// The vertices of a body of `count` that may be buried.
pub fn buriable(count: usize) -> Range<usize> {
    LANDMARKS.min(count)..(LANDMARKS + BURIABLE).min(count)
}

/// Whether a vertex was buried.
#[inline(always)]
pub fn is_away(position: &[f32; 3]) -> bool {
    position[0] >= AWAY
}

/// Positions and normals times areas by axis, in whole registers.
#[derive(Default)]
pub struct Dipoles([Vec<f32>; 6]);

impl Kernel for Bury<&[f32], &mut [f32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { posed, normals, areas, exposed } = self;
        bury(cpu.level, posed, normals, areas, buriable(areas.len()), &mut cpu.dipoles, exposed);
    }
}

/// Positions and unit normals [b, 3], areas [b] of a posed body -> exposed [b, 3]: those of `range` that are buried are
/// [`AWAY`].
pub fn bury(
    level: Level,
    positions: &[f32],
    normals: &[f32],
    areas: &[f32],
    range: Range<usize>,
    dipoles: &mut Dipoles,
    exposed: &mut [f32],
) {
    exposed.copy_from_slice(positions);
    dipoles.pose(positions, normals, areas);
    let (normals, exposed) = (normals.as_chunks::<3>().0, exposed.as_chunks_mut::<3>().0);
    let vertices = range.filter(|vertex| areas[*vertex] > 0.0);
    dispatch!(level, simd => kernel(simd, vertices, normals, areas, dipoles, exposed));
}

#[inline(always)]
fn kernel<S: Simd>(
    simd: S,
    vertices: impl Iterator<Item = usize>,
    normals: &[[f32; 3]],
    areas: &[f32],
    dipoles: &mut Dipoles,
    exposed: &mut [[f32; 3]],
) {
    let least = least();
    for vertex in vertices {
        let height = ABOVE * areas[vertex].sqrt();
        let point = Vec3::from_array(dipoles.position(vertex)) + Vec3::from_array(normals[vertex]) * height;
        let own = dipoles.swap(vertex, [0.0; 3]);
        if dipoles.sum(simd, point) > least {
            exposed[vertex] = [AWAY; 3];
        }
        dipoles.swap(vertex, own);
    }
}

impl Dipoles {
    /// Follows the body.
    fn pose(&mut self, positions: &[f32], normals: &[f32], areas: &[f32]) {
        // Sixteen lanes are the most; a dipole without area adds nothing.
        let room = areas.len().next_multiple_of(16);
        for axis in &mut self.0 {
            axis.clear();
            axis.resize(room, 0.0);
        }
        let vertices = positions.as_chunks::<3>().0.iter().zip(normals.as_chunks::<3>().0).zip(areas);
        for (i, ((position, normal), area)) in vertices.enumerate() {
            for axis in 0..3 {
                self.0[axis][i] = position[axis];
                self.0[3 + axis][i] = normal[axis] * area;
            }
        }
    }

    fn position(&self, vertex: usize) -> [f32; 3] {
        [self.0[0][vertex], self.0[1][vertex], self.0[2][vertex]]
    }

    /// Replaces the normal of one dipole; returns the one before.
    fn swap(&mut self, vertex: usize, normal: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|axis| std::mem::replace(&mut self.0[3 + axis][vertex], normal[axis]))
    }

    /// Solid angle of all of them from a point.
    #[inline(always)]
    fn sum<S: Simd>(&self, simd: S, point: Vec3) -> f32 {
        let lanes = S::f32s::LEN;
        let [px, py, pz] = [point.x, point.y, point.z];
        let (px, py, pz) = (S::f32s::splat(simd, px), S::f32s::splat(simd, py), S::f32s::splat(simd, pz));
        let tiny = S::f32s::splat(simd, f32::MIN_POSITIVE);
        let mut sum = S::f32s::splat(simd, 0.0);
        let [x, y, z, nx, ny, nz] = &self.0;
        for first in (0..x.len()).step_by(lanes) {
            let part = first..first + lanes;
            let dx = S::f32s::from_slice(simd, &x[part.clone()]) - px;
            let dy = S::f32s::from_slice(simd, &y[part.clone()]) - py;
            let dz = S::f32s::from_slice(simd, &z[part.clone()]) - pz;
            let squared = dx.mul_add(dx, dy.mul_add(dy, dz * dz));
            let (nx, ny) = (S::f32s::from_slice(simd, &nx[part.clone()]), S::f32s::from_slice(simd, &ny[part.clone()]));
            let way = dx.mul_add(nx, dy.mul_add(ny, dz * S::f32s::from_slice(simd, &nz[part])));
            sum += way / squared.mul_add(squared.sqrt(), tiny);
        }
        sum.as_slice().iter().sum()
    }
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Bury<Vec<f32>, Vec<f32>> {
    /// What is not buried stays exactly where it is; no sum is so near the least one that rounding decides.
    const TOLERANCE: f64 = 0.0;

    fn operands(_: &mut fastrand::Rng) -> Vec<Self> {
        let operand = |raised: f32| {
            let (posed, triangles) = nested(raised);
            let (mut normals, areas) = (posed.clone(), crate::model::areas(&posed, &triangles));
            let (positions, triangles, normal) = (&posed[..], &triangles[..], &mut normals[..]);
            Cpu::new().compute(crate::operation::Normals { positions, triangles, normals: normal });
            Self { exposed: vec![0.0; posed.len()], posed, normals, areas }
        };
        // All of the smaller sphere is inside, half of it, nothing.
        [0.03, 0.11, 0.2].map(operand).into()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let (positions, normals) = (crate::suite::points(&self.posed), crate::suite::points(&self.normals));
        let areas = crate::suite::wide(&self.areas);
        let mut exposed = crate::suite::wide(&self.posed);
        for vertex in buriable(areas.len()) {
            let point = positions[vertex] + normals[vertex] * f64::from(ABOVE) * areas[vertex].sqrt();
            let angle = |i: usize| {
                let way = positions[i] - point;
                way.dot(normals[i]) * areas[i] / way.length().powi(3)
            };
            let sum: f64 = (0..areas.len()).filter(|i| *i != vertex).map(angle).sum();
            assert!((sum - f64::from(least())).abs() > 1e-3, "vertex {vertex}: {sum}");
            if sum > f64::from(least()) {
                exposed[3 * vertex..3 * vertex + 3].fill(f64::from(AWAY));
            }
        }
        vec![Some(exposed)]
    }
}

/// A sphere of 100 mm and one of 50, raised by so much, whose vertices follow the landmarks and may be buried:
/// positions, triangles.
#[cfg(feature = "suite")]
pub fn nested(raised: f32) -> (Vec<f32>, Vec<u32>) {
    let (outer, outer_faces) = crate::suite::sphere(0.1, 24, 13);
    let (inner, inner_faces) = crate::suite::sphere(0.05, 10, 7);
    let count = (inner.len() / 3) as u32;
    let raised = inner.chunks_exact(3).flat_map(|p| [p[0], p[1] + raised, p[2]]);
    let (first, rest) = outer.split_at(3 * LANDMARKS);
    let positions = first.iter().copied().chain(raised).chain(rest.iter().copied());
    let place = |i: &u32| if (*i as usize) < LANDMARKS { *i } else { *i + count };
    let triangles = outer_faces.iter().map(place).chain(inner_faces.iter().map(|i| i + LANDMARKS as u32));
    (positions.collect(), triangles.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::areas;
    use crate::operation::Normals;

    const RADIUS: f32 = 0.05;

    /// An open tube through the origin, of triangles of 20 mm.
    fn tube(axis: Vec3) -> (Vec<f32>, Vec<u32>) {
        const AROUND: u32 = 16;
        const ROWS: u32 = 30;
        let (u, v) = axis.any_orthonormal_pair();
        let point = |row: u32, i: u32| {
            let (sin, cos) = (TAU * i as f32 / AROUND as f32).sin_cos();
            (axis * (0.02 * (row as f32 - ROWS as f32 / 2.0)) + (u * cos + v * sin) * RADIUS).to_array()
        };
        let places = (0..=ROWS).flat_map(|row| (0..AROUND).map(move |i| (row, i)));
        let positions = places.clone().flat_map(|(row, i)| point(row, i)).collect();
        let at = |row: u32, i: u32| row * AROUND + i % AROUND;
        let corners = |(row, i)| {
            let [a, b, c, d] = [at(row, i), at(row, i + 1), at(row + 1, i), at(row + 1, i + 1)];
            [a, b, c, b, d, c]
        };
        (positions, places.filter(|place| place.0 < ROWS).flat_map(corners).collect())
    }

    #[test]
    fn what_is_inside_another_part_is_buried_and_nothing_else() {
        let ((mut positions, mut triangles), second) = (tube(Vec3::Y), tube(Vec3::X));
        let half = positions.len() / 3;
        positions.extend(second.0);
        triangles.extend(second.1.iter().map(|i| i + half as u32));
        let areas = areas(&positions, &triangles);
        let (mut up, mut exposed) = (vec![0.0; positions.len()], vec![0.0; positions.len()]);
        Cpu::new().compute(Normals { positions: &positions[..], triangles: &triangles[..], normals: &mut up[..] });
        bury(Level::new(), &positions, &up, &areas, 0..2 * half, &mut Dipoles::default(), &mut exposed);
        let (mut buried, mut seen) = (0, 0);
        let places = positions.as_chunks::<3>().0.iter().zip(exposed.as_chunks::<3>().0);
        for (vertex, (place, found)) in places.enumerate() {
            let [x, y, z] = *place;
            let depth = RADIUS - if vertex < half { y.hypot(z) } else { x.hypot(z) };
            if depth > 0.015 {
                buried += 1;
                assert!(is_away(found), "{place:?}, {depth} m inside the other tube, is seen");
            } else if depth < -0.005 {
                seen += 1;
                assert_eq!(place, found, "{depth} m inside the other tube");
            }
        }
        assert!(buried > 20 && seen > 500, "{buried} buried, {seen} seen");
    }
}
