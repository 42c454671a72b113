//! Hinge bending: `½ D (l²/A) (θ - θ̄)²` over the inner edges, `A` the area of both triangles. simulation.md §2.2, §3.2.
//! The factor 1 reproduces plate bending on equilateral meshes (cantilever test); Gauss–Newton Hessian `k ∇θ ∇θᵀ`.

use glam::{DMat3, DVec3};

use super::matrix::outer;

/// An inner edge and the two corners that face it.
#[derive(Clone, Debug)]
pub(super) struct Hinge {
    /// Edge start and end, the corner to the left of the edge, the corner to the right.
    pub vertices: [usize; 4],
    /// `D l²/A`, N·m.
    pub stiffness: f64,
    /// Rest angle, radians.
    pub rest: f64,
}

/// Dihedral angle of a hinge, zero when flat, and what its gradient needs.
pub(super) fn angle(vertices: &[usize; 4], x: &[DVec3]) -> f64 {
    let [a, b, left, right] = vertices.map(|i| x[i]);
    let edge = b - a;
    let (n1, n2) = (edge.cross(left - a), (right - a).cross(edge));
    (n1.cross(n2).dot(edge) / edge.length().max(1e-12)).atan2(n1.dot(n2))
}

/// `∂θ/∂x` per vertex, 1/m.
fn angle_gradient(vertices: &[usize; 4], x: &[DVec3]) -> [DVec3; 4] {
    let [a, b, left, right] = vertices.map(|i| x[i]);
    let edge = b - a;
    let length = edge.length().max(1e-12);
    let (n1, n2) = (edge.cross(left - a), (right - a).cross(edge));
    let left_gradient = n1 * (-length / n1.length_squared().max(1e-24));
    let right_gradient = n2 * (-length / n2.length_squared().max(1e-24));
    let along = edge / (length * length);
    let (s, t) = ((left - a).dot(along), (right - a).dot(along));
    let start = -(left_gradient * (1.0 - s) + right_gradient * (1.0 - t));
    let end = -(left_gradient * s + right_gradient * t);
    [start, end, left_gradient, right_gradient]
}

impl Hinge {
    /// Angle from rest, in -π..π.
    fn bend(&self, x: &[DVec3]) -> f64 {
        use std::f64::consts::PI;
        let bend = angle(&self.vertices, x) - self.rest;
        if bend > PI {
            bend - 2.0 * PI
        } else if bend < -PI {
            bend + 2.0 * PI
        } else {
            bend
        }
    }

    /// Energy in joules.
    pub fn energy(&self, x: &[DVec3]) -> f64 {
        let bend = self.bend(x);
        0.5 * self.stiffness * bend * bend
    }

    /// Gradient per vertex in newtons, and the Hessian through `block(a, b, H_ab)` for the pairs `a >= b`.
    pub fn derivatives(&self, x: &[DVec3], mut block: impl FnMut(usize, usize, DMat3)) -> [DVec3; 4] {
        let gradient = angle_gradient(&self.vertices, x);
        for i in 0..4 {
            for j in 0..=i {
                block(i, j, outer(gradient[i], gradient[j] * self.stiffness));
            }
        }
        let moment = self.stiffness * self.bend(x);
        gradient.map(|g| g * moment)
    }
}
