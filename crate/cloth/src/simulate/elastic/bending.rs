//! Hinge bending: `½ D (l²/A) (θ - θ̄)²` over the inner edges, `A` the area of both triangles.
//! simulation.md §2.2, §3.2. The factor 1 reproduces plate bending on equilateral meshes (cantilever test);
//! Gauss–Newton Hessian `k ∇θ ∇θᵀ`.

use glam::{DMat3, DVec3};

use crate::simulate::matrix::outer;

/// An inner edge and the two corners that face it.
#[derive(Clone, Debug)]
pub struct Hinge {
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
    /// Dihedral angle at the positions `x` [n], radians; zero when flat.
    pub fn angle(&self, x: &[DVec3]) -> f64 {
        angle(&self.vertices, x)
    }

    /// Angle from rest, in -π..π.
    fn bend(&self, x: &[DVec3]) -> f64 {
        use std::f64::consts::PI;
        let bend = self.angle(x) - self.rest;
        if bend > PI {
            bend - 2.0 * PI
        } else if bend < -PI {
            bend + 2.0 * PI
        } else {
            bend
        }
    }

    /// Energy at the positions `x` [n], joules.
    pub fn energy(&self, x: &[DVec3]) -> f64 {
        let bend = self.bend(x);
        0.5 * self.stiffness * bend * bend
    }

    /// Gradient of the energy at `x` [n] per vertex, newtons: the forces are its negative.
    pub fn gradient(&self, x: &[DVec3]) -> [DVec3; 4] {
        self.derivatives(x, false, |_, _, _| {})
    }

    /// Gradient per vertex in newtons, and the Hessian through `block(a, b, H_ab)` for the pairs `a >= b`: exact, or
    /// without the term in `∇²θ`, which leaves it positive semi-definite.
    pub(in crate::simulate) fn derivatives(
        &self,
        x: &[DVec3],
        exact: bool,
        mut block: impl FnMut(usize, usize, DMat3),
    ) -> [DVec3; 4] {
        let gradient = angle_gradient(&self.vertices, x);
        let moment = self.stiffness * self.bend(x);
        for i in 0..4 {
            for j in 0..=i {
                block(i, j, outer(gradient[i], gradient[j] * self.stiffness));
            }
        }
        if exact && moment != 0.0 {
            angle_hessian(&self.vertices, x, |i, j, curvature| block(i, j, curvature * moment));
        }
        gradient.map(|g| g * moment)
    }
}

/// One triangle of a hinge: unit normal, and per edge (hinge edge, from the start, from the end) the in-plane outward
/// normal divided by the height over it, 1/m; cosines of the corner angles at start and end.
struct Wing {
    normal: DVec3,
    over: [DVec3; 3],
    heights: [f64; 3],
    cosines: [f64; 2],
}

impl Wing {
    /// `side` +1 for the left triangle, -1 for the right.
    fn new(a: DVec3, b: DVec3, tip: DVec3, side: f64) -> Self {
        let (edge, from_start, from_end) = (b - a, tip - a, tip - b);
        let normal = edge.cross(from_start) * side;
        let area = normal.length().max(1e-24);
        let normal = normal / area;
        let [e, s, t] = [edge, from_start, from_end].map(|v| v / v.length().max(1e-12));
        let heights = [edge, from_start, from_end].map(|v| area / v.length().max(1e-12));
        let over = [-normal.cross(e), normal.cross(s), -normal.cross(t)].map(|v| v * side);
        Self { normal, over, heights, cosines: [e.dot(s), -e.dot(t)] }
    }
}

/// `∂²θ/∂x∂x`, 1/m² (Tamstorf & Grinspun, Discrete bending forces and their Jacobians, 2013), for the pairs `a >= b`.
fn angle_hessian(vertices: &[usize; 4], x: &[DVec3], mut block: impl FnMut(usize, usize, DMat3)) {
    let [a, b, left, right] = vertices.map(|i| x[i]);
    let square = (b - a).length_squared().max(1e-24);
    let twice = |m: DMat3| m + m.transpose();
    for (tip, wing) in [(2, Wing::new(a, b, left, 1.0)), (3, Wing::new(a, b, right, -1.0))] {
        let Wing { normal: n, over: [m0, m1, m3], heights: [h0, h1, h3], cosines: [c1, c3] } = wing;
        let along = outer(n, m0) * (1.0 / square);
        block(0, 0, twice(outer(m3, n)) * (c3 / (h3 * h3)) - along);
        block(1, 1, twice(outer(m1, n)) * (c1 / (h1 * h1)) - along);
        let mixed = outer(m1, n) * (c3 / (h3 * h1)) + outer(n, m3) * (c1 / (h1 * h3)) + along;
        block(1, 0, mixed.transpose());
        block(tip, 0, (outer(m0, n) * (c3 / (h3 * h0)) - outer(n, m3) * (1.0 / (h0 * h3))).transpose());
        block(tip, 1, (outer(m0, n) * (c1 / (h1 * h0)) - outer(n, m1) * (1.0 / (h0 * h1))).transpose());
        block(tip, tip, twice(outer(n, m0)) * (-1.0 / (h0 * h0)));
    }
}
