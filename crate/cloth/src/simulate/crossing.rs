//! Where cloth passes through itself: edges that pierce triangles. The barrier and the time of impact keep a simulated
//! cloth from it; this is the independent count that says so, and that judges garments brought from elsewhere.

use ctsn_rig::mesh::around;
use ctsn_rig::mesh::triangle::{Meeting, meet};
use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

use super::neighbourhood::Elements;
use crate::wrap::bounds;

impl Elements {
    /// Pairs of triangles with an edge of one passing through the other at `x` [n], each once, in ascending order.
    pub fn crossings(&self, x: &[DVec3]) -> Vec<[u32; 2]> {
        let corners = |triangle: u32| self.triangles[triangle as usize].map(|i| x[i as usize]);
        let boxes: Vec<Aabb> = (0..self.triangles.len() as u32).map(|t| bounds(corners(t))).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        let mut found = Vec::new();
        let mut look = |a: u32, b: u32| {
            let pierced = |a: u32, b: u32| {
                let apart = |edge: &[u32; 2]| edge.iter().all(|v| !self.triangles[b as usize].contains(v));
                let pierces = |[v, w]: [u32; 2]| pierces([x[v as usize], x[w as usize]], corners(b));
                around(self.triangles[a as usize]).into_iter().filter(apart).any(pierces)
            };
            if pierced(a, b) || pierced(b, a) {
                found.push([a.min(b), a.max(b)]);
            }
        };
        tree.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), &mut look);
        found.sort_unstable();
        found
    }
}

/// Whether a segment passes through a triangle.
pub(super) fn pierces(ends: [DVec3; 2], corners: [DVec3; 3]) -> bool {
    pierced(ends, corners).is_some()
}

/// Where it does.
pub(super) fn pierced([start, end]: [DVec3; 2], corners: [DVec3; 3]) -> Option<Meeting> {
    let inside = |at: &Meeting| at.u >= 0.0 && at.v >= 0.0 && at.u + at.v <= 1.0 && (0.0..=1.0).contains(&at.along);
    meet(start, end - start, corners).filter(inside)
}
