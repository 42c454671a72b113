//! Eight points or triangles at once. What works on vectors stands in functions, never in closures nor in `array::map`,
//! whose bodies were not compiled for the level: the search over the body took twice as long. Twin:
//! shaders/collide.triangle.wgsl.

use fearless_simd::{Bytes, Select, Simd, SimdBase, SimdFloat, SimdMask, f32x8, i32x8, mask32x8};
use glam::Vec3;

/// A triangle whose angle at a corner has a smaller squared sine is taken for its edges.
pub const SLIVER: f32 = 1e-6;

/// Eight vectors, by axis.
pub type Eight<S> = [f32x8<S>; 3];

/// The same in memory.
pub type Packed = [[f32; 8]; 3];

/// The same vector eight times.
#[inline(always)]
pub fn splat<S: Simd>(simd: S, vector: Vec3) -> Eight<S> {
    [f32x8::splat(simd, vector.x), f32x8::splat(simd, vector.y), f32x8::splat(simd, vector.z)]
}

/// The ways from one point to eight.
#[inline(always)]
pub fn from<S: Simd>(simd: S, point: Vec3, eight: &Packed) -> Eight<S> {
    let [x, y, z] = splat(simd, point);
    let [a, b, c] = eight;
    [f32x8::from_slice(simd, a) - x, f32x8::from_slice(simd, b) - y, f32x8::from_slice(simd, c) - z]
}

/// Eight dot products.
#[inline(always)]
pub fn dot<S: Simd>(a: Eight<S>, b: Eight<S>) -> f32x8<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// The least of eight numbers, none below zero, and its place. They are compared as integers, whose order is the same:
/// the minimum of floats takes eight instructions in wasm.
#[inline(always)]
pub fn least<S: Simd>(simd: S, values: f32x8<S>) -> (usize, f32) {
    let bits: i32x8<S> = values.bitcast();
    let least = bits.reduce_min();
    (bits.simd_eq(i32x8::splat(simd, least)).to_bitmask().trailing_zeros() as usize % 8, f32::from_bits(least as u32))
}

/// The place of the least of eight numbers of which one at least is zero or below.
#[inline(always)]
pub fn place_of_least<S: Simd>(simd: S, values: f32x8<S>) -> usize {
    let bits: i32x8<S> = (-values).bitcast();
    bits.simd_eq(i32x8::splat(simd, bits.reduce_max())).to_bitmask().trailing_zeros() as usize % 8
}

/// The greatest of eight numbers where it is above zero, else a number that is not.
#[inline(always)]
pub fn greatest<S: Simd>(values: f32x8<S>) -> f32 {
    let bits: i32x8<S> = values.bitcast();
    f32::from_bits(bits.reduce_max() as u32)
}

/// The points of triangles abc closest to p, from the ways from a to p, b and c: squared distance from it less that
/// from a, and its shares of b and c. Above the triangle, else on the nearest edge.
#[inline(always)]
pub fn closest_on_triangles<S: Simd>(simd: S, ap: Eight<S>, ab: Eight<S>, ac: Eight<S>) -> [f32x8<S>; 3] {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let (bb, bc, cc, bp, cp) = (dot(ab, ab), dot(ab, ac), dot(ac, ac), dot(ab, ap), dot(ac, ap));
    let sides = [bb, bc, cc, bp, cp];
    let across = along(simd, cp - bp - bc + bb, bb - bc - bc + cc);
    let (on_ab, on_ac) = (spot(sides, along(simd, bp, bb), zero), spot(sides, zero, along(simd, cp, cc)));
    let at_a = either(on_ac[0].simd_lt(on_ab[0]), on_ac, on_ab);
    let on_bc = spot(sides, one - across, across);
    let on_edges = either(on_bc[0].simd_lt(at_a[0]), on_bc, at_a);
    let (area, b, c) = (bb * cc - bc * bc, cc * bp - bc * cp, bb * cp - bc * bp);
    let wide = area.simd_gt(f32x8::splat(simd, SLIVER) * bb * cc);
    let above = wide & b.simd_ge(zero) & c.simd_ge(zero) & (b + c).simd_le(area);
    either(above, spot(sides, b / area, c / area), on_edges)
}

/// The point with shares `b` and `c`, and its squared distance less that of a.
#[inline(always)]
fn spot<S: Simd>([bb, bc, cc, bp, cp]: [f32x8<S>; 5], b: f32x8<S>, c: f32x8<S>) -> [f32x8<S>; 3] {
    let (ways, way) = (c * bc - bp, c * cc - (cp + cp));
    [b * (b * bb + (ways + ways)) + c * way, b, c]
}

/// Share of the way along an edge to where a point is closest.
#[inline(always)]
fn along<S: Simd>(simd: S, way: f32x8<S>, squared: f32x8<S>) -> f32x8<S> {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let inside = way.simd_lt(squared).select(way / squared, one);
    (way.simd_gt(zero) & squared.simd_gt(zero)).select(inside, zero)
}

#[inline(always)]
fn either<S: Simd>(chosen: mask32x8<S>, a: [f32x8<S>; 3], b: [f32x8<S>; 3]) -> [f32x8<S>; 3] {
    [chosen.select(a[0], b[0]), chosen.select(a[1], b[1]), chosen.select(a[2], b[2])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    /// The first of eight equal triangles.
    fn closest(p: Vec3, [a, b, c]: [Vec3; 3]) -> [f32; 3] {
        #[inline(always)]
        fn kernel<S: Simd>(simd: S, ways: [Vec3; 3]) -> [f32; 3] {
            let [ap, ab, ac] = ways.map(|way| splat(simd, way));
            closest_on_triangles(simd, ap, ab, ac).map(|found| found.as_slice()[0])
        }
        dispatch!(Level::new(), simd => kernel(simd, [p - a, b - a, c - a]))
    }

    #[test]
    fn closest_points_of_a_triangle_are_inside_on_edges_and_at_corners() {
        let on = |point: Vec3| {
            let [squared, b, c] = closest(point, [Vec3::ZERO, Vec3::X, Vec3::Y]);
            let foot = Vec3::new(b, c, 0.0);
            assert!((squared - point.distance_squared(foot) + point.length_squared()).abs() < 1e-5);
            foot
        };
        assert_eq!(on(Vec3::new(0.25, 0.25, 3.0)), Vec3::new(0.25, 0.25, 0.0));
        assert_eq!(on(Vec3::new(0.5, -2.0, 1.0)), Vec3::new(0.5, 0.0, 0.0));
        assert_eq!(on(Vec3::new(1.0, 1.0, -1.0)), Vec3::new(0.5, 0.5, 0.0));
        assert_eq!(on(Vec3::new(3.0, -1.0, 0.0)), Vec3::X);
        assert_eq!(closest(Vec3::ONE, [Vec3::ZERO; 3])[0], 0.0);
    }
}
