//! Paths of bones as curves by arc length, metres.

use glam::DVec3;

/// Length of a path, metres.
pub(super) fn arc_length(path: &[DVec3]) -> f64 {
    path.windows(2).map(|bone| bone[0].distance(bone[1])).sum()
}

/// Point and direction of a path at arc length `s`; the direction is taken over a tenth of the path around it.
pub(super) fn at(path: &[DVec3], s: f64) -> (DVec3, DVec3) {
    let walk = |mut s: f64| {
        for bone in path.windows(2) {
            let length = bone[0].distance(bone[1]);
            if s <= length && length > 0.0 {
                return bone[0].lerp(bone[1], s / length);
            }
            s -= length;
        }
        path[path.len() - 1]
    };
    let half = 0.05 * arc_length(path);
    let direction = walk(s + half) - walk((s - half).max(0.0));
    (walk(s), direction.normalize_or(DVec3::NEG_Y))
}

/// Arc length of the point of a path nearest to `p`.
pub(super) fn project(path: &[DVec3], p: DVec3) -> f64 {
    let (mut best, mut arc, mut walked) = (f64::INFINITY, 0.0, 0.0);
    for bone in path.windows(2) {
        let along = bone[1] - bone[0];
        let t = ((p - bone[0]).dot(along) / along.length_squared().max(1e-18)).clamp(0.0, 1.0);
        let distance = p.distance(bone[0] + along * t);
        if distance < best {
            (best, arc) = (distance, walked + t * along.length());
        }
        walked += along.length();
    }
    arc
}
