//! How far cloth vertices must move to lie outside the posed body: the gradient of `E_B` (paper, § Penetration Handling) in one step.
//! The closest body point is searched by walking over the body's surface from a few seeds kept with the model, so that it depends on
//! nothing but the pose, and cloth does not find a part of the body that it never came near. Twin: shaders/collide.wgsl.

use fearless_simd::{Level, Simd, dispatch};
use glam::Vec3;

/// Distance at which cloth is kept from the body, metres.
pub const GAP: f32 = 0.003;
/// Cloth further inside is not moved, metres: that far, the nearest skin says nothing about where the cloth belongs. (With half of it,
/// single vertices stayed inside an obstacle where the prediction was worst.)
pub const DEPTH: f32 = 0.12;
/// Steps of the walk over the body's surface.
pub const STEPS: usize = 12;
/// Least cosine between the way to the closest point and the normal there; less is beside the border of an open body.
pub const STEEPEST: f32 = 0.5;

/// The body's first vertices, spread evenly over it: cloth that hangs free is searched from the nearest of them, too. (From its own
/// places alone, the back of a robe did not find a foot lifted higher than in training: 35 mm inside. 24 of them cost it 0.2 ms of 2.9 less,
/// and left a vertex 2.1 mm inside.)
pub const LANDMARKS: usize = 64;
/// Distance from its own places beyond which cloth hangs free, or is too deep inside to trust them, metres. (With 0.08, a robe kept a
/// vertex 2.8 mm inside.)
pub const FREE: f32 = 0.03;

/// A triangle whose angle at a corner has a smaller squared sine is taken for its edges.
pub const SLIVER: f32 = 1e-6;
/// Length of an interpolated unit normal up to which the body is folded onto itself there.
pub const FOLDED: f32 = 1e-3;

/// The first vertices of the body.
static EVENLY: [u32; LANDMARKS] = {
    let mut vertices = [0; LANDMARKS];
    let mut i = 0;
    while i < LANDMARKS {
        vertices[i] = i as u32;
        i += 1;
    }
    vertices
};

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
}

/// positions [n, 3], seeds [n, width] (body vertices) -> push [n, 3], the displacement to the gap; zero where there is room.
pub fn collide(level: Level, positions: &[f32], body: &Posed, seeds: &[u32], push: &mut [f32]) {
    dispatch!(level, simd => kernel(simd, positions, body, seeds, push));
}

#[inline(always)]
fn kernel<S: Simd>(_: S, positions: &[f32], body: &Posed, seeds: &[u32], push: &mut [f32]) {
    let positions = positions.as_chunks::<3>().0;
    let seeds = seeds.chunks_exact(seeds.len() / positions.len().max(1));
    for ((point, seeds), push) in positions.iter().zip(seeds).zip(push.as_chunks_mut::<3>().0) {
        *push = body.push(Vec3::from_array(*point), seeds).to_array();
    }
}

/// Where a walk ended.
struct Place {
    vertex: u32,
    /// Squared distance to it.
    squared: f32,
    /// Highest corner of the triangles around it, along its normal; infinite where that is not known.
    top: f32,
}

impl Posed<'_> {
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

    /// The displacement that brings `point` to the gap. The last of the seeds lies on another part of the body than the first, where
    /// the cloth comes near one, as in an armpit: then the nearer part decides. So it does where cloth hangs free.
    #[inline(always)]
    fn push(&self, point: Vec3, seeds: &[u32]) -> Vec3 {
        let (own, other) = seeds.split_at((seeds.len() - 1).max(1));
        let nearer = |a: (f32, Vec3), b: (f32, Vec3)| if b.0 < a.0 { b } else { a };
        let mut found = self.search(point, own);
        if let [other] = other
            && *other != own[0]
        {
            found = nearer(found, self.search(point, &[*other]));
        }
        if found.0 > FREE * FREE {
            found = nearer(found, self.search(point, &EVENLY[..LANDMARKS.min(self.positions.len())]));
        }
        found.1
    }

    /// Squared distance to the body below the seeds, and the displacement to its gap; zero where there is room.
    /// Tried and rejected: going on by the closest triangles after the walk, or around the corner next to a foot on the rim (slow motion of
    /// a cape trembled as before, as much was left inside), and keeping deep vertices on one side of a thin leg, told by the first seed's
    /// normal, the cloth's own or its neighbours' pushes (no steadier: cloth that a leg passes through must change sides somewhere).
    #[inline(always)]
    fn search(&self, point: Vec3, seeds: &[u32]) -> (f32, Vec3) {
        let place = self.walk(point, seeds);
        let height = (point - self.position(place.vertex)).dot(self.normal(place.vertex));
        if height - place.top > GAP {
            return (place.squared, Vec3::ZERO);
        }
        let Some((foot, normal)) = self.closest(point, place.vertex) else { return (f32::INFINITY, Vec3::ZERO) };
        let (height, distance) = ((point - foot).dot(normal), point.distance(foot));
        let beside = distance > GAP && height.abs() < STEEPEST * distance;
        if beside || height < -DEPTH {
            return (f32::INFINITY, Vec3::ZERO);
        }
        // Outside, the distance itself: what has room must not move, whatever the normals at a ridge are.
        let height = if height > 0.0 { distance } else { height };
        (distance * distance, normal * (GAP - height).max(0.0))
    }

    /// The nearest vertex downhill from the nearest seed.
    #[inline(always)]
    fn walk(&self, point: Vec3, seeds: &[u32]) -> Place {
        // Without branches: which one is nearer cannot be foretold.
        let nearer = |best: (u32, f32), vertex: u32, position: Vec3| {
            let squared = point.distance_squared(position);
            (if squared < best.1 { vertex } else { best.0 }, squared.min(best.1))
        };
        let start = (seeds[0], f32::INFINITY);
        let mut best = seeds.iter().fold(start, |best, seed| nearer(best, *seed, self.position(*seed)));
        for _ in 0..STEPS {
            let (at, up) = (self.position(best.0), self.normal(best.0));
            let (mut next, mut top) = (best, 0.0_f32);
            for corners in self.fan(best.0) {
                let position = self.position(corners[0]);
                top = top.max((position - at).dot(up));
                next = nearer(next, corners[0], position);
            }
            if next.0 == best.0 {
                return Place { vertex: best.0, squared: best.1, top };
            }
            best = next;
        }
        Place { vertex: best.0, squared: best.1, top: f32::INFINITY }
    }

    /// The closest point of the triangles around a vertex, and the interpolated unit normal there.
    #[inline(always)]
    fn closest(&self, point: Vec3, vertex: u32) -> Option<(Vec3, Vec3)> {
        let a = self.position(vertex);
        let mut best = Spot { squared: f32::INFINITY, b: 0.0, c: 0.0 };
        let mut found = None;
        for corners in self.fan(vertex) {
            let [ab, ac] = corners.map(|corner| self.position(corner) - a);
            let spot = closest_on_triangle(point - a, ab, ac);
            if spot.squared < best.squared {
                best = spot;
                found = Some((corners, ab * best.b + ac * best.c));
            }
        }
        let ([b, c], way) = found?;
        let sum = self.normal(vertex) * (1.0 - best.b - best.c) + self.normal(*b) * best.b + self.normal(*c) * best.c;
        // Opposite normals: a body folded onto itself has no outside there.
        let length = sum.length();
        (length > FOLDED).then(|| (a + way, sum / length))
    }
}

/// A point of a triangle abc: its shares of b and c.
#[derive(Clone, Copy, Debug)]
struct Spot {
    /// Squared distance from it, less that from a.
    squared: f32,
    b: f32,
    c: f32,
}

/// The point of triangle abc closest to p, from the ways from a to p, b and c: above the triangle, else on the nearest edge.
#[inline(always)]
fn closest_on_triangle(ap: Vec3, ab: Vec3, ac: Vec3) -> Spot {
    let (bb, bc, cc, bp, cp) = (ab.dot(ab), ab.dot(ac), ac.dot(ac), ab.dot(ap), ac.dot(ap));
    let spot = |b: f32, c: f32| Spot { squared: b * (b * bb + 2.0 * (c * bc - bp)) + c * (c * cc - 2.0 * cp), b, c };
    let (area, b, c) = (bb * cc - bc * bc, cc * bp - bc * cp, bb * cp - bc * bp);
    if area > SLIVER * bb * cc && b >= 0.0 && c >= 0.0 && b + c <= area {
        return spot(b / area, c / area);
    }
    let along = |way: f32, squared: f32| if squared > 0.0 { (way / squared).clamp(0.0, 1.0) } else { 0.0 };
    let across = along(cp - bp - bc + bb, bb - 2.0 * bc + cc);
    let nearer = |best: Spot, other: Spot| if other.squared < best.squared { other } else { best };
    let at_a = nearer(spot(along(bp, bb), 0.0), spot(0.0, along(cp, cc)));
    nearer(at_a, spot(1.0 - across, across))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closest_points_of_a_triangle_are_inside_on_edges_and_at_corners() {
        let (a, b, c) = (Vec3::ZERO, Vec3::X, Vec3::Y);
        let on = |point: Vec3| {
            let spot = closest_on_triangle(point - a, b - a, c - a);
            assert!(
                (spot.squared - (Vec3::new(spot.b, spot.c, 0.0) - point).length_squared() + point.length_squared())
                    .abs()
                    < 1e-5
            );
            Vec3::new(spot.b, spot.c, 0.0)
        };
        assert_eq!(on(Vec3::new(0.25, 0.25, 3.0)), Vec3::new(0.25, 0.25, 0.0));
        assert_eq!(on(Vec3::new(0.5, -2.0, 1.0)), Vec3::new(0.5, 0.0, 0.0));
        assert_eq!(on(Vec3::new(1.0, 1.0, -1.0)), Vec3::new(0.5, 0.5, 0.0));
        assert_eq!(on(Vec3::new(3.0, -1.0, 0.0)), b);
        let point = closest_on_triangle(Vec3::ONE, Vec3::ZERO, Vec3::ZERO);
        assert!(point.b.is_finite() && point.c.is_finite() && point.squared == 0.0, "{point:?}");
    }
}
