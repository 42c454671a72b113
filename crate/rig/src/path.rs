//! The body frame `N` (network.md §1) and the fixed path from the canonical pose to a pose: per-joint slerp.
//! Every pose is reached from the canonical one; chaining poses would write their history into the data.

use glam::{DAffine3, DMat3};

use crate::{Character, Joint, Pose};

/// `N` of a pose.
pub fn body_frame(character: &Character, pose: &Pose) -> DAffine3 {
    let root = character.root;
    root_frame(&pose[root], &character.joints[root].inverse_bind)
}

/// `N` by the hip's world transform alone: translation by minus its position, then rotation about +Y by minus the
/// heading `ψ`, the twist about +Y of the rotation of `A_root`.
pub fn root_frame(root: &DAffine3, inverse_bind: &DAffine3) -> DAffine3 {
    let a = (*root * *inverse_bind).matrix3;
    // Row r, column c of A is `col(c)[r]`.
    let heading = (a.col(2)[0] - a.col(0)[2]).atan2(a.col(0)[0] + a.col(2)[2]);
    DAffine3::from_mat3(DMat3::from_rotation_y(-heading)) * DAffine3::from_translation(-root.translation)
}

/// `N·G_j` per joint.
pub fn to_body_frame(character: &Character, pose: &Pose) -> Pose {
    let frame = body_frame(character, pose);
    pose.iter().map(|joint| frame * *joint).collect()
}

/// Poses in the body frame from the canonical pose (first) to `pose` (last), `steps` + 1 of them. Joints interpolate
/// relative to their parent: rotation by slerp, translation and scale linearly; each pose is put back into its own
/// body frame, so the hip stays at the origin and only tilts.
pub fn path(character: &Character, pose: &Pose, steps: usize) -> Vec<Pose> {
    let start = to_body_frame(character, &character.canonical_pose());
    let end = to_body_frame(character, pose);
    let (from, to) = (local(character, &start), local(character, &end));
    let mut poses = vec![start];
    for step in 1..steps {
        let t = step as f64 / steps as f64;
        poses.push(to_body_frame(character, &mix(character, &from, &to, t)));
    }
    poses.push(end);
    poses
}

/// The pose a share `t` of the way from `a` to `b`, interpolated as on a [`path`].
pub fn between(character: &Character, a: &Pose, b: &Pose, t: f64) -> Pose {
    mix(character, &local(character, a), &local(character, b), t)
}

/// World transforms from those relative to the parents.
fn mix(character: &Character, from: &Pose, to: &Pose, t: f64) -> Pose {
    let mut world: Pose = Vec::with_capacity(from.len());
    for (joint, (a, b)) in character.joints.iter().zip(from.iter().zip(to)) {
        let between = interpolate(a, b, t);
        world.push(joint.parent.map_or(between, |parent| world[parent] * between));
    }
    world
}

/// Joint transforms relative to their parents.
pub(crate) fn local(character: &Character, pose: &Pose) -> Pose {
    let relative = |(index, parent): (usize, Option<usize>)| match parent {
        Some(parent) => pose[parent].inverse() * pose[index],
        None => pose[index],
    };
    character.joints.iter().map(|joint| joint.parent).enumerate().map(relative).collect()
}

fn interpolate(a: &DAffine3, b: &DAffine3, t: f64) -> DAffine3 {
    let ((sa, ra, ta), (sb, rb, tb)) = (a.to_scale_rotation_translation(), b.to_scale_rotation_translation());
    DAffine3::from_scale_rotation_translation(sa.lerp(sb, t), ra.slerp(rb, t), ta.lerp(tb, t))
}

/// `A_j^b (A_j^a)⁻¹` per joint: how each joint moves space from pose `a` to pose `b`.
pub fn motion(a: &Pose, b: &Pose) -> Vec<DAffine3> {
    a.iter().zip(b).map(|(a, b)| *b * a.inverse()).collect()
}

/// Whether every transform is finite and invertible, and there is one per joint.
pub fn is_sound(character: &Character, pose: &Pose) -> bool {
    check(character, pose).is_ok()
}

/// Why a pose is not sound, see [`is_sound`].
pub fn check(character: &Character, pose: &Pose) -> Result<(), String> {
    let (wanted, found) = (character.joints.len(), pose.len());
    if wanted != found {
        return Err(format!("pose: wanted {wanted} joints, found {found}"));
    }
    let sound = |(joint, bind): (&DAffine3, &Joint)| {
        let finite = joint.is_finite() && joint.translation.abs().max_element() < 1e6;
        // From the canonical pose: the lengths of a joint's own space may be in millimetres.
        finite && (joint.matrix3 * bind.inverse_bind.matrix3).determinant().abs() > 1e-12
    };
    let Some(at) = pose.iter().zip(&character.joints).position(|both| !sound(both)) else { return Ok(()) };
    let (name, transform) = (&character.joints[at].name, pose[at].matrix3);
    Err(format!("pose: wanted finite, invertible joints, found joint {at} ({name}) with {transform}"))
}
