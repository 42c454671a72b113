//! Motion of animals and props must be finite, closed, smooth, rigid per joint, long enough, and on the floor.

use super::*;
use crate::character::tests::cast;
use glam::{DAffine3, DVec3};

const NAMES: [&str; 5] = ["cat", "fox", "dolphin", "sphere", "box"];

/// Animals and props with their names.
fn animals() -> impl Iterator<Item = (&'static str, &'static Character)> {
    NAMES.into_iter().map(|name| (name, cast(name)))
}

#[test]
fn animals_have_clips_enough_and_names_of_their_own() {
    for (name, character) in animals() {
        let clips = &character.clips;
        let seconds: f64 = clips.iter().map(|clip| (clip.poses.len() - 1) as f64 / clip.rate).sum();
        assert!(clips.len() >= 20 && seconds > 200.0, "{name}: {} clips of {seconds} s", clips.len());
        let names: std::collections::BTreeSet<&str> = clips.iter().map(|clip| clip.name.as_str()).collect();
        assert_eq!(names.len(), clips.len(), "{name}: two clips share a name");
    }
}

#[test]
fn clips_are_finite_closed_and_slow_enough() {
    for (name, character) in animals() {
        for clip in &character.clips {
            assert!(clip.poses.iter().flatten().all(DAffine3::is_finite), "{name} {}", clip.name);
            let (first, last) = (&clip.poses[0], &clip.poses[clip.poses.len() - 1]);
            assert!(first.iter().zip(last).all(|(a, b)| a.abs_diff_eq(*b, 1e-9)), "{name} {} is not closed", clip.name);
            for pair in clip.poses.windows(2) {
                let step = pair[0].iter().zip(&pair[1]).map(|(a, b)| a.translation.distance(b.translation));
                let speed = step.fold(0.0, f64::max) * clip.rate;
                assert!(speed < 6.0, "{name} {}: a joint moves at {speed} m/s", clip.name);
            }
        }
    }
}

#[test]
fn speed_is_continuous() {
    // At four times the rate a jump in velocity stays a jump, while a smooth change shrinks to a quarter.
    let mut jumps = Vec::new();
    for (name, character) in animals() {
        let [coarse, fine] = [60.0, 240.0].map(|rate| clips(character, rate).expect("motion"));
        for (coarse, fine) in coarse.iter().zip(&fine) {
            let [before, after] = [coarse, fine].map(greatest_jump);
            if after > 0.45 * before + 0.01 {
                jumps.push(format!("{name} {}: {after:.3} m/s, {before:.3} at 60 Hz", fine.name));
            }
        }
    }
    assert!(jumps.is_empty(), "velocity jumps: {jumps:#?}");
}

/// The greatest change of a joint's velocity from one frame to the next, m/s.
fn greatest_jump(clip: &Clip) -> f64 {
    let n = clip.poses.len() - 1;
    let place = |frame: usize, joint: usize| clip.poses[frame % n][joint].translation;
    let change = |frame: usize, joint: usize| {
        (place(frame + 2, joint) - 2.0 * place(frame + 1, joint) + place(frame, joint)).length() * clip.rate
    };
    (0..n).flat_map(|frame| (0..clip.poses[0].len()).map(move |joint| change(frame, joint))).fold(0.0, f64::max)
}

#[test]
fn bones_keep_their_lengths_and_joints_stay_rigid() {
    for (name, character) in animals() {
        let bind = character.canonical_pose();
        for clip in &character.clips {
            for pose in clip.poses.iter().step_by(4) {
                for (j, joint) in character.joints.iter().enumerate() {
                    let what = || format!("{name} {} {}", clip.name, joint.name);
                    assert!((pose[j].matrix3.determinant() - 1.0).abs() < 1e-9, "{} is not rigid", what());
                    // An obstacle is not tied to its parent.
                    let Some(parent) = joint.parent.filter(|_| !character.is_obstacle(j)) else { continue };
                    let length = |pose: &[DAffine3]| pose[j].translation.distance(pose[parent].translation);
                    assert!((length(pose) - length(&bind)).abs() < 1e-9, "{} changes length", what());
                }
            }
        }
    }
}

#[test]
fn paws_stay_on_the_floor_and_nothing_goes_below() {
    // Both are measured in leg lengths: a cat's is 0.22 m, a fox's 0.32 m.
    let airborne =
        ["trot", "canter", "gallop", "prance", "pounce", "jump", "trot left", "trot right", "turn on the spot"];
    for (name, character) in animals().filter(|(name, _)| ["cat", "fox"].contains(name)) {
        let hip = character.joint("LeftBackUpLeg").map_or(0.0, |j| character.canonical_pose()[j].translation.y);
        for clip in &character.clips {
            for (frame, pose) in clip.poses.iter().enumerate().step_by(5) {
                let low = character.pose_body(pose).iter().map(|p| p.y).fold(f64::MAX, f64::min) / hip;
                assert!(low > -0.05, "{name} {} frame {frame}: {low} leg lengths below the floor", clip.name);
                assert!(low < 0.02 || airborne.contains(&clip.name.as_str()), "{name} {}: floats at {low}", clip.name);
                let root = pose[character.root].translation;
                assert!(root.with_y(0.0).length() < 1.5 * hip, "{name} {} wanders off", clip.name);
            }
        }
    }
}

/// The angle between a joint and its parent stays below what its kind allows.
#[test]
fn joints_stay_within_their_limits() {
    let mut beyond = std::collections::BTreeSet::new();
    for (name, character) in animals() {
        let bind = character.canonical_pose();
        for clip in &character.clips {
            for pose in clip.poses.iter().step_by(3) {
                for (j, joint) in character.joints.iter().enumerate() {
                    let Some(parent) = joint.parent else { continue };
                    let turn = |i: usize| pose[i].matrix3 * bind[i].matrix3.inverse();
                    let between = turn(parent).inverse() * turn(j);
                    let angle = glam::DQuat::from_mat3(&between).normalize().to_axis_angle().1.to_degrees();
                    let angle = angle.min(360.0 - angle);
                    let most = if joint.name.contains("Spine") {
                        40.0
                    } else if joint.name.contains("Tail") || joint.name.contains("Fin") {
                        90.0
                    } else if joint.name.contains("Neck") || joint.name == "Head" {
                        95.0
                    } else {
                        150.0
                    };
                    if angle >= most {
                        beyond.insert(format!("{name} {}: {} by {angle:.0}°", clip.name, joint.name));
                    }
                }
            }
        }
    }
    assert!(beyond.is_empty(), "turned too far: {beyond:#?}");
}

#[test]
fn the_canonical_stance_is_the_canonical_pose() {
    for (name, character) in animals().filter(|(name, _)| ["cat", "fox"].contains(name)) {
        let animal = quadruped::Quadruped::new(character).expect("four legs");
        let pose = animal.pose(&quadruped::Stance::default());
        for (joint, (a, b)) in character.joints.iter().zip(pose.iter().zip(character.canonical_pose())) {
            assert!(a.abs_diff_eq(b, 2e-3), "{name}: {} at {} instead of {}", joint.name, a.translation, b.translation);
        }
    }
}

#[test]
fn a_mirrored_stance_is_the_mirror_image() {
    let cat = cast("cat");
    let animal = quadruped::Quadruped::new(cat).expect("four legs");
    let stance = quadruped::Stance {
        heading: 20.0,
        hips: [0.05, -0.1, 0.02],
        trunk: [5.0, 4.0, 3.0],
        spine: [8.0, 14.0, 5.0],
        neck: [-9.0, 20.0, 6.0],
        head: [4.0, 30.0, 8.0],
        tail: [10.0, 12.0, 14.0, 16.0],
        ears: 9.0,
        paws: [[0.02, 0.0, 0.1, 5.0], [0.0, 0.2, 0.0, 30.0], [0.01, 0.0, -0.05, 0.0], [0.03, 0.1, 0.2, 20.0]],
    };
    let (pose, mirrored) = (animal.pose(&stance), animal.pose(&stance.mirrored()));
    for (j, joint) in cat.joints.iter().enumerate() {
        let swapped = if joint.name.contains("Left") {
            joint.name.replace("Left", "Right")
        } else {
            joint.name.replace("Right", "Left")
        };
        let other = cat.joint(&swapped).expect("its mirror image");
        let image = pose[j].translation * DVec3::new(-1.0, 1.0, 1.0);
        assert!(image.distance(mirrored[other].translation) < 1e-9, "{}", joint.name);
    }
}

#[test]
fn a_body_of_no_kind_is_told_what_each_kind_lacks() {
    let mut odd = cast("cat").clone();
    let hips = odd.joints[0].inverse_bind;
    for joint in odd.joints.iter_mut().filter(|joint| joint.name.starts_with("LeftBack")) {
        joint.name = "Lump".into();
        joint.inverse_bind = hips;
    }
    let message = clips(&odd, RATE).expect_err("no left hind leg").to_string();
    for lacking in ["LeftArm", "LeftBackUpLeg", "Fluke", "a root and one obstacle"] {
        assert!(message.contains(lacking), "{message}");
    }
}

#[test]
fn a_leg_without_length_is_refused() {
    let mut odd = cast("cat").clone();
    let (hip, knee) = (odd.joint("LeftBackUpLeg").expect("a hip"), odd.joint("LeftBackLeg").expect("a knee"));
    odd.joints[knee].inverse_bind = odd.joints[hip].inverse_bind;
    let message = clips(&odd, RATE).expect_err("no thigh").to_string();
    assert!(message.contains("LeftBackUpLeg"), "{message}");
}

/// The sheet hangs before the rail, at z = 0.02 m.
#[test]
fn obstacles_enter_the_cloth_and_leave_it() {
    for name in ["sphere", "box"] {
        let character = cast(name);
        let bind = character.canonical_pose();
        let obstacle = character.body.part(|joint| character.is_obstacle(joint));
        let poses = || character.clips.iter().flat_map(|clip| clip.poses.iter().step_by(30));
        assert!(poses().all(|pose| pose[0] == bind[0]), "{name}: the root moves");
        let front = |pose: &Pose| obstacle.pose(&character.skinning(pose)).iter().map(|p| p.z).fold(f64::MIN, f64::max);
        let fronts: Vec<f64> = poses().map(front).collect();
        let share = |wanted: &dyn Fn(f64) -> bool| {
            fronts.iter().filter(|front| wanted(**front)).count() as f64 / fronts.len() as f64
        };
        assert!(share(&|front| front > 0.15) > 0.3, "{name} stays behind the cloth");
        assert!(share(&|front| front < 0.02) > 0.05, "{name} never leaves the cloth");
        let turned = poses().filter(|pose| !pose[1].matrix3.abs_diff_eq(bind[1].matrix3, 0.1)).count();
        assert_eq!(turned > 0, name == "box", "{name} turns in {turned} poses");
    }
}
