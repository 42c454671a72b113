//! Motion must be finite, closed, smooth, on the floor and within reach of the joints.

use super::*;
use crate::motion::{RATE, clips};
use crate::rig::{Joint, Mesh, Surface};
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
        body: Mesh::default(),
        weights: vec![],
        surface: Surface::default(),
        clips: vec![],
        metres_per_unit: 1.0,
    }
}

fn each_step(clip: &Clip, mut check: impl FnMut(usize, DVec3, DVec3)) {
    for frame in clip.poses.windows(2) {
        (0..frame[0].len()).for_each(|joint| check(joint, frame[0][joint].translation, frame[1][joint].translation));
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
                assert!(
                    (length(pose) - length(&bind)).abs() < 1e-9,
                    "{}: bone of {} changes length",
                    clip.name,
                    joint.name
                );
            }
        }
    }
}

#[test]
fn feet_stay_on_the_floor_and_the_root_near_its_place() {
    let character = crate::character::character("mannequin").expect("the mannequin");
    for clip in &character.clips {
        for pose in clip.poses.iter().step_by(5) {
            let low = character.pose_body(pose).iter().map(|p| p.y).fold(f64::MAX, f64::min);
            assert!((-0.015..0.05).contains(&low), "{}: lowest point at {low} m", clip.name);
            assert!(pose[character.root].translation.with_y(0.0).length() < 0.5, "{} wanders off", clip.name);
        }
    }
}

/// Cloth caught between forearm and trunk has no unique rest state.
#[test]
fn forearms_keep_clear_of_the_trunk() {
    let character = crate::character::character("mannequin").expect("the mannequin");
    let follows = |v: usize, parts: &[&str]| {
        parts.iter().any(|part| character.joints[character.weights[v][0].0].name.contains(part))
    };
    let vertices = || 0..character.body.positions.len();
    let arm: Vec<usize> = vertices().filter(|&v| follows(v, &["ForeArm", "Hand"])).step_by(4).collect();
    let trunk: Vec<usize> = vertices().filter(|&v| !follows(v, &["Arm", "Hand", "Shoulder"])).step_by(2).collect();
    for clip in &character.clips {
        for (frame, pose) in clip.poses.iter().enumerate().step_by(12) {
            let body = character.pose_body(pose);
            let nearest =
                |&v: &usize| trunk.iter().map(|&t| body[t].distance_squared(body[v])).fold(f64::MAX, f64::min);
            let clear = arm.iter().map(nearest).fold(f64::MAX, f64::min).sqrt();
            assert!(clear > 0.05, "{} frame {frame}: {clear} m between forearm and trunk", clip.name);
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
    figure.joints[5].name = "tentacle".into();
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
    assert!(message.contains("Left leg"), "{message}");
}
