//! The body's skin brought down to where simulated cloth lies on it.

use super::collider::Collider;
use ctsn_rig::SkinnedMesh;
use glam::{DAffine3, DVec3};
use rayon::prelude::*;

/// Cloth so near to the skin lies on it, and is no deeper in it, metres.
const NEAR: f64 = 0.006;
/// So much of the cloth that lies on a vertex of the skin is to have its gap there.
const SHARE: f64 = 0.65;
/// What so few have met tells nothing of a vertex.
const FEWEST: usize = 5;
/// A corner with less of a place says nothing about it.
const LEAST: f64 = 0.2;
/// Rounds of lowering, each by so much of what is lacking.
const ROUNDS: usize = 4;
const STEP: f64 = 0.7;

/// `skin` lowered along its normals, at most by [`NEAR`], until cloth that lies on it in simulated poses, `A_j` [J] and
/// its vertices [n] each, in metres of the body frame, has a gap of `gap` metres. Coarse triangles stand out from what
/// they were wrapped around, and were [raised](super::covering) over it: cloth that is kept out of them is stretched.
pub fn fitted(skin: SkinnedMesh, gap: f64, worn: &[(Vec<DAffine3>, Vec<DVec3>)]) -> SkinnedMesh {
    let Some(joints) = worn.first().map(|(skinning, _)| skinning.len()) else { return skin };
    let collider = Collider::of_joints(&skin, &vec![true; joints]);
    let mut heights = vec![0.0; collider.body.weights.len()];
    for _ in 0..ROUNDS {
        let lacks = |(skinning, cloth): &(Vec<DAffine3>, Vec<DVec3>)| lacks(&collider, &heights, skinning, cloth, gap);
        let mut found: Vec<(u32, f64)> = worn.par_iter().flat_map_iter(lacks).collect();
        found.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        for met in found.chunk_by(|a, b| a.0 == b.0).filter(|met| met.len() >= FEWEST) {
            let (vertex, lack) = met[((met.len() - 1) as f64 * SHARE) as usize];
            let height = &mut heights[vertex as usize];
            *height = (*height - STEP * lack).clamp(-NEAR, 0.0);
        }
    }
    collider.reshaped(&heights)
}

/// What cloth on the skin lacks to the gap, by the vertices of the skin that it lies on.
fn lacks(collider: &Collider, heights: &[f64], skinning: &[DAffine3], cloth: &[DVec3], gap: f64) -> Vec<(u32, f64)> {
    let posed = collider.raised(skinning, heights, 1.0);
    let lack = |vertex: &DVec3| {
        let hit = posed.closest(*vertex, None, NEAR)?;
        let corners = collider.face(hit.face).into_iter().zip(hit.barycentric);
        Some(corners.filter(|(_, share)| *share > LEAST).map(move |(corner, _)| (corner, gap - hit.distance)))
    };
    cloth.iter().filter_map(lack).flatten().collect()
}
