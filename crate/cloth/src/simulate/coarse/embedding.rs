//! Fine cloth laid on a coarse state of the same garment.

use crate::simulate::matrix::outer;
use ctsn_core::topology::Graph;
use ctsn_rig::Mesh;
use ctsn_rig::mesh::triangle::{closest, cross};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Where the vertices of a fine garment are on a coarse one of the same shape.
pub struct Embedding {
    /// The coarse garment at rest.
    pub(in crate::simulate) mesh: Mesh,
    rings: Graph<Vec<u32>>,
    /// Three coarse vertices and their barycentric weights, for each fine vertex.
    bound: Vec<[(usize, f64); 3]>,
}

impl Embedding {
    /// Of the `fine` garment on the `coarse` one, both at rest in the same place: each vertex on the nearest triangle
    /// of those that face as it does, so that it does not change the layer.
    pub fn new(coarse: Mesh, fine: &Mesh) -> Self {
        let faces: Vec<DVec3> = coarse.corners().map(cross).collect();
        let normals = fine.normals(&fine.positions);
        let facing = |vertex: usize| {
            let alike = (0..faces.len()).filter(|face| faces[*face].dot(normals[vertex]) > 0.0).collect::<Vec<_>>();
            if alike.is_empty() { (0..faces.len()).collect() } else { alike }
        };
        Self::among(coarse, &fine.positions, facing)
    }

    /// Of fine vertices [n], each on the nearest of the triangles that `near` allows it.
    pub(super) fn among(mesh: Mesh, fine: &[DVec3], near: impl Fn(usize) -> Vec<usize> + Sync) -> Self {
        let bind = |(vertex, point): (usize, &DVec3)| {
            let place = near(vertex).into_iter().map(|t| {
                let corners = mesh.triangles[t].map(|v| mesh.positions[v as usize]);
                let weights = closest(*point, corners);
                let at: DVec3 = corners.iter().zip(weights).map(|(corner, weight)| *corner * weight).sum();
                (at.distance_squared(*point), t, weights)
            });
            let (_, t, weights) = place.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).unwrap_or_default();
            [0, 1, 2].map(|k| (mesh.triangles[t][k] as usize, weights[k]))
        };
        let bound = fine.par_iter().enumerate().map(bind).collect();
        Self { rings: mesh.rings(), bound, mesh }
    }

    /// The fine garment on a coarse state `x`, each vertex where its three coarse ones, each turned as its ring is
    /// turned from the template, take it (embedded deformation, Sumner et al. 2007). So the surface bends smoothly
    /// across the coarse edges. `templates`: of the fine and of the coarse garment.
    pub fn lay(&self, templates: [&[DVec3]; 2], x: &[DVec3]) -> Vec<DVec3> {
        let [template, rest] = templates;
        let normals = [rest, x].map(|state| self.mesh.normals(state));
        let turn = |v: usize| {
            let legs = self.rings.of(v).iter().map(|&w| w as usize);
            let (sum, square) = legs.fold((DMat3::ZERO, 0.0), |(sum, square), w| {
                let (from, to) = (rest[w] - rest[v], x[w] - x[v]);
                (sum + outer(to, from), square + from.length_squared())
            });
            nearest_rotation(sum + outer(normals[1][v], normals[0][v]) * (0.5 * square))
        };
        let turns: Vec<DMat3> = (0..x.len()).map(turn).collect();
        let place = |(start, bound): (&DVec3, &[(usize, f64); 3])| {
            bound.iter().map(|&(v, weight)| (x[v] + turns[v] * (*start - rest[v])) * weight).sum()
        };
        template.iter().zip(&self.bound).map(place).collect()
    }

    /// How far from the coarse garment at rest these fine vertices [n] are on average, in mean coarse edges.
    pub fn distance(&self, fine: &[DVec3]) -> f64 {
        let at = |bound: &[(usize, f64); 3]| bound.iter().map(|(v, w)| self.mesh.positions[*v] * *w).sum::<DVec3>();
        let apart: f64 = fine.iter().zip(&self.bound).map(|(p, bound)| p.distance(at(bound))).sum();
        let edges = self.mesh.corners().map(|[a, b, c]| a.distance(b) + b.distance(c) + c.distance(a));
        let edge = edges.sum::<f64>() / (3 * self.mesh.triangles.len()) as f64;
        apart / fine.len() as f64 / edge
    }
}

/// The rotation nearest to a matrix (Higham's iteration for the polar decomposition); none where it has no inverse or
/// turns inside out.
fn nearest_rotation(matrix: DMat3) -> DMat3 {
    let size = matrix.to_cols_array().iter().map(|c| c * c).sum::<f64>().sqrt();
    let mut turn = matrix * (1.0 / size.max(f64::MIN_POSITIVE));
    for _ in 0..30 {
        let det = turn.determinant();
        if det.is_nan() || det < 1e-9 {
            return DMat3::IDENTITY;
        }
        let next = (turn + turn.inverse().transpose()) * 0.5;
        if next.abs_diff_eq(turn, 1e-12) {
            return next;
        }
        turn = next;
    }
    turn
}
