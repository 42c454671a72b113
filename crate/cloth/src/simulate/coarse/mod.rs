//! Fine garments travel coarse. A thinned one, of some of the fine one's own vertices, is carried along the path and
//! relaxed; the fine one is laid on it and relaxed from there. A Newton iteration costs five times as much at 6,000
//! vertices as at 1,500, and most of the iterations were spent on the way.

mod embedding;
mod thin;

use ctsn_rig::Mesh;
use glam::DVec3;

pub use self::embedding::Embedding;
use self::thin::{Thinned, thin};

/// Vertices of what a fine garment travels as.
pub const COARSE: usize = 1500;
/// Vertices of what is relaxed for coarse poses. With 350 a third of the time went into what is inside the body, and
/// more poses had too much cloth there, between them: docs/decisions/poses.md.
pub const COARSER: usize = 700;

/// A thinned garment and how the fine one lies on it.
pub(super) struct Coarse {
    pub embedding: Embedding,
    /// Direction of the warp per triangle of it.
    pub warp: Vec<DVec3>,
    /// The fine vertex that each of its vertices is.
    kept: Vec<usize>,
}

impl Coarse {
    /// Of so many vertices of a fine garment at rest with the direction of the warp per triangle.
    pub fn new(fine: &Mesh, warp: &[DVec3], vertices: usize) -> Self {
        let Thinned { mesh, kept, into } = thin(fine, vertices);
        let rings = mesh.rings();
        let mut fans = vec![Vec::new(); kept.len()];
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            triangle.iter().for_each(|&v| fans[v as usize].push(index));
        }
        // Near along the cloth: the nearest triangle in space may be of another layer.
        let near = |vertex: usize| {
            let into = into[vertex];
            rings.of(into as usize).iter().chain([&into]).flat_map(|&v| fans[v as usize].iter().copied()).collect()
        };
        let embedding = Embedding::among(mesh.clone(), &fine.positions, near);
        let mut around = vec![DVec3::ZERO; fine.positions.len()];
        for (triangle, warp) in fine.triangles.iter().zip(warp) {
            triangle.iter().for_each(|&v| around[v as usize] += *warp);
        }
        let mean = |t: &[u32; 3]| t.iter().map(|&v| around[kept[v as usize]]).sum::<DVec3>();
        let warp = mesh.triangles.iter().map(|t| mean(t).try_normalize().unwrap_or(DVec3::Y)).collect();
        Self { embedding, warp, kept }
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

    /// The fine garment on a coarse state `x`. So the fine drape's own folds come along.
    pub fn prolong(&self, template: &[DVec3], x: &[DVec3]) -> Vec<DVec3> {
        self.embedding.lay([template, &self.restrict(template)], x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::tests::scene::skirt;
    use glam::{DAffine3, DQuat};

    #[test]
    fn cloth_is_laid_on_another_mesh_of_it() {
        let (fine, coarse) = (skirt(96, 30), skirt(30, 9));
        let embedding = Embedding::new(coarse.clone(), &fine);
        assert!(embedding.distance(&fine.positions) < 0.1);
        // A wave along the height, of which a coarse mesh knows as much as a fine one.
        let wave = |x: &[DVec3]| x.iter().map(|p| *p + 0.02 * DVec3::X * (9.0 * p.y).sin()).collect::<Vec<_>>();
        let laid = embedding.lay([&fine.positions, &coarse.positions], &wave(&coarse.positions));
        let furthest = laid.iter().zip(wave(&fine.positions)).map(|(a, b)| a.distance(b)).fold(0.0, f64::max);
        assert!(furthest < 2e-3, "{furthest}");
    }

    #[test]
    fn a_fine_cloth_goes_where_its_coarse_one_goes() {
        let fine = skirt(96, 30);
        let coarse = Coarse::new(&fine, &vec![DVec3::Y; fine.triangles.len()], COARSE);
        assert!(coarse.embedding.mesh.positions.len() <= COARSE && coarse.warp.iter().all(|warp| *warp == DVec3::Y));
        let turn = DAffine3::from_rotation_translation(DQuat::from_rotation_x(2.0), DVec3::new(1.0, -2.0, 0.5));
        let moved = |x: &[DVec3]| x.iter().map(|p| turn.transform_point3(*p)).collect::<Vec<_>>();
        let laid = coarse.prolong(&fine.positions, &moved(&coarse.restrict(&fine.positions)));
        let wanted = moved(&fine.positions);
        let furthest = laid.iter().zip(&wanted).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(furthest < 1e-9, "{furthest}");
    }
}
