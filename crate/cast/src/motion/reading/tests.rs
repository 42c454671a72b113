//! Our own characters under other names, with other joints beside theirs, and under no names at all.

use super::*;
use crate::character::tests::{TWO_LEGGED, cast};
use crate::motion::clips;
use ctsn_rig::Joint;
use glam::{DAffine3, DVec3};

/// Names of the two-legged in other families: sides are `{}`.
const FAMILIES: [(&str, [&str; 2], [&str; 14]); 5] = [
    (
        "Unreal",
        ["l", "r"],
        [
            "pelvis",
            "spine_01",
            "spine_02",
            "spine_03",
            "neck_01",
            "head",
            "clavicle_{}",
            "upperarm_{}",
            "lowerarm_{}",
            "hand_{}",
            "thigh_{}",
            "calf_{}",
            "foot_{}",
            "ball_{}",
        ],
    ),
    (
        "VRoid",
        ["L", "R"],
        [
            "J_Bip_C_Hips",
            "J_Bip_C_Spine",
            "J_Bip_C_Chest",
            "J_Bip_C_UpperChest",
            "J_Bip_C_Neck",
            "J_Bip_C_Head",
            "J_Bip_{}_Shoulder",
            "J_Bip_{}_UpperArm",
            "J_Bip_{}_LowerArm",
            "J_Bip_{}_Hand",
            "J_Bip_{}_UpperLeg",
            "J_Bip_{}_LowerLeg",
            "J_Bip_{}_Foot",
            "J_Bip_{}_ToeBase",
        ],
    ),
    (
        "Rigify",
        ["L", "R"],
        [
            "DEF-spine",
            "DEF-spine.001",
            "DEF-spine.002",
            "DEF-spine.003",
            "DEF-spine.004",
            "DEF-spine.006",
            "DEF-shoulder.{}",
            "DEF-upper_arm.{}",
            "DEF-forearm.{}",
            "DEF-hand.{}",
            "DEF-thigh.{}",
            "DEF-shin.{}",
            "DEF-foot.{}",
            "DEF-toe.{}",
        ],
    ),
    (
        "Biped",
        ["L", "R"],
        [
            "Bip01 Pelvis",
            "Bip01 Spine",
            "Bip01 Spine1",
            "Bip01 Spine2",
            "Bip01 Neck",
            "Bip01 Head",
            "Bip01 {} Clavicle",
            "Bip01 {} UpperArm",
            "Bip01 {} Forearm",
            "Bip01 {} Hand",
            "Bip01 {} Thigh",
            "Bip01 {} Calf",
            "Bip01 {} Foot",
            "Bip01 {} Toe0",
        ],
    ),
    (
        "nobody",
        ["a", "b"],
        [
            "x_{}1", "x_{}2", "x_{}3", "x_{}4", "x_{}5", "x_{}6", "x_{}7", "x_{}8", "x_{}9", "x_{}10", "x_{}11",
            "x_{}12", "x_{}13", "x_{}14",
        ],
    ),
];
const OURS: [&str; 14] = [
    "Hips", "Spine", "Spine1", "Spine2", "Neck", "Head", "Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot",
    "ToeBase",
];

/// One of our characters with the names of a family.
fn renamed(name: &str, (_, sides, names): &(&str, [&str; 2], [&str; 14])) -> Character {
    let mut character = cast(name).clone();
    for joint in &mut character.joints {
        let (side, part) = match (joint.name.strip_prefix("Left"), joint.name.strip_prefix("Right")) {
            (Some(part), _) => (sides[0], part),
            (_, Some(part)) => (sides[1], part),
            _ => (sides[0], joint.name.as_str()),
        };
        let at = OURS.iter().position(|ours| *ours == part).expect("a part");
        joint.name = names[at].replace("{}", side);
    }
    character
}

/// The joints of every part, by number.
fn joints(reading: &Reading) -> BTreeMap<String, usize> {
    reading.parts.iter().map(|(part, (joint, _))| (part.clone(), *joint)).collect()
}

#[test]
fn other_names_mean_the_same_joints_and_the_same_motion() {
    for name in TWO_LEGGED {
        let own = cast(name);
        let wanted = Reading::two_legs(own);
        assert!(
            wanted.missing().is_empty() && wanted.parts.values().all(|(_, how)| *how == How::Name),
            "{name}: {wanted}"
        );
        for family in &FAMILIES {
            let other = renamed(name, family);
            let found = Reading::two_legs(&other);
            assert_eq!(joints(&found), joints(&wanted), "{name} of {}: {found}", family.0);
            let limbs = if family.0 == "nobody" { How::Place } else { How::Name };
            assert_eq!(found.parts["LeftForeArm"].1, limbs, "{name} of {}", family.0);
        }
    }
    let (own, other) = (cast("andy"), renamed("andy", &FAMILIES[4]));
    let [own, other] = [own, &other].map(|character| clips(character, 2.0).expect("motion"));
    assert_eq!(own, other);
}

/// Adds a joint that moves no more than a share of its parent's skin.
fn add(character: &mut Character, name: &str, parent: usize, shift: DVec3, share: f64) {
    let bind = character.joints[parent].inverse_bind.inverse();
    let joint = character.joints.len();
    let there = DAffine3::from_translation(shift) * bind;
    character.joints.push(Joint { name: name.to_string(), parent: Some(parent), inverse_bind: there.inverse() });
    for weights in character.body.weights.iter_mut().filter(|_| share > 0.0) {
        if let Some(at) = weights.iter().position(|weight| weight.0 == parent) {
            let moved = weights[at].1 * share;
            weights[at].1 -= moved;
            weights.push((joint, moved));
        }
    }
}

#[test]
fn helpers_fingers_and_hair_do_not_mislead() {
    for family in &FAMILIES {
        let mut character = renamed("mannequin", family);
        let wanted = joints(&Reading::two_legs(cast("mannequin")));
        for (side, sign) in [("Left", 1.0), ("Right", -1.0)] {
            let part = |part: &str| wanted[&format!("{side}{part}")];
            add(&mut character, "forearm_twist_01", part("ForeArm"), DVec3::X * 0.1 * sign, 0.3);
            add(&mut character, "ik_target", part("Foot"), DVec3::Y * -0.05, 0.0);
            for finger in 0..3 {
                let across = DVec3::Z * 0.02 * f64::from(finger);
                add(&mut character, "f", part("Hand"), DVec3::X * 0.08 * sign + across, 0.1);
                let last = character.joints.len() - 1;
                add(&mut character, "g", last, DVec3::X * 0.03 * sign, 0.4);
            }
            add(&mut character, "eye", wanted["Head"], DVec3::new(0.03 * sign, 0.08, 0.08), 0.05);
        }
        add(&mut character, "hair", wanted["Head"], DVec3::new(0.0, 0.2, -0.05), 0.1);
        assert_eq!(joints(&Reading::two_legs(&character)), wanted, "{}", family.0);
    }
}

#[test]
fn a_body_that_looks_back_walks_ahead() {
    let own = cast("andy");
    let mut back = own.clone();
    let turn = DAffine3::from_rotation_y(std::f64::consts::PI);
    back.body.mesh.positions.iter_mut().for_each(|point| *point = turn.transform_point3(*point));
    back.joints.iter_mut().for_each(|joint| joint.inverse_bind *= turn.inverse());
    let [wanted, found] = [own, &back].map(|character| clips(character, 2.0).expect("motion"));
    for (wanted, found) in wanted.iter().zip(&found) {
        for (wanted, found) in wanted.poses.iter().zip(&found.poses) {
            let [wanted, found] = [own.pose_body(wanted), back.pose_body(found)];
            let far = wanted.iter().zip(&found).map(|(a, b)| turn.transform_point3(*a).distance(*b));
            assert!(far.fold(0.0, f64::max) < 1e-6, "a pose differs");
        }
    }
}

#[test]
fn four_legs_are_read_without_names() {
    for name in ["cat", "fox"] {
        let own = cast(name);
        let wanted = Reading::four_legs(own);
        assert!(wanted.missing().is_empty(), "{name}: {wanted}");
        let mut other = own.clone();
        other.joints.iter_mut().enumerate().for_each(|(at, joint)| joint.name = format!("bone.{at:03}"));
        let found = Reading::four_legs(&other);
        assert_eq!(joints(&found), joints(&wanted), "{name}");
        assert!(found.parts.values().all(|(_, how)| *how == How::Place));
        assert_eq!(found.tail(&other), wanted.tail(own), "{name}");
        let clips = clips(&other, 5.0).expect("motion");
        assert!(clips.iter().any(|clip| clip.name.contains("walk")), "{name}");
        assert!(!Reading::two_legs(own).missing().is_empty(), "{name} is no human");
    }
}

#[test]
fn a_map_of_joints_goes_before_names_and_places() {
    let mut odd = renamed("andy", &FAMILIES[0]);
    let (hand, arm) = (odd.joint("hand_l").expect("a hand"), odd.joint("lowerarm_l").expect("an arm"));
    odd.joints[hand].name = "flap".into();
    odd.joints[arm].name = "flip".into();
    odd.parts = [("LeftForeArm".to_string(), arm), ("LeftHand".to_string(), hand)].into();
    let found = Reading::two_legs(&odd);
    assert_eq!(found.parts["LeftHand"], (hand, How::Told));
    assert!(found.to_string().contains("2 joints told: LeftForeArm = flip, LeftHand = flap"), "{found}");
    assert!(found.missing().is_empty(), "{found}");
}

#[test]
fn what_fits_nothing_is_told_the_nearest_reading() {
    let mut odd = cast("andy").clone();
    // Its left arm is all in one place.
    let shoulder = odd.joint("LeftShoulder").expect("a shoulder");
    for part in ["LeftArm", "LeftForeArm", "LeftHand"] {
        let joint = odd.joint(part).expect("a part");
        odd.joints[joint].inverse_bind = odd.joints[shoulder].inverse_bind;
        odd.joints[joint].name = format!("lump {joint}");
    }
    let message = clips(&odd, 5.0).expect_err("no left arm").to_string();
    for words in ["nearest to a body with two arms and two legs", "without LeftArm, LeftForeArm, LeftHand", "--joints"]
    {
        assert!(message.contains(words), "{message}");
    }
}
