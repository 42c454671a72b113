//! Fine garments travel coarse. A thinned one, of some of the fine one's own vertices, is carried along the path and
//! relaxed; the fine one is laid on it and relaxed from there. A Newton iteration costs five times as much at 6,000
//! vertices as at 1,500, and most of the iterations were spent on the way.

mod thin;

use ctsn_core::topology::Graph;
use ctsn_rig::Mesh;
use ctsn_rig::mesh::triangle::closest;
use glam::{DMat3, DVec3};

use self::thin::{Thinned, thin};

/// Vertices of the coarse garment.
const COARSE: usize = 1500;

/// A thinned garment and how the fine one lies on it.
pub(super) struct Coarse {
    pub mesh: Mesh,
    /// Direction of the warp per triangle of it.
    pub warp: Vec<DVec3>,
    /// The fine vertex that each of its vertices is.
    kept: Vec<usize>,
    /// Three vertices of it and their barycentric weights, for each fine vertex.
    bound: Vec<[(usize, f64); 3]>,
    rings: Graph<Vec<u32>>,
}

impl Coarse {
    /// Of a fine garment at rest with the direction of the warp per triangle.
    pub fn new(fine: &Mesh, warp: &[DVec3]) -> Self {
        let Thinned { mesh, kept, into } = thin(fine, COARSE);
        let rings = mesh.rings();
        let mut fans = vec![Vec::new(); kept.len()];
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            triangle.iter().for_each(|&v| fans[v as usize].push(index));
        }
        let bind = |(point, &into): (&DVec3, &u32)| {
            // Near along the cloth: the nearest triangle in space may be of another layer.
            let near = rings.of(into as usize).iter().chain([&into]).flat_map(|&v| &fans[v as usize]);
            let place = near.map(|&t| {
                let corners = mesh.triangles[t].map(|v| mesh.positions[v as usize]);
                let weights = closest(*point, corners);
                let at: DVec3 = corners.iter().zip(weights).map(|(corner, weight)| *corner * weight).sum();
                (at.distance_squared(*point), t, weights)
            });
            let (_, t, weights) = place.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).unwrap_or_default();
            [0, 1, 2].map(|k| (mesh.triangles[t][k] as usize, weights[k]))
        };
        let bound = fine.positions.iter().zip(&into).map(bind).collect();
        let mut around = vec![DVec3::ZERO; fine.positions.len()];
        for (triangle, warp) in fine.triangles.iter().zip(warp) {
            triangle.iter().for_each(|&v| around[v as usize] += *warp);
        }
        let mean = |t: &[u32; 3]| t.iter().map(|&v| around[kept[v as usize]]).sum::<DVec3>();
        let warp = mesh.triangles.iter().map(|t| mean(t).try_normalize().unwrap_or(DVec3::Y)).collect();
        Self { mesh, warp, kept, bound, rings }
    }

    /// What the coarse garment has of a fine state.
    pub fn restrict(&self, fine: &[DVec3]) -> Vec<DVec3> {
        self.kept.iter().map(|&v| fine[v]).collect()
    }

    /// The coarse ones among some fine vertices.
    pub fn restrict_vertices(&self, fine: &[u32]) -> Vec<u32> {
        let chosen = |(_, kept): &(u32, &usize)| fine.contains(&(**kept as u32));
        (0..).zip(&self.kept).filter(chosen).map(|(coarse, _)| coarse).collect()
    }

    /// The fine garment on a coarse state `x`, each vertex where its three coarse ones, each turned as its ring is
    /// turned from the template, take it (embedded deformation, Sumner et al. 2007). So the fine drape's own folds come
    /// along, and the surface bends smoothly across the coarse edges.
    pub fn prolong(&self, template: &[DVec3], x: &[DVec3]) -> Vec<DVec3> {
        let rest = self.restrict(template);
        let normals = [&rest[..], x].map(|state| self.mesh.normals(state));
        let turn = |v: usize| {
            let legs = self.rings.of(v).iter().map(|&w| w as usize);
            let (sum, square) = legs.fold((DMat3::ZERO, 0.0), |(sum, square), w| {
                let (from, to) = (rest[w] - rest[v], x[w] - x[v]);
                (sum + dyad(to, from), square + from.length_squared())
            });
            nearest_rotation(sum + dyad(normals[1][v], normals[0][v]) * (0.5 * square))
        };
        let turns: Vec<DMat3> = (0..x.len()).map(turn).collect();
        let place = |(start, bound): (&DVec3, &[(usize, f64); 3])| {
            bound.iter().map(|&(v, weight)| (x[v] + turns[v] * (*start - rest[v])) * weight).sum()
        };
        template.iter().zip(&self.bound).map(place).collect()
    }
}

/// `a bᵀ`.
fn dyad(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::tests::scene::skirt;
    use glam::{DAffine3, DQuat};

    #[test]
    fn a_fine_cloth_goes_where_its_coarse_one_goes() {
        let fine = skirt(96, 30);
        let coarse = Coarse::new(&fine, &vec![DVec3::Y; fine.triangles.len()]);
        assert!(coarse.mesh.positions.len() <= COARSE && coarse.warp.iter().all(|warp| *warp == DVec3::Y));
        let turn = DAffine3::from_rotation_translation(DQuat::from_rotation_x(2.0), DVec3::new(1.0, -2.0, 0.5));
        let moved = |x: &[DVec3]| x.iter().map(|p| turn.transform_point3(*p)).collect::<Vec<_>>();
        let laid = coarse.prolong(&fine.positions, &moved(&coarse.restrict(&fine.positions)));
        let wanted = moved(&fine.positions);
        let furthest = laid.iter().zip(&wanted).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(furthest < 1e-9, "{furthest}");
    }
}
