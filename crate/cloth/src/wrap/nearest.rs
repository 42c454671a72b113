//! The face of a mesh nearest to a point, by a bounding volume tree.

use ctsn_rig::mesh::{self, Mesh, triangle};
use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode};

/// Bounding box of a triangle.
pub(crate) fn bounds(corners: [DVec3; 3]) -> Aabb {
    let [low, high] = mesh::bounds(corners);
    Aabb::new(Vector::from_array(low.to_array()), Vector::from_array(high.to_array()))
}

/// Squared distance of a point from the box of a node, square metres.
pub(crate) fn squared_distance(node: &BvhNode, point: DVec3) -> f64 {
    let (low, high, p) = (node.mins(), node.maxs(), point.to_array());
    let gap = |k: usize| (low[k] - p[k]).max(p[k] - high[k]).max(0.0);
    gap(0) * gap(0) + gap(1) * gap(1) + gap(2) * gap(2)
}

/// A mesh to search in.
pub(crate) struct Faces<'a> {
    mesh: &'a Mesh,
    tree: Bvh,
}

impl<'a> Faces<'a> {
    /// The faces of `mesh`.
    pub fn new(mesh: &'a Mesh) -> Self {
        let boxes: Vec<Aabb> = mesh.corners().map(bounds).collect();
        Self { mesh, tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes) }
    }

    /// The nearest face, the first of equals in the mesh's order, and its closest point, metres; none in an empty mesh.
    pub fn nearest(&self, point: DVec3) -> Option<(usize, DVec3)> {
        self.nearest_of(point, |_| true)
    }

    /// The nearest of the faces that `counts` names; none where it names none.
    pub fn nearest_of(&self, point: DVec3, counts: impl Fn(usize) -> bool) -> Option<(usize, DVec3)> {
        let foot = |face: u32| {
            let corners = self.mesh.triangles[face as usize].map(|i| self.mesh.positions[i as usize]);
            triangle::closest_point(point, corners)
        };
        // A face without an area may have no closest point.
        let squared = |face: u32| match foot(face).distance_squared(point) {
            near if near.is_finite() => near,
            _ => f64::INFINITY,
        };
        let (_, least) = self.tree.find_best(
            f64::MAX,
            |node, _| squared_distance(node, point),
            |face, _| counts(face as usize).then(|| squared(face)),
        )?;
        // Faces that meet in the closest point are all as near: the tree finds any of them.
        let reach = 1.000_001 * least.sqrt() + f64::MIN_POSITIVE;
        let nearer = |a: &u32, b: &u32| squared(*a).total_cmp(&squared(*b)).then(a.cmp(b));
        let near = bounds([point - reach, point + reach, point]);
        let face = self.tree.intersect_aabb(&near).filter(|face| counts(*face as usize)).min_by(nearer)?;
        Some((face as usize, foot(face)))
    }

    /// How far along a unit `direction` the first face is met within `reach`, metres.
    pub fn first_hit(&self, origin: DVec3, direction: DVec3, reach: f64) -> Option<f64> {
        self.met(origin, direction, reach).map(|(_, along)| along).min_by(f64::total_cmp)
    }

    /// The faces that are met along a unit `direction` within `reach` metres, ascending.
    pub fn pierced(&self, origin: DVec3, direction: DVec3, reach: f64) -> Vec<usize> {
        let mut faces: Vec<usize> = self.met(origin, direction, reach).map(|(face, _)| face).collect();
        faces.sort_unstable();
        faces
    }

    /// The faces along a ray, and how far along they are met, metres.
    fn met(&self, origin: DVec3, direction: DVec3, reach: f64) -> impl Iterator<Item = (usize, f64)> {
        let (from, inverse) = (origin.to_array(), direction.recip().to_array());
        let crossed = move |node: &BvhNode| {
            let (low, high) = (node.mins(), node.maxs());
            let (mut enter, mut leave) = (0.0f64, reach);
            for k in 0..3 {
                let (a, b) = ((low[k] - from[k]) * inverse[k], (high[k] - from[k]) * inverse[k]);
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            }
            enter <= leave
        };
        self.tree.leaves(crossed).filter_map(move |face| {
            let corners = self.mesh.triangles[face as usize].map(|i| self.mesh.positions[i as usize]);
            let inside = |at: &triangle::Meeting| at.u >= 0.0 && at.v >= 0.0 && at.u + at.v <= 1.0;
            let meeting = triangle::meet(origin, direction, corners).filter(inside);
            let along = meeting.map(|at| at.along).filter(|along| (0.0..=reach).contains(along))?;
            Some((face as usize, along))
        })
    }

    /// The faces whose boxes come as near to a point along every axis as `reach`, metres.
    pub fn within(&self, point: DVec3, reach: f64) -> Vec<u32> {
        let near = bounds([point - reach, point + reach, point]);
        self.tree.intersect_aabb(&near).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A heap of triangles, many of which share corners.
    fn heap() -> Mesh {
        let mut rng = fastrand::Rng::with_seed(7);
        let mut place = || DVec3::new(rng.f64(), rng.f64(), rng.f64());
        let positions: Vec<DVec3> = (0..60).map(|_| place()).collect();
        let mut rng = fastrand::Rng::with_seed(8);
        let triangles = (0..200).map(|_| [0; 3].map(|_: u32| rng.u32(..60))).collect();
        Mesh { positions, triangles }
    }

    #[test]
    fn the_tree_finds_what_looking_at_all_faces_does() {
        let mesh = heap();
        let faces = Faces::new(&mesh);
        let brute = |point: DVec3| {
            let mut best = (f64::INFINITY, 0, DVec3::ZERO);
            for (face, corners) in mesh.corners().enumerate() {
                let foot = triangle::closest_point(point, corners);
                let squared = foot.distance_squared(point);
                if squared < best.0 {
                    best = (squared, face, foot);
                }
            }
            Some((best.1, best.2))
        };
        let mut rng = fastrand::Rng::with_seed(9);
        let around = (0..500).map(|_| 3.0 * DVec3::new(rng.f64(), rng.f64(), rng.f64()) - 1.0);
        // At the corners several faces are equally near.
        for point in around.chain(mesh.positions.iter().copied()) {
            assert_eq!(faces.nearest(point), brute(point), "{point}");
        }
        assert_eq!(Faces::new(&Mesh::default()).nearest(DVec3::ZERO), None);
    }
}
