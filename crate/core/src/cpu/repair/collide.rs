//! How far cloth vertices must move to lie outside the posed body: the gradient of `E_B` (paper, § Penetration
//! Handling) in one step. The closest point of the body is searched by walking over its surface from a few vertices,
//! the *seeds*, kept with the model for each cloth vertex. So the result depends on the pose alone, and cloth does not
//! find parts of the body that it never came near. Twin: shaders/collide.wgsl.

#[cfg(feature = "suite")]
use super::closest::GAP;
use super::closest::{NOTHING, Posed, nearer};
use crate::cpu::threads::of;
use crate::cpu::{Cpu, Kernel};
use crate::operation::Collide;
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, dispatch};
use glam::Vec3;

/// Number of landmarks: the body's first vertices, spread evenly over it. Cloth that hangs free is searched from the
/// nearest landmark, too, if that is nearer than its seed on another part. (From its seeds alone, the back of a robe
/// did not find a foot lifted higher than in training and was 35 mm inside. With 24 landmarks a vertex stayed 2.1 mm
/// inside.)
pub const LANDMARKS: usize = 64;
/// Cloth further than this from what its seeds lead to hangs free, or is so deep inside that they are not to be
/// trusted, metres. (With 0.08 a vertex of a robe stayed 2.8 mm inside.)
pub const FREE: f32 = 0.03;
/// The last seed lies on another part of the body. That part is not searched where the seed is further away than what
/// was found by this much, metres. (It saves a fifth of the work and changes nothing.)
pub const ELSEWHERE: f32 = 0.1;

impl Kernel for Collide<&[f32], &mut [f32], &[u32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { reach, posed, normals, offsets, corners, seeds, positions, push } = self;
        let (level, rings) = (cpu.level, &mut cpu.rings);
        let body = &dispatch!(level, simd => Posed::new(simd, reach, [posed, normals], [offsets, corners], rings));
        let n = positions.len() / 3;
        let width = seeds.len() / n.max(1);
        cpu.threads.share(n, [push], &mut cpu.scratch, |rows, [push], _| {
            let (positions, seeds) = (of(positions, &rows, 3), of(seeds, &rows, width));
            dispatch!(level, simd => kernel(simd, positions, body, seeds, push));
        });
    }
}

#[inline(always)]
fn kernel<S: Simd>(simd: S, positions: &[f32], body: &Posed, seeds: &[u32], push: &mut [f32]) {
    let landmarks = Landmarks::new(body);
    let positions = positions.as_chunks::<3>().0;
    let seeds = seeds.chunks_exact(seeds.len() / positions.len().max(1));
    for ((point, seeds), push) in positions.iter().zip(seeds).zip(push.as_chunks_mut::<3>().0) {
        *push = displacement(simd, Vec3::from_array(*point), body, seeds, &landmarks).to_array();
    }
}

/// The displacement that brings `point` out of reach. Where cloth comes near another part of the body than its own, as
/// in an armpit, or hangs free, the nearer part decides. (When the part it was deeper inside of decided, as for a union
/// of parts, a search that ended on the far side of a limb threw cloth 47 mm off, and a skirt trembled by 11 % more,
/// not 1.)
#[inline(always)]
fn displacement<S: Simd>(simd: S, point: Vec3, body: &Posed, seeds: &[u32], landmarks: &Landmarks) -> Vec3 {
    let (own, other) = parted(seeds);
    let mut found = NOTHING;
    let mut start = body.nearest(point, own);
    // One call for both parts: written twice, the module of the page was 20 kB larger.
    for part in 0..2 {
        found = nearer(found, body.around(simd, point, body.walk(simd, point, start)));
        if part > 0 {
            break;
        }
        start = body.nearest(point, &[other]);
        if found.0 > FREE * FREE {
            let landmark = landmarks.nearest(simd, point);
            start = if landmark.1 < start.1 { landmark } else { start };
        } else if other == own[0] || is_elsewhere(start.1, found.0) {
            break;
        }
    }
    found.1
}

/// A vertex's own seeds, and the one on another part of the body, the first again where there is none.
#[inline(always)]
pub fn parted(seeds: &[u32]) -> (&[u32], u32) {
    (&seeds[..(seeds.len() - 1).max(1)], seeds[seeds.len() - 1])
}

/// Whether a place is too far away to lead to a part nearer than what was found: squared distances.
#[inline(always)]
pub fn is_elsewhere(place: f32, found: f32) -> bool {
    let bound = found.sqrt() + ELSEWHERE;
    place > bound * bound
}

/// Positions of the landmarks by axis, so that many are compared at once.
struct Landmarks([[f32; LANDMARKS]; 3]);

impl Landmarks {
    #[inline(always)]
    fn new(body: &Posed) -> Self {
        let mut axes = [[f32::INFINITY; LANDMARKS]; 3];
        for (i, position) in body.positions.iter().take(LANDMARKS).enumerate() {
            (0..3).for_each(|axis| axes[axis][i] = position[axis]);
        }
        Self(axes)
    }

    /// The nearest one and its squared distance.
    #[inline(always)]
    fn nearest<S: Simd>(&self, simd: S, point: Vec3) -> (u32, f32) {
        let lanes = S::f32s::LEN;
        let (px, py, pz) =
            (S::f32s::splat(simd, point.x), S::f32s::splat(simd, point.y), S::f32s::splat(simd, point.z));
        let mut best = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, f32::INFINITY));
        let [x, y, z] = &self.0;
        for first in (0..LANDMARKS).step_by(lanes) {
            let x = S::f32s::from_slice(simd, &x[first..first + lanes]) - px;
            let y = S::f32s::from_slice(simd, &y[first..first + lanes]) - py;
            let z = S::f32s::from_slice(simd, &z[first..first + lanes]) - pz;
            let squared = x.mul_add(x, y.mul_add(y, z * z));
            best = (squared.simd_lt(best.1).select(S::f32s::splat(simd, first as f32), best.0), squared.min(best.1));
        }
        let least = best.1.reduce_min();
        let lane = best.1.simd_eq(S::f32s::splat(simd, least)).to_bitmask().trailing_zeros() as usize % lanes;
        (best.0.as_slice()[lane] as u32 + lane as u32, least)
    }
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Collide<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// Metres, around a body of 50 mm: what rounding shifts the foot on the body by turns the normal there.
    const TOLERANCE: f64 = 1e-5;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let scene = suite::Scene::new(rng, 300);
        let suite::Scene { posed, normals, offsets, corners, seeds, positions, .. } = scene;
        let push = vec![0.5; positions.len()];
        let whole = Self { reach: GAP, posed, normals, offsets, corners, seeds, positions, push };
        // No triangles: nothing to keep out of.
        let bare = Self { offsets: vec![0; whole.offsets.len()], corners: Vec::new(), ..whole.clone() };
        vec![Self { reach: 0.01, ..whole.clone() }, whole, bare]
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let body = suite::Wide::new(self.reach, [&self.posed, &self.normals], [&self.offsets, &self.corners]);
        let points = crate::suite::points(&self.positions);
        let push = |point: &glam::DVec3| {
            body.foot(*point, body.nearest(*point)).map_or(glam::DVec3::ZERO, |found| found.1).to_array()
        };
        vec![Some(points.iter().flat_map(push).collect())]
    }
}

/// What the suites of [`Collide`] and [`Settle`](crate::operation::Settle) share.
#[cfg(feature = "suite")]
pub(super) mod suite {
    use crate::cpu::repair::closest::{DEPTH, FOLDED, GAP, STEEPEST};
    use crate::model::Fans;
    use crate::suite::{points, sphere};
    use glam::DVec3;

    /// A sphere, and points in and around it whose seeds are near.
    pub struct Scene {
        pub posed: Vec<f32>,
        pub normals: Vec<f32>,
        pub offsets: Vec<u32>,
        pub corners: Vec<u32>,
        pub seeds: Vec<u32>,
        pub positions: Vec<f32>,
    }

    impl Scene {
        pub fn new(rng: &mut fastrand::Rng, count: usize) -> Self {
            let (posed, triangles) = sphere(0.05, 24, 13);
            let normals = posed.iter().map(|c| c / 0.05).collect();
            let Fans { offsets, corners } = Fans::new(posed.len() / 3, &triangles);
            let (mut positions, mut seeds) = (Vec::new(), Vec::new());
            let body = points(&posed);
            while positions.len() < 3 * count {
                let point = DVec3::from_array(std::array::from_fn(|_| 0.16 * (rng.f64() - 0.5)));
                if !(0.025..0.08).contains(&point.length()) {
                    continue;
                }
                let mut near: Vec<u32> = (0..body.len() as u32).collect();
                near.sort_by(|a, b| point.distance(body[*a as usize]).total_cmp(&point.distance(body[*b as usize])));
                positions.extend(point.as_vec3().to_array());
                seeds.extend((0..4).map(|_| near[rng.usize(..20)]));
            }
            Self { posed, normals, offsets, corners, seeds, positions }
        }
    }

    /// The posed body in f64.
    pub struct Wide<'a> {
        reach: f64,
        positions: Vec<DVec3>,
        normals: Vec<DVec3>,
        offsets: &'a [u32],
        corners: &'a [u32],
    }

    impl<'a> Wide<'a> {
        pub fn new(reach: f32, [positions, normals]: [&[f32]; 2], [offsets, corners]: [&'a [u32]; 2]) -> Self {
            Self { reach: f64::from(reach), positions: points(positions), normals: points(normals), offsets, corners }
        }

        /// The nearest of all vertices.
        pub fn nearest(&self, point: DVec3) -> usize {
            let distance = |i: &usize| self.positions[*i].distance(point);
            (0..self.positions.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("a vertex")
        }

        /// The other corners of the triangles around a vertex.
        pub fn around(&self, vertex: usize) -> &[[u32; 2]] {
            &self.corners.as_chunks().0[self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize]
        }

        /// The closest point of the triangles around a vertex: the distance to it, and what brings `point` out of
        /// its reach.
        pub fn foot(&self, point: DVec3, vertex: usize) -> Option<(f64, DVec3)> {
            let a = self.positions[vertex];
            let spots = self.around(vertex).iter().map(|others| {
                let [b, c] = others.map(|i| self.positions[i as usize]);
                let (v, w) = on_triangle(point - a, b - a, c - a);
                (a + (b - a) * v + (c - a) * w, others.map(|i| self.normals[i as usize]), v, w)
            });
            let distance = |spot: &(DVec3, [DVec3; 2], f64, f64)| spot.0.distance(point);
            let (foot, [second, third], v, w) = spots.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
            let steep = self.normals[vertex] * (1.0 - v - w) + second * v + third * w;
            let (normal, away) = (steep.normalize(), point.distance(foot));
            let height = (point - foot).dot(normal);
            let beside = away > f64::from(GAP) && height.abs() < f64::from(STEEPEST) * away;
            let told = steep.length() > f64::from(FOLDED) && !beside && height >= -f64::from(DEPTH);
            let height = if height > 0.0 { away } else { height };
            told.then(|| (away, normal * (self.reach - height).max(0.0)))
        }
    }

    /// Shares of b and c of the point of the triangle 0bc that is closest to p: above it, or on the nearest edge.
    fn on_triangle(p: DVec3, b: DVec3, c: DVec3) -> (f64, f64) {
        let along = |from: DVec3, to: DVec3| ((p - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
        let across = b.cross(c);
        let (v, w) =
            (p.cross(c).dot(across) / across.length_squared(), b.cross(p).dot(across) / across.length_squared());
        if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
            return (v, w);
        }
        let on_bc = along(b, c);
        let edges = [(along(DVec3::ZERO, b), 0.0), (0.0, along(DVec3::ZERO, c)), (1.0 - on_bc, on_bc)];
        let distance = |(v, w): &(f64, f64)| (b * *v + c * *w).distance(p);
        edges.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("three edges")
    }
}
