//! Motion of our own characters on one another, and on skeletons of other names, postures and directions.

use super::*;
use crate::character::tests::cast;
use ctsn_rig::Joint;
use glam::DAffine3;

/// A character with every so many poses of one clip.
fn moving(name: &str, clip: &str) -> Character {
    let mut character = cast(name).clone();
    character.clips.retain(|known| known.name == clip);
    character.clips.iter_mut().for_each(|clip| clip.poses = clip.poses.iter().step_by(15).cloned().collect());
    assert!(character.clips.len() == 1 && character.clips[0].poses.len() > 5, "{name} has {clip}");
    character
}

/// Where the bones of the limbs point in a pose, by their parts.
fn directions(character: &Character, pose: &Pose) -> Vec<(String, DVec3)> {
    let (_, reading) = Reading::nearest(character);
    let bone = |side: &str, from: &str, to: &str| {
        let part = |part: &str| reading.find(&format!("{side}{part}")).map(|joint| pose[joint].translation);
        Some((format!("{side}{from}"), (part(to)? - part(from)?).normalize()))
    };
    let bones = LIMBS.iter().flat_map(|[upper, lower, end]| [(upper, lower), (lower, end)]);
    bones.flat_map(|(from, to)| ["Left", "Right"].map(|side| bone(side, from, to))).flatten().collect()
}

/// The bones of `onto` point where those of `from` do, turned by `facing`; at most `degrees` beside it.
fn assert_alike(from: &Character, onto: &Character, facing: DQuat, degrees: f64) {
    let clips = retarget(from, onto).expect("motion");
    assert_eq!(clips[0].poses.len(), from.clips[0].poses.len());
    for (ours, theirs) in from.clips[0].poses.iter().zip(&clips[0].poses) {
        assert!(theirs.iter().all(DAffine3::is_finite));
        let (ours, theirs) = (directions(from, ours), directions(onto, theirs));
        assert!(ours.len() >= 8, "{} bones", ours.len());
        for ((part, ours), (_, theirs)) in ours.iter().zip(&theirs) {
            let angle = (facing * *ours).angle_between(*theirs).to_degrees();
            assert!(angle <= degrees, "{part}: {angle}° beside the other's");
        }
    }
}

#[test]
fn motion_on_the_body_that_it_is_of_is_the_same() {
    for (name, clip) in [("andy", "kick"), ("cat", "walk")] {
        let character = moving(name, clip);
        let clips = retarget(&character, &character).expect("motion");
        for (ours, theirs) in character.clips[0].poses.iter().zip(&clips[0].poses) {
            let apart = ours.iter().zip(theirs).map(|(a, b)| a.translation.distance(b.translation));
            let apart = apart.fold(0.0, f64::max);
            assert!(apart < 1e-6, "{name}: a joint is {apart} m elsewhere");
        }
    }
}

#[test]
fn limbs_of_other_lengths_point_where_the_first_ones_do() {
    assert_alike(&moving("andy", "kick"), cast("anna"), DQuat::IDENTITY, 1e-4);
    assert_alike(&moving("andy", "throw"), cast("monster"), DQuat::IDENTITY, 1e-4);
    assert_alike(&moving("cat", "swat"), cast("fox"), DQuat::IDENTITY, 1e-4);
}

#[test]
fn a_body_bound_in_another_posture_that_faces_elsewhere_moves_alike() {
    let mut other = cast("anna").clone();
    // Bound in a pose of its own, without a name, turned to the side.
    let bound = moving("anna", "wave").clips[0].poses[3].clone();
    let side = DAffine3::from_rotation_y(1.2);
    for (number, (joint, pose)) in other.joints.iter_mut().zip(&bound).enumerate() {
        *joint = Joint { name: format!("bone.{number}"), inverse_bind: (side * *pose).inverse(), ..joint.clone() };
    }
    let named = cast("anna").joints.iter().enumerate().map(|(number, joint)| (joint.name.clone(), number));
    let known = crate::motion::reading::parts();
    other.parts = named.filter(|(name, _)| known.contains(&name.as_str())).collect();
    let andy = moving("andy", "kick");
    let [from, onto] = [&andy, &other].map(|character| Body::new(character).expect("a body").1.heading);
    let facing = onto * from.inverse();
    // Her hips, from which her direction is read, are turned a little in that pose.
    assert!(facing.angle_between(DQuat::from_rotation_y(1.2)).to_degrees() < 5.0, "{facing}");
    assert_alike(&andy, &other, facing, 1e-4);
}

#[test]
fn longer_legs_step_wider() {
    let (from, onto) = (moving("andy", "walk"), cast("monster"));
    let clips = retarget(&from, onto).expect("motion");
    let (andy, monster) = (Body::new(&from).expect("a body").1, Body::new(onto).expect("a body").1);
    let walked = |clip: &Clip, hips: usize| clip.poses[0][hips].translation.distance(clip.poses[2][hips].translation);
    let ratio = walked(&clips[0], monster.hips) / walked(&from.clips[0], andy.hips);
    assert!((ratio - monster.leg / andy.leg).abs() < 1e-6, "{ratio}");
}

#[test]
fn what_has_other_limbs_is_refused() {
    let refused = |onto: &str| retarget(&moving("andy", "kick"), cast(onto)).expect_err("refused").to_string();
    assert!(refused("cat").contains("two arms and two legs fits no body with four legs"), "{}", refused("cat"));
    assert!(refused("sphere").contains("nearest to a body with"), "{}", refused("sphere"));
}
