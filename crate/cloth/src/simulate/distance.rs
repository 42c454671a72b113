//! Signed distances of cloth vertices to the posed body, for judging a prediction as the simulator judges itself.

use std::cell::LazyCell;

use glam::DVec3;

use super::bones::Bones;
use super::collider::{Collider, joints_near};
use super::posed::PosedBody;
use crate::Result;
use ctsn_rig::path::to_body_frame;
use ctsn_rig::{Character, Mesh, Pose};

/// Joints whose part of the body is further than this from the garment in the canonical pose are left out, metres.
const REACH: f64 = 0.3;

/// A vertex that is moved out of the body ends this far from it, metres, or on the way between two of its parts after
/// so many moves.
const CLEAR: f64 = 5e-4;
const MOVES: usize = 8;

/// Whether each joint's part of the body is one that `garment` feels, both canonical: the hands of a figure in a skirt
/// are not.
pub fn felt(character: &Character, garment: &Mesh) -> Result<Vec<bool>> {
    joints_near(character, &character.body, garment, REACH)
}

/// A body prepared for distance queries.
pub struct BodyDistance {
    character: Character,
    /// The body's own triangles, not its skin.
    pub(super) collider: Collider,
    bones: Bones,
}

impl BodyDistance {
    /// The body of `character` around `garment`, both canonical.
    pub fn new(character: &Character, garment: &Mesh) -> Result<Self> {
        let collider = Collider::new(character, &character.body, garment, REACH)?;
        let body = PosedBody::new(&collider, collider.body.mesh.positions.clone());
        let bones = Bones::new(character, garment, |point| body.encloses(point));
        Ok(Self { character: character.clone(), bones, collider })
    }

    /// The body in `pose` (world), in its body frame.
    pub(super) fn posed(&self, pose: &Pose) -> PosedBody<'_> {
        self.collider.pose(&self.character.skinning(&to_body_frame(&self.character, pose)))
    }

    /// Signed distance of each vertex [n] (body frame, metres) to the body in `pose` (world), negative inside;
    /// infinite where the body is further than half a metre.
    pub fn signed(&self, pose: &Pose, vertices: &[DVec3]) -> Vec<f64> {
        let body = self.posed(pose);
        let distance = |vertex: &DVec3| body.closest(*vertex, None, 0.5).map_or(f64::INFINITY, |hit| hit.distance);
        let signed = |vertex: &DVec3| match distance(vertex) {
            behind if behind < 0.0 && !body.encloses(*vertex) => -behind,
            distance => distance,
        };
        vertices.iter().map(signed).collect()
    }

    /// Name of a joint whose limb has come out through the garment in `pose` (world), if one has; vertices [n], body
    /// frame, metres.
    pub fn limb_out(&self, pose: &Pose, vertices: &[DVec3]) -> Option<&str> {
        let body = LazyCell::new(|| self.posed(pose));
        let joints: Vec<DVec3> = to_body_frame(&self.character, pose).iter().map(|joint| joint.translation).collect();
        let out = self.bones.out(&joints, vertices, |point| body.encloses(point))?;
        Some(&self.character.joints[out].name)
    }

    /// How many of the cloth's `edges` pass through a face of the body in `pose` (world); vertices [n], body frame,
    /// metres.
    pub fn crossed(&self, pose: &Pose, vertices: &[DVec3], edges: impl Iterator<Item = [usize; 2]>) -> usize {
        let body = self.posed(pose);
        edges.filter(|ends| body.crosses(ends.map(|end| vertices[end]))).count()
    }

    /// Moves the `chosen` among the vertices [n] (body frame, metres) that lie inside the body in `pose` (world) out of
    /// it, where that takes at most `limit` metres; how many were moved.
    pub fn lift(&self, pose: &Pose, vertices: &mut [DVec3], limit: f64, chosen: impl Fn(usize) -> bool) -> usize {
        let body = self.posed(pose);
        let mut moved = 0;
        for (_, vertex) in vertices.iter_mut().enumerate().filter(|(index, _)| chosen(*index)) {
            let mut place = *vertex;
            for _ in 0..MOVES {
                match body.closest(place, None, 0.5).filter(|hit| hit.distance < 0.0 && body.encloses(place)) {
                    Some(hit) => place += hit.normal * (CLEAR - hit.distance),
                    None => break,
                }
            }
            if place != *vertex && place.distance(*vertex) <= limit {
                *vertex = place;
                moved += 1;
            }
        }
        moved
    }
}
