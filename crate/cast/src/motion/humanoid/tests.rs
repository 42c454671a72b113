//! Motion must be finite, closed, smooth, on the floor and within reach of the joints.

mod anatomy;

use super::*;
use crate::character::tests::{TWO_LEGGED, cast};
use crate::motion::{RATE, clips};
use ctsn_rig::{Joint, SkinnedMesh, Surface};
use glam::{DAffine3, DQuat, DVec3};

/// A skeleton in a T-pose with twisted joint axes, prefixed names and no mesh: what a foreign file may bring.
fn stick_figure() -> Character {
    let rows = [
        ("Hips", None, [0.0, 0.9, 0.0]),
        ("Spine", Some(0), [0.0, 1.0, 0.0]),
        ("Spine1", Some(1), [0.0, 1.15, 0.0]),
        ("Neck", Some(2), [0.0, 1.4, 0.0]),
        ("Head", Some(3), [0.0, 1.5, 0.0]),
        ("LeftArm", Some(2), [0.17, 1.36, 0.0]),
        ("LeftForeArm", Some(5), [0.43, 1.36, -0.01]),
        ("LeftHand", Some(6), [0.67, 1.36, 0.0]),
        ("RightArm", Some(2), [-0.17, 1.36, 0.0]),
        ("RightForeArm", Some(8), [-0.43, 1.36, -0.01]),
        ("RightHand", Some(9), [-0.67, 1.36, 0.0]),
        ("LeftUpLeg", Some(0), [0.09, 0.86, 0.0]),
        ("LeftLeg", Some(11), [0.09, 0.46, 0.01]),
        ("LeftFoot", Some(12), [0.09, 0.07, 0.0]),
        ("RightUpLeg", Some(0), [-0.09, 0.86, 0.0]),
        ("RightLeg", Some(14), [-0.09, 0.46, 0.01]),
        ("RightFoot", Some(15), [-0.09, 0.07, 0.0]),
    ];
    let joint = |(i, &(name, parent, place)): (usize, &(&str, Option<usize>, [f64; 3]))| Joint {
        name: format!("rig:{name}"),
        parent,
        inverse_bind: DAffine3::from_rotation_translation(
            DQuat::from_rotation_x(0.7 * i as f64),
            DVec3::from_array(place),
        )
        .inverse(),
    };
    Character {
        joints: rows.iter().enumerate().map(joint).collect(),
        root: 0,
        body: SkinnedMesh::default(),
        surface: Surface::default(),
        clips: vec![],
        metres_per_unit: 1.0,
        parts: Default::default(),
    }
}

fn each_step(clip: &Clip, mut check: impl FnMut(usize, DVec3, DVec3)) {
    for pair in clip.poses.windows(2) {
        (0..pair[0].len()).for_each(|joint| check(joint, pair[0][joint].translation, pair[1][joint].translation));
    }
}

#[test]
fn clips_are_finite_closed_and_slow_enough() {
    let clips = clips(&stick_figure(), RATE).expect("a humanoid");
    assert!(clips.len() >= 12, "{} clips", clips.len());
    for clip in &clips {
        assert!(clip.poses.iter().flatten().all(DAffine3::is_finite), "{}", clip.name);
        let (first, last) = (&clip.poses[0], &clip.poses[clip.poses.len() - 1]);
        let gap = first.iter().zip(last).map(|(a, b)| (a.translation - b.translation).length()).fold(0.0, f64::max);
        assert!(gap < 1e-9, "{} ends {gap} m from where it began", clip.name);
        each_step(clip, |joint, from, to| {
            let speed = from.distance(to) * clip.rate;
            assert!(speed < 5.0, "{}: joint {joint} moves at {speed} m/s", clip.name);
        });
    }
}

#[test]
fn speed_is_continuous() {
    // At four times the rate a jump in velocity stays a jump, while a smooth change shrinks to a quarter.
    let figure = stick_figure();
    let jump = |rate: f64| -> Vec<f64> {
        let worst = |clip: &Clip| {
            let n = clip.poses.len() - 1;
            let velocity = |frame: usize, joint: usize| {
                (clip.poses[frame % n + 1][joint].translation - clip.poses[frame % n][joint].translation) * clip.rate
            };
            let change = |frame: usize| {
                (0..figure.joints.len())
                    .map(|j| velocity(frame, j).distance(velocity(frame + 1, j)))
                    .fold(0.0, f64::max)
            };
            (0..n).map(change).fold(0.0, f64::max)
        };
        clips(&figure, rate).expect("a humanoid").iter().map(worst).collect()
    };
    for (coarse, fine) in jump(60.0).iter().zip(jump(240.0)) {
        assert!(fine < 0.45 * coarse + 0.01, "velocity jumps by {fine} m/s at 240 Hz, {coarse} at 60 Hz");
    }
}

#[test]
fn bones_keep_their_lengths_and_joints_stay_rigid() {
    let figure = stick_figure();
    let bind = figure.canonical_pose();
    for clip in clips(&figure, 10.0).expect("a humanoid") {
        for pose in &clip.poses {
            for (j, joint) in figure.joints.iter().enumerate() {
                assert!((pose[j].matrix3.determinant() - 1.0).abs() < 1e-9, "{} {}", clip.name, joint.name);
                let Some(parent) = joint.parent else { continue };
                let length = |pose: &[DAffine3]| pose[j].translation.distance(pose[parent].translation);
                let (clip, bone) = (&clip.name, &joint.name);
                assert!((length(pose) - length(&bind)).abs() < 1e-9, "{clip}: bone of {bone} changes length");
            }
        }
    }
}

#[test]
fn clips_are_many_and_long_enough() {
    for name in TWO_LEGGED {
        let clips = &cast(name).clips;
        let seconds: f64 = clips.iter().map(|clip| (clip.poses.len() - 1) as f64 / clip.rate).sum();
        assert!(clips.len() >= 20 && (150.0..300.0).contains(&seconds), "{name}: {} clips, {seconds} s", clips.len());
        let names: std::collections::BTreeSet<&str> = clips.iter().map(|clip| clip.name.as_str()).collect();
        assert_eq!(names.len(), clips.len(), "{name}: two clips of one name");
    }
}

#[test]
fn feet_stay_on_the_floor_and_the_root_near_its_place() {
    for name in TWO_LEGGED {
        let character = cast(name);
        let (bind, feet) =
            (character.canonical_pose(), ["LeftFoot", "RightFoot"].map(|foot| character.joint(foot).expect(foot)));
        for clip in &character.clips {
            // In these moves both feet leave the floor: how high the lowest point may then be, metres.
            let flights = [("jump", 0.40), ("run", 0.12), ("jog", 0.10)];
            let most = flights.iter().find(|flight| flight.0 == clip.name).map_or(0.06, |flight| flight.1);
            for pose in clip.poses.iter().step_by(7) {
                let low = character.pose_body(pose).iter().map(|p| p.y).fold(f64::MAX, f64::min);
                assert!((-0.022..most).contains(&low), "{name}, {}: lowest point at {low} m", clip.name);
                let root = pose[character.root].translation.with_y(0.0).length();
                assert!(root < 0.5, "{name}, {} wanders off: {root} m", clip.name);
                // Also far apart, both feet reach the floor; a heel is up by 10° at most.
                let lifted = |joint: usize| pose[joint].translation.y - bind[joint].translation.y;
                let up = feet.map(lifted).into_iter().fold(0.0, f64::max);
                assert!(!clip.name.starts_with("wander") || up < 0.04, "{name}, {}: a foot {up} m up", clip.name);
            }
        }
    }
}

/// Where arms give way to the body, their path stays smooth: a change of velocity shrinks with the time step.
#[test]
fn giving_way_is_smooth() {
    let humanoid = Humanoid::new(cast("monster")).expect("a humanoid");
    let keys = wander::keys(1);
    let jump = |rate: f64| {
        let pose = |frame: usize| humanoid.pose(&through(&keys, wander::PERIOD, frame as f64 / rate));
        let hands: Vec<[DVec3; 2]> = (0..(4.0 * rate) as usize)
            .map(pose)
            .map(|pose| [9, 16].map(|hand: usize| pose[hand].translation))
            .collect();
        let change = |w: &[[DVec3; 2]]| {
            (0..2).map(|side| (w[2][side] - 2.0 * w[1][side] + w[0][side]).length() * rate).fold(0.0, f64::max)
        };
        hands.windows(3).map(change).fold(0.0, f64::max)
    };
    let (coarse, fine) = (jump(60.0), jump(240.0));
    assert!(fine < 0.5 * coarse + 0.01, "velocity jumps by {fine} m/s at 240 Hz, {coarse} at 60 Hz");
}

#[test]
fn wanderings_cover_every_limit_evenly() {
    let keys: Vec<Posture> = (0..wander::COUNT).flat_map(wander::keys).map(|(_, posture)| posture).collect();
    let channels: [fn(&Posture) -> f64; 4] = [|p| p.arms[0][0], |p| p.arms[1][3], |p| p.spine[1], |p| p.feet[1][2]];
    for channel in channels {
        let (least, most) = (channel(&wander::LEAST), channel(&wander::MOST));
        let mut levels: Vec<f64> = keys.iter().map(|key| (channel(key) - least) / (most - least)).collect();
        levels.sort_by(f64::total_cmp);
        for (i, level) in levels.iter().enumerate() {
            assert!((level - (i + 1) as f64 / 37.0).abs() < 1e-9, "level {i} is {level}");
        }
    }
}

#[test]
fn a_mirrored_posture_is_the_mirror_image() {
    let humanoid = Humanoid::new(&stick_figure()).expect("a humanoid");
    let posture = wander::keys(2)[0].1;
    let (pose, mirrored) = (humanoid.pose(&posture), humanoid.pose(&posture.mirrored()));
    for (left, right) in [(7, 10), (13, 16), (4, 4)] {
        let image = pose[left].translation * DVec3::new(-1.0, 1.0, 1.0);
        assert!(
            image.distance(mirrored[right].translation) < 1e-9,
            "joint {left}: {image} {}",
            mirrored[right].translation
        );
    }
}

#[test]
fn a_path_goes_through_its_keys() {
    let keys = wander::keys(3);
    for (time, posture) in &keys {
        assert_eq!(through(&keys, wander::PERIOD, *time), *posture);
    }
}

#[test]
fn a_skeleton_without_arms_is_refused_by_name() {
    let mut figure = stick_figure();
    for joint in 5..=7 {
        figure.joints[joint].name = "lump".into();
        figure.joints[joint].inverse_bind = figure.joints[2].inverse_bind;
    }
    let message = clips(&figure, RATE).expect_err("no left arm").to_string();
    assert!(message.contains("LeftArm"), "{message}");
}

#[test]
fn a_leg_without_length_and_an_absurd_rate_are_refused() {
    let mut figure = stick_figure();
    let knee = figure.joint("rig:LeftLeg").expect("a knee");
    assert!(
        clips(&figure, f64::INFINITY).is_err() && clips(&figure, f64::NAN).is_err() && clips(&figure, 0.0).is_err()
    );
    figure.joints[knee].inverse_bind = figure.joints[knee - 1].inverse_bind;
    let message = clips(&figure, RATE).expect_err("no thigh").to_string();
    assert!(message.contains("LeftUpLeg"), "{message}");
}
