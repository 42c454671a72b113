//! A mesh that follows joints by linear blend skinning: a body, its outer skin, the cloth of a plain skinning.

use crate::Mesh;
use glam::{DAffine3, DVec3};
use std::collections::{BTreeMap, BTreeSet};

/// Skin weights of one vertex: (joint, weight), weights positive with sum one, strongest first.
pub type SkinWeights = Vec<(usize, f64)>;

/// A mesh in the canonical pose and the joints its vertices follow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkinnedMesh {
    /// The mesh in the canonical pose.
    pub mesh: Mesh,
    /// Skin weights per vertex.
    pub weights: Vec<SkinWeights>,
}

impl SkinnedMesh {
    /// Linear blend skinning with `A_j` per joint: canonical positions [n] -> posed positions [n].
    pub fn pose(&self, skinning: &[DAffine3]) -> Vec<DVec3> {
        let blend = |(rest, weights): (&DVec3, &SkinWeights)| {
            weights.iter().map(|&(joint, weight)| skinning[joint].transform_point3(*rest) * weight).sum()
        };
        self.mesh.positions.iter().zip(&self.weights).map(blend).collect()
    }

    /// As much of it as the joints that `kept` wants move most.
    pub fn part(&self, kept: impl Fn(usize) -> bool) -> SkinnedMesh {
        let owned = |vertex: u32| kept(strongest(&self.weights[vertex as usize]));
        let triangles = || self.mesh.triangles.iter().filter(|triangle| owned(triangle[0]));
        let used: BTreeSet<u32> = triangles().flatten().copied().collect();
        let place: BTreeMap<u32, u32> = used.iter().zip(0..).map(|(old, new)| (*old, new)).collect();
        let mesh = Mesh {
            positions: used.iter().map(|old| self.mesh.positions[*old as usize]).collect(),
            triangles: triangles().map(|triangle| triangle.map(|old| place[&old])).collect(),
        };
        SkinnedMesh { mesh, weights: used.iter().map(|old| self.weights[*old as usize].clone()).collect() }
    }

    /// Puts another one behind it.
    pub fn extend(&mut self, other: SkinnedMesh) {
        let first = self.mesh.positions.len() as u32;
        let moved = other.mesh.triangles.iter().map(|triangle| triangle.map(|corner| first + corner));
        self.mesh.triangles.extend(moved);
        self.mesh.positions.extend(other.mesh.positions);
        self.weights.extend(other.weights);
    }
}

/// The joint that moves a vertex most, the first of equals; 0 for a vertex without weights.
pub fn strongest(weights: &SkinWeights) -> usize {
    let stronger = |best: (usize, f64), &next: &(usize, f64)| if next.1 > best.1 { next } else { best };
    weights.iter().fold((0, 0.0), stronger).0
}
