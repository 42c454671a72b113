//! What authoring passes from stage to stage: a rigged character in its canonical pose, its motion, a garment.
//! Units: metres, right-handed, +Y up (glTF). All of it f64; the network's f32 begins at the dataset.

use crate::{Mesh, SkinnedMesh};
use glam::{DAffine3, DVec2, DVec3};
use std::collections::BTreeMap;

/// Joint world transforms `G_j` of one pose, one per joint of the [`Character`], in metres.
pub type Pose = Vec<DAffine3>;

/// One joint of the skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name in the file, unique within the character.
    pub name: String,
    /// Index of the parent joint; parents stand before their children. `None` for a top joint.
    pub parent: Option<usize>,
    /// `B_j⁻¹`: canonical (bind) space in metres to joint space, so that `A_j = G_j · B_j⁻¹`.
    pub inverse_bind: DAffine3,
}

/// What is drawn of a welded [`Mesh`]: vertices split at seams.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Drawn vertex -> vertex of the welded mesh.
    pub vertex: Vec<u32>,
    /// Texture coordinates per drawn vertex; zero in a part of the file that has none, empty when no part has any.
    pub uv: Vec<DVec2>,
    /// Drawn-vertex indices, three per triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Linear RGB base colour per drawn vertex; empty when the file has none.
    pub colour: Vec<[f32; 3]>,
}

/// What a vertex of a drawn mesh rides on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rider {
    /// Three vertices of the cloth.
    pub corners: [u32; 3],
    /// Their barycentric coordinates, negative beyond the triangle, and the offset along the normal between those of
    /// the corners, metres.
    pub coordinates: [f64; 4],
}

/// A mesh that is drawn where the cloth is another: it rides on the cloth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    /// Its vertices, one per position.
    pub riders: Vec<Rider>,
    /// What is drawn of it: drawn vertex -> rider.
    pub surface: Surface,
}

impl Drawn {
    /// The same on a cloth whose faces were all turned.
    pub fn turn(&mut self) {
        self.riders.iter_mut().for_each(|rider| rider.coordinates[3] *= -1.0);
        self.surface.triangles.iter_mut().for_each(|face| face.swap(1, 2));
    }
}

/// Motion sampled at a fixed rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// Name in the file.
    pub name: String,
    /// Poses per second.
    pub rate: f64,
    /// One pose per frame.
    pub poses: Vec<Pose>,
}

/// A rigged character: skeleton, skinned body and motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Character {
    /// Joints, parents first.
    pub joints: Vec<Joint>,
    /// The hip: the joint whose position and heading define the body frame.
    pub root: usize,
    /// The body in the canonical pose.
    pub body: SkinnedMesh,
    /// What is drawn of the body.
    pub surface: Surface,
    /// Motion.
    pub clips: Vec<Clip>,
    /// Metres per unit of the file it came from (0.01 for a file in centimetres).
    pub metres_per_unit: f64,
    /// Joints that the file, or whoever runs us, says to be parts of a body: `Hips`, `LeftArm`, … Mostly empty: then
    /// they are found by names and places.
    pub parts: BTreeMap<String, usize>,
}

/// A garment: the cloth mesh in the canonical pose's space, and what is drawn of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Garment {
    /// Welded cloth mesh, metres.
    pub mesh: Mesh,
    /// What is drawn of it (seams split, UVs).
    pub surface: Surface,
    /// Vertices of the cloth mesh that are sprung to the body, as a waistband or a collar is; ascending.
    pub pins: Vec<u32>,
    /// The mesh that its maker drew, where the cloth is another.
    pub drawn: Option<Drawn>,
}

impl Character {
    /// The pose whose skinning leaves the body where it is: `G_j = B_j`.
    pub fn canonical_pose(&self) -> Pose {
        self.joints.iter().map(|joint| joint.inverse_bind.inverse()).collect()
    }

    /// `A_j = G_j · B_j⁻¹` per joint.
    pub fn skinning(&self, pose: &Pose) -> Vec<DAffine3> {
        pose.iter().zip(&self.joints).map(|(joint, bind)| *joint * bind.inverse_bind).collect()
    }

    /// Linear blend skinning of the body: canonical positions [b] -> posed positions [b].
    pub fn pose_body(&self, pose: &Pose) -> Vec<DVec3> {
        self.body.pose(&self.skinning(pose))
    }

    /// The clip of that name; the error names the clips there are.
    pub fn clip(&self, name: &str) -> crate::Result<&Clip> {
        let found = self.clips.iter().find(|clip| clip.name == name);
        found.ok_or_else(|| {
            let names: Vec<&str> = self.clips.iter().map(|clip| clip.name.as_str()).collect();
            let names = if names.is_empty() { "no clip at all".to_string() } else { names.join(", ") };
            crate::Error::Character(format!("wanted the clip {name:?}, found {names}"))
        })
    }

    /// Whether a joint is an obstacle.
    pub fn is_obstacle(&self, joint: usize) -> bool {
        self.joints.get(joint).is_some_and(|joint| is_obstacle(&joint.name))
    }

    /// Index of the joint of that name.
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }
}

/// Whether the mesh of a joint of that name is a rigid obstacle, which moves against the cloth and is not dressed.
pub fn is_obstacle(name: &str) -> bool {
    name.to_lowercase().contains("obstacle")
}

/// Whether each joint begins a limb: a chain of joints beside another one, hanging from the same joint. What has
/// nothing below it, a twist helper or an ear, is no chain. Only joints that `counts` names are looked at; parents
/// stand before their children.
pub fn limbs(parents: &[Option<usize>], counts: impl Fn(usize) -> bool) -> Vec<bool> {
    let goes_on = |joint: usize| counts(joint) && parents.contains(&Some(joint));
    let chains = |of: usize| (0..parents.len()).filter(|joint| parents[*joint] == Some(of) && goes_on(*joint)).count();
    (0..parents.len()).map(|joint| goes_on(joint) && parents[joint].is_some_and(|parent| chains(parent) > 1)).collect()
}

/// A row-major 3×4 transform in f32, as model files and datasets keep it.
pub fn row_major(transform: &DAffine3) -> [f32; 12] {
    let (matrix, t) = (transform.matrix3, transform.translation);
    std::array::from_fn(|e| if e % 4 == 3 { t[e / 4] } else { matrix.col(e % 4)[e / 4] } as f32)
}

/// The inverse of [`row_major`].
pub fn affine(numbers: &[f32; 12]) -> DAffine3 {
    let column = |c: usize| DVec3::new(numbers[c].into(), numbers[4 + c].into(), numbers[8 + c].into());
    DAffine3::from_cols(column(0), column(1), column(2), column(3))
}

/// Joint transforms of a pose as numbers [J, 3, 4].
pub fn joints(pose: &Pose) -> Vec<f32> {
    pose.iter().flat_map(row_major).collect()
}

/// The inverse of [`joints`].
pub fn pose(joints: &[f32]) -> Pose {
    joints.as_chunks::<12>().0.iter().map(affine).collect()
}

/// Vertices as numbers [n, 3].
pub fn numbers(vertices: &[DVec3]) -> Vec<f32> {
    vertices.iter().flat_map(|vertex| vertex.to_array().map(|value| value as f32)).collect()
}

/// The inverse of [`numbers`].
pub fn vertices(numbers: &[f32]) -> Vec<DVec3> {
    numbers.as_chunks::<3>().0.iter().map(|vertex| DVec3::from_array(vertex.map(f64::from))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_survive_their_row_major_form() {
        let turn = glam::DQuat::from_rotation_x(0.3);
        let there = DAffine3::from_scale_rotation_translation(DVec3::splat(0.9), turn, DVec3::new(0.1, 0.7, -2.0));
        let back = affine(&row_major(&there));
        assert!((back.matrix3 - there.matrix3).to_cols_array().iter().all(|error| error.abs() < 1e-7));
        assert!((back.translation - there.translation).length() < 1e-7);
    }
}
