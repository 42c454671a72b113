//! Limbs swung apart: in the canonical pose, legs that nearly touch would be wrapped as one.

use super::anatomy::{anatomy, below};
use ctsn_rig::{Character, Pose};
use glam::{DAffine3, DQuat};

/// Angle by which a limb is swung away from its mirror image, radians. (It parts the legs of a figure whose knees
/// nearly touch; creases at the hips stay shallow.)
const ANGLE: f64 = 0.25;

/// The canonical pose with mirrored limbs swung away from each other. An arm held out already points away from the
/// other and hardly moves.
pub fn apart(character: &Character) -> Pose {
    let mut pose = character.canonical_pose();
    let limbs = anatomy(character, character.body.mesh.extent()).limbs;
    for limb in &limbs {
        let Some(mirror) = limb.mirror.and_then(|mirror| limbs.get(mirror)) else { continue };
        let (Some(top), Some(tip), Some(other)) = (limb.path.first(), limb.path.last(), mirror.path.last()) else {
            continue;
        };
        let (along, away) = (*tip - *top, *tip - *other);
        let Some(axis) = along.cross(away).try_normalize() else { continue };
        let turn = DQuat::from_axis_angle(axis, along.angle_between(away).min(ANGLE));
        let turn = DAffine3::from_rotation_translation(turn, *top - turn * *top);
        let moved = below(character, limb.chain[0]);
        pose.iter_mut().zip(moved).filter(|(_, moved)| *moved).for_each(|(joint, _)| *joint = turn * *joint);
    }
    pose
}
