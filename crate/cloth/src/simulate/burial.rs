//! Where a skinned body cuts into itself (a lowered arm into the chest) no place is outside all of it. A face is buried
//! when the point one cloth thickness above it has winding number ≠ 0; cloth whose closest face is buried is held by
//! the side of the body that it is worn on alone.

use ctsn_rig::mesh::triangle::{Meeting, meet};
use glam::DVec3;
use parry3d_f64::partitioning::{Bvh, BvhNode};

/// Winding number of a closed surface about `origin`: exits less entries along a ray.
pub(super) fn winding(tree: &Bvh, origin: DVec3, direction: DVec3, corners: impl Fn(u32) -> [DVec3; 3]) -> i32 {
    let (o, inverse) = (origin.to_array(), direction.recip().to_array());
    let crossed = |node: &BvhNode| {
        let (low, high) = (node.mins(), node.maxs());
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for k in 0..3 {
            let (a, b) = ((low[k] - o[k]) * inverse[k], (high[k] - o[k]) * inverse[k]);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        enter <= leave
    };
    tree.leaves(crossed).map(|face| crossing(origin, direction, corners(face))).sum()
}

/// +1 where the ray leaves through the triangle's front, -1 where it enters, 0 where it misses.
fn crossing(origin: DVec3, direction: DVec3, corners: [DVec3; 3]) -> i32 {
    let hit = |at: &Meeting| at.u >= 0.0 && at.v >= 0.0 && at.u + at.v < 1.0 && at.along > 0.0;
    meet(origin, direction, corners).filter(hit).map_or(0, |at| if at.leaves { 1 } else { -1 })
}
