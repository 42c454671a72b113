//! Point forces: body contact `½ k (d̂ - d)²` below the offset `d̂`, Coulomb friction `μ λ f(|P(x - a)|)` towards an
//! anchor `a` that rides on the body, and springs that pin vertices. simulation.md §2.2. All act on single vertices.

use glam::{DMat3, DVec3};

use super::matrix::outer;

/// Slip below which friction is elastic, metres. Anchors, not displacement per step: a sum of regularised steps creeps.
pub(super) const SLIP: f64 = 1e-4;
/// Share of the sticking stiffness kept in the Hessian of a sliding vertex, so that a reversal does not overshoot.
const SLIDING_SHARE: f64 = 0.05;

/// A vertex near the body, the body replaced by the tangent plane of its signed distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// Cloth vertex.
    pub vertex: usize,
    /// Unit normal of the plane.
    pub normal: DVec3,
    /// `d(x) = normal · x - plane`.
    pub plane: f64,
    /// Offset `d̂`, metres.
    pub offset: f64,
    /// Stiffness `k`, N/m.
    pub stiffness: f64,
    /// `μ λ`: friction coefficient times the normal force at the linearisation, newtons.
    pub grip: f64,
    /// Where the vertex sticks, metres.
    pub anchor: DVec3,
}

impl Contact {
    fn depth(&self, x: DVec3) -> f64 {
        (self.offset - (self.normal.dot(x) - self.plane)).max(0.0)
    }

    /// Tangential offset from the anchor.
    pub fn slip(&self, x: DVec3) -> DVec3 {
        let offset = x - self.anchor;
        offset - self.normal * self.normal.dot(offset)
    }

    /// Energy in joules.
    pub fn energy(&self, x: DVec3) -> f64 {
        let depth = self.depth(x);
        let slip = self.slip(x).length();
        let friction = if slip >= SLIP { slip - SLIP / 3.0 } else { slip * slip / SLIP * (1.0 - slip / (3.0 * SLIP)) };
        0.5 * self.stiffness * depth * depth + self.grip * friction
    }

    /// Gradient in newtons and positive semi-definite Hessian.
    pub fn derivatives(&self, x: DVec3) -> (DVec3, DMat3) {
        let (mut gradient, mut hessian) = (DVec3::ZERO, DMat3::ZERO);
        let depth = self.depth(x);
        let across = outer(self.normal, self.normal);
        if depth > 0.0 {
            gradient -= self.normal * (self.stiffness * depth);
            hessian += across * self.stiffness;
        }
        if self.grip > 0.0 {
            let slip = self.slip(x);
            let length = slip.length();
            let (secant, tangent) = if length >= SLIP {
                (1.0 / length, 0.0)
            } else {
                (2.0 / SLIP - length / (SLIP * SLIP), 2.0 / SLIP - 2.0 * length / (SLIP * SLIP))
            };
            let tangent = tangent.max(SLIDING_SHARE / SLIP).min(secant);
            let along = slip.normalize_or_zero();
            gradient += slip * (self.grip * secant);
            hessian += (DMat3::IDENTITY - across) * (self.grip * secant);
            hessian -= outer(along, along) * (self.grip * (secant - tangent));
        }
        (gradient, hessian)
    }

    /// The anchor after slipping: pulled along to within [`SLIP`] of the vertex.
    pub fn slipped_anchor(&self, x: DVec3) -> DVec3 {
        let slip = self.slip(x);
        let length = slip.length();
        if length > SLIP { x - slip * (SLIP / length) } else { x - slip }
    }
}

/// A spring from a vertex to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pin {
    /// Cloth vertex.
    pub vertex: usize,
    /// Where it is held, metres.
    pub target: DVec3,
    /// N/m.
    pub stiffness: f64,
}

impl Pin {
    /// Energy in joules.
    pub(super) fn energy(&self, x: DVec3) -> f64 {
        0.5 * self.stiffness * x.distance_squared(self.target)
    }

    /// Gradient in newtons and Hessian.
    pub(super) fn derivatives(&self, x: DVec3) -> (DVec3, DMat3) {
        ((x - self.target) * self.stiffness, DMat3::from_diagonal(DVec3::splat(self.stiffness)))
    }
}
