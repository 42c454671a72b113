//! The direction of the warp: up the texture, which is the sewing pattern where a garment has one; down the garment
//! where not.

use glam::{DVec2, DVec3};

use ctsn_rig::Garment;

/// Direction of the warp per triangle [t], unit length or zero where the texture says nothing; it need not lie in the
/// triangle.
pub(super) fn warp(garment: &Garment) -> Vec<DVec3> {
    let (mesh, surface) = (&garment.mesh, &garment.surface);
    let along = |(index, corners): (usize, &[u32; 3])| {
        let [a, b, c] = corners.map(|i| mesh.positions.get(i as usize).copied().unwrap_or_default());
        let drawn = surface.triangles.get(index).filter(|_| !surface.uv.is_empty())?;
        let welded = |k: usize| surface.vertex.get(drawn[k] as usize) == Some(&corners[k]);
        let [p, q, r]: [DVec2; 3] = drawn.map(|i| surface.uv.get(i as usize).copied().unwrap_or_default());
        let (pq, pr) = (q - p, r - p);
        // ∂x/∂v up to its length; its sign follows the area, so that mirrored panels run the same way.
        let up = ((c - a) * pq.x - (b - a) * pr.x) * pq.perp_dot(pr).signum();
        (0..3).all(welded).then(|| up.try_normalize()).flatten()
    };
    mesh.triangles.iter().enumerate().map(|each| along(each).unwrap_or(DVec3::Y)).collect()
}
