//! The closest point of a posed body, searched over its surface. Twins: shaders/collide.foot.wgsl, collide.walk.wgsl.

use super::eight::{closest_on_triangles, dot, from, least, place_of_least, splat};
use super::rings::{RING, Rings};
use fearless_simd::{Select, Simd, SimdBase, f32x8, u32x8};
use glam::Vec3;

/// Distance at which cloth is kept from the body, metres. (With 3 mm, which simulated cloth keeps less often, a
/// repaired T-shirt was strained by 1.31 % in place of 1.25, and had 1.64 times the simulation's energy, not 1.45.)
pub const GAP: f32 = 0.002;
/// Cloth deeper inside than this is left where it is, metres: so deep, the nearest surface does not tell where the
/// cloth belongs. (With half of it, single vertices stayed inside an obstacle where the prediction was worst.)
pub const DEPTH: f32 = 0.12;
/// Steps of the walk over the body's surface.
pub const STEPS: usize = 12;
/// Least cosine between the direction to the closest point and the normal there. Where it is less, the point lies
/// beside the border of an open body.
pub const STEEPEST: f32 = 0.5;
/// An interpolated normal shorter than this is that of a body folded onto itself: opposite normals cancel out.
pub const FOLDED: f32 = 1e-3;

/// The posed body: positions and unit normals [b, 3], and the triangles around each vertex.
pub struct Posed<'a> {
    /// Positions, metres [b, 3].
    pub positions: &'a [[f32; 3]],
    /// Unit vertex normals [b, 3].
    pub normals: &'a [[f32; 3]],
    /// Where the triangles around each vertex start in `fans` [b + 1].
    pub offsets: &'a [u32],
    /// The other two corners of each triangle around a vertex, in the triangle's order [3t, 2].
    pub fans: &'a [[u32; 2]],
    /// The same neighbours, eight at once.
    pub rings: &'a Rings,
    /// How far above it a point has room, metres.
    pub reach: f32,
}

/// A body vertex and the squared distance to it.
pub type Place = (u32, f32);

/// What a search found: squared distance to the body, infinite where there is none, and the displacement that makes
/// room.
pub type Found = (f32, Vec3);

/// No body.
pub const NOTHING: Found = (f32::INFINITY, Vec3::ZERO);

/// The one that is closer to its body.
#[inline(always)]
pub fn nearer(a: Found, b: Found) -> Found {
    if b.0 < a.0 { b } else { a }
}

impl<'a> Posed<'a> {
    /// The body at these positions and unit normals [b, 3], with the fans of its triangles, out of whose reach cloth is
    /// wanted; `rings` are posed with it.
    #[inline(always)]
    pub fn new<S: Simd>(
        simd: S,
        reach: f32,
        [positions, normals]: [&'a [f32]; 2],
        [offsets, corners]: [&'a [u32]; 2],
        rings: &'a mut Rings,
    ) -> Self {
        rings.pose(simd, positions, normals, offsets, corners);
        let (positions, normals, fans) = (positions.as_chunks().0, normals.as_chunks().0, corners.as_chunks().0);
        Self { positions, normals, offsets, fans, rings, reach }
    }

    #[inline(always)]
    fn position(&self, vertex: u32) -> Vec3 {
        Vec3::from_array(self.positions[vertex as usize])
    }

    #[inline(always)]
    fn normal(&self, vertex: u32) -> Vec3 {
        Vec3::from_array(self.normals[vertex as usize])
    }

    /// The other two corners of the triangles around a vertex.
    #[inline(always)]
    fn fan(&self, vertex: u32) -> &[[u32; 2]] {
        &self.fans[self.offsets[vertex as usize] as usize..self.offsets[vertex as usize + 1] as usize]
    }

    /// The nearest of some vertices.
    #[inline(always)]
    pub fn nearest(&self, point: Vec3, vertices: &[u32]) -> Place {
        let mut best = (vertices[0], f32::INFINITY);
        for vertex in vertices {
            best = closer(best, *vertex, point.distance_squared(self.position(*vertex)));
        }
        best
    }

    /// The nearest vertex downhill from one.
    #[inline(always)]
    pub fn walk<S: Simd>(&self, simd: S, point: Vec3, start: Place) -> Place {
        let mut best = start;
        for _ in 0..STEPS {
            let next = self.step(simd, point, best);
            if next.0 == best.0 {
                break;
            }
            best = next;
        }
        best
    }

    /// The same from the nearest neighbour of a neighbour: over a ridge, into the crease behind it.
    #[inline(always)]
    pub fn leap<S: Simd>(&self, simd: S, point: Vec3, start: Place) -> Place {
        let (mut nearest, mut which) = (f32x8::splat(simd, start.1), u32x8::splat(simd, start.0));
        for corners in self.fan(start.0) {
            for ring in self.rings.of(corners[0]) {
                let ways = ring.from(simd, point);
                let all = dot(ways, ways);
                let closer = all.simd_lt(nearest);
                nearest = closer.select(all, nearest);
                which = closer.select(u32x8::from_slice(simd, &ring.vertices), which);
            }
        }
        let (place, squared) = least(simd, nearest);
        let vertex = which.as_slice()[place];
        if vertex == start.0 { start } else { self.walk(simd, point, (vertex, squared)) }
    }

    /// The nearest neighbour of the best vertex so far, if it is nearer.
    #[inline(always)]
    fn step<S: Simd>(&self, simd: S, point: Vec3, start: Place) -> Place {
        let mut best = start;
        for ring in self.rings.of(start.0) {
            let ways = ring.from(simd, point);
            let (place, squared) = least(simd, dot(ways, ways));
            if squared < best.1 {
                best = (ring.vertices[place], squared);
            }
        }
        best
    }

    /// The body around the end of a walk; there is room, without a closer look, above all the triangles there.
    #[inline(always)]
    pub fn around<S: Simd>(&self, simd: S, point: Vec3, (vertex, squared): Place) -> Found {
        let (at, up) = (self.position(vertex), self.normal(vertex));
        let room = (point - at).dot(up) - self.reach;
        if room > self.rings.top(vertex) { (squared, Vec3::ZERO) } else { self.foot(simd, point, vertex) }
    }

    /// The closest of the triangles around a vertex; where the point is beside them, of those around its neighbours.
    /// (Always looking at the neighbours' triangles as well left as much inside, for seven times the work.)
    #[inline(always)]
    pub fn widely<S: Simd>(&self, simd: S, point: Vec3, vertex: u32) -> Found {
        let mut found = NOTHING;
        let neighbours = self.fan(vertex).iter().map(|corners| corners[0]);
        for (place, at) in std::iter::once(vertex).chain(neighbours).enumerate() {
            found = nearer(found, self.foot(simd, point, at));
            if place == 0 && found.0 < f32::INFINITY {
                break;
            }
        }
        found
    }

    /// The closest of the triangles around a vertex.
    /// Tried and rejected:
    /// - to take a block of cloth vertices through each step of the search together: natively it saved 6 % of the
    ///   repair, in Chromium nothing;
    /// - to go on from the closest triangle to those around it, or around the corner next to a foot on the rim: slow
    ///   motion of a cape trembled as before, and as much was left inside;
    /// - to keep deep vertices on one side of a thin leg, the side of the first seed's normal, of the cloth's own
    ///   normal or of the neighbours' pushes: no steadier, as cloth that a leg passes through must change sides
    ///   somewhere;
    /// - to take skin that is inside another part of the body out of the search: cloth in an armpit was thrown out
    ///   by 20 to 80 mm; or to leave cloth beside it where it is: more stayed inside (docs/decisions/repair.md);
    /// - to push straight to the closest point, not along the interpolated normal: cloth trembles much more (8 %
    ///   instead of 5 and of 2 %).
    #[inline(always)]
    fn foot<S: Simd>(&self, simd: S, point: Vec3, vertex: u32) -> Found {
        let Some((foot, normal)) = self.closest(simd, point, vertex) else { return NOTHING };
        let (height, distance) = ((point - foot).dot(normal), point.distance(foot));
        let beside = distance > GAP && height.abs() < STEEPEST * distance;
        if beside || height < -DEPTH {
            return NOTHING;
        }
        // Outside, the height is the distance itself: cloth with room must not move, whatever the normals at a ridge
        // are.
        let height = if height > 0.0 { distance } else { height };
        (distance * distance, normal * (self.reach - height).max(0.0))
    }

    /// The closest point of the triangles around a vertex, and the interpolated unit normal there.
    #[inline(always)]
    fn closest<S: Simd>(&self, simd: S, point: Vec3, vertex: u32) -> Option<(Vec3, Vec3)> {
        let a = self.position(vertex);
        let mut best = (f32::INFINITY, [vertex; 2], [0.0; 2]);
        let fans = self.fan(vertex).chunks(RING);
        for ((ring, third), fan) in self.rings.of(vertex).iter().zip(self.rings.thirds(vertex)).zip(fans) {
            let (ab, ac) = (ring.from(simd, a), from(simd, a, third));
            let [squared, b, c] = closest_on_triangles(simd, splat(simd, point - a), ab, ac);
            let place = place_of_least(simd, squared);
            let squared = squared.as_slice()[place];
            // Places without a triangle hold one without extent, no closer than the vertex itself.
            if squared < best.0 && place < fan.len() {
                best = (squared, fan[place], [b.as_slice()[place], c.as_slice()[place]]);
            }
        }
        let (_, [second, third], [b, c]) = best;
        let way = (self.position(second) - a) * b + (self.position(third) - a) * c;
        let sum = self.normal(vertex) * (1.0 - b - c) + self.normal(second) * b + self.normal(third) * c;
        // Where a body is folded onto itself it has no outside.
        let length = sum.length();
        (best.0 < f32::INFINITY && length > FOLDED).then(|| (a + way, sum / length))
    }
}

/// The nearer of two vertices, without branches: which one it is cannot be foretold.
#[inline(always)]
fn closer(best: Place, vertex: u32, squared: f32) -> Place {
    (if squared < best.1 { vertex } else { best.0 }, squared.min(best.1))
}
