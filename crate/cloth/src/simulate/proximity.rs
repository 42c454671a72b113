//! Pairs of cloth elements that must not pass through each other, vertex–triangle and edge–edge: `d = |Σ w_k x_k|`, the
//! barrier `-(d - d̂)² ln(d/d̂)` below `d̂` (Li et al. 2020, Incremental Potential Contact), and the time of impact by
//! additive continuous collision detection (Li et al. 2021, Codimensional IPC, §5).

use ctsn_rig::mesh::{bounds, triangle};
use glam::DVec3;

/// Share of a pair's distance that a move must leave.
const KEPT: f64 = 0.2;

/// Two elements of the cloth with no vertex in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pair {
    /// A vertex, and the corners of a triangle.
    VertexTriangle([u32; 4]),
    /// The ends of an edge, and those of another.
    EdgeEdge([u32; 4]),
}

impl Pair {
    /// The four cloth vertices.
    pub fn vertices(&self) -> [usize; 4] {
        let (Self::VertexTriangle(vertices) | Self::EdgeEdge(vertices)) = self;
        vertices.map(|i| i as usize)
    }

    /// Weights `w_k` of the four vertices whose sum `Σ w_k x_k` is the shortest vector between the elements, from the
    /// second to the first, and that vector, metres.
    pub fn shortest(&self, x: &[DVec3; 4]) -> ([f64; 4], DVec3) {
        let weights = match self {
            Self::VertexTriangle(_) => {
                let [u, v, w] = triangle::closest(x[0], [x[1], x[2], x[3]]);
                [1.0, -u, -v, -w]
            }
            Self::EdgeEdge(_) => {
                let [s, t] = closest_on_segments([x[0], x[1]], [x[2], x[3]]);
                [1.0 - s, s, t - 1.0, -t]
            }
        };
        (weights, (0..4).map(|k| x[k] * weights[k]).sum())
    }

    /// Distance in metres at the positions `x` [n].
    pub fn distance(&self, x: &[DVec3]) -> f64 {
        self.shortest(&self.vertices().map(|i| x[i])).1.length()
    }

    /// What the boxes around the elements leave between them at the positions `x` [n], metres: at most the distance,
    /// and quickly found.
    pub fn gap(&self, x: &[DVec3]) -> f64 {
        let at = self.vertices().map(|i| x[i]);
        let (first, second) = at.split_at(self.split());
        let [[low, high], [other_low, other_high]] = [first, second].map(|part| bounds(part.iter().copied()));
        (other_low - high).max(low - other_high).max(DVec3::ZERO).length()
    }

    /// How many of the four vertices the first element has.
    fn split(&self) -> usize {
        match self {
            Self::VertexTriangle(_) => 1,
            Self::EdgeEdge(_) => 2,
        }
    }

    /// How far the two elements can come nearer when the vertices move by `motion` [n], metres: their common part left
    /// out.
    pub fn approach(&self, motion: &[DVec3]) -> f64 {
        self.lengths(&self.relative(motion))
    }

    fn relative(&self, motion: &[DVec3]) -> [DVec3; 4] {
        let moves = self.vertices().map(|i| motion[i]);
        let mean = moves.iter().sum::<DVec3>() * 0.25;
        moves.map(|each| each - mean)
    }

    fn lengths(&self, moves: &[DVec3; 4]) -> f64 {
        let first = self.split();
        let longest = |moves: &[DVec3]| moves.iter().map(|m| m.length_squared()).fold(0.0, f64::max).sqrt();
        longest(&moves[..first]) + longest(&moves[first..])
    }

    /// The share of `motion` up to `limit` that leaves a fifth of the distance between the elements.
    pub fn time_of_impact(&self, x: &[DVec3], motion: &[DVec3], limit: f64) -> f64 {
        let moves = self.relative(motion);
        let speed = self.lengths(&moves);
        let mut at = self.vertices().map(|i| x[i]);
        let start = self.shortest(&at).1.length();
        if start - limit * speed > KEPT * start {
            return limit;
        }
        let (mut time, mut distance) = (0.0, start);
        // Every round leaves at least a tenth of what was to go, so that hundreds are only needed by grazing pairs.
        for _ in 0..500 {
            let step = 0.9 * (distance - KEPT * start) / speed;
            if time + step >= limit {
                return limit;
            }
            (0..4).for_each(|k| at[k] += moves[k] * step);
            distance = self.shortest(&at).1.length();
            if time > 0.0 && distance <= (KEPT + 0.1 * (1.0 - KEPT)) * start {
                break;
            }
            time += step;
        }
        time
    }
}

/// The barrier at distance `d` below `offset`, its slope and its curvature, for unit stiffness.
pub(super) fn barrier(d: f64, offset: f64) -> [f64; 3] {
    if d >= offset {
        return [0.0; 3];
    }
    let (log, gap) = ((d / offset).ln(), d - offset);
    let ratio = gap / d;
    [-gap * gap * log, -2.0 * gap * log - gap * ratio, -2.0 * log - 4.0 * ratio + ratio * ratio]
}

/// Where along each of two segments (0 to 1) they come closest (Ericson §5.1.9). Either may have no length.
fn closest_on_segments([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> [f64; 2] {
    const TINY: f64 = 1e-24;
    let (u, v, from) = (b - a, d - c, a - c);
    let (uu, vv, vf, uf, uv) = (u.length_squared(), v.length_squared(), v.dot(from), u.dot(from), u.dot(v));
    if uu <= TINY {
        return [0.0, if vv <= TINY { 0.0 } else { (vf / vv).clamp(0.0, 1.0) }];
    }
    if vv <= TINY {
        return [(-uf / uu).clamp(0.0, 1.0), 0.0];
    }
    let determinant = uu * vv - uv * uv;
    let parallel = determinant <= 1e-12 * uu * vv;
    let s = if parallel { 0.0 } else { ((uv * vf - uf * vv) / determinant).clamp(0.0, 1.0) };
    let t = (uv * s + vf) / vv;
    if t < 0.0 {
        [(-uf / uu).clamp(0.0, 1.0), 0.0]
    } else if t > 1.0 {
        [((uv - uf) / uu).clamp(0.0, 1.0), 1.0]
    } else {
        [s, t]
    }
}
