//! Motion must be finite, closed, smooth, on the floor and within reach of the joints.

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

/// Cloth caught between forearm and trunk has no unique rest state.
#[test]
fn forearms_and_hands_keep_clear_of_the_body() {
    for name in TWO_LEGGED {
        let character = cast(name);
        let strongest = |v: u32| character.joints[character.body.weights[v as usize][0].0].name.as_str();
        let is_arm = |v: &u32| ["ForeArm", "Hand"].iter().any(|part| strongest(*v).contains(part));
        let vertices = || 0..character.body.mesh.positions.len() as u32;
        let arm: Vec<u32> = vertices().filter(is_arm).step_by(6).collect();
        let near_arm = |v: u32| strongest(v).contains("Arm") || strongest(v).contains("Hand");
        let body: Vec<u32> = vertices().filter(|&v| !near_arm(v) && !strongest(v).contains("Shoulder")).collect();
        let solid: Vec<[u32; 3]> =
            character.body.mesh.triangles.iter().copied().filter(|t| !t.iter().any(|&v| near_arm(v))).collect();
        let height = character.body.mesh.positions.iter().map(|p| p.y).fold(0.0, f64::max);
        for clip in &character.clips {
            for (frame, pose) in clip.poses.iter().enumerate().step_by(25) {
                let posed = character.pose_body(pose);
                let at = |v: u32| posed[v as usize];
                let square = |v: u32| body.iter().map(|&b| at(b).distance_squared(at(v))).fold(f64::MAX, f64::min);
                let clear = arm.iter().map(|&v| square(v)).fold(f64::MAX, f64::min).sqrt();
                assert!(clear > 0.002 * height, "{name}, {} frame {frame}: {clear} m between arm and body", clip.name);
                for &v in arm.iter().step_by(24) {
                    let inside = winding(at(v), &posed, &solid);
                    assert!(inside < 0.5, "{name}, {} frame {frame}: vertex {v} is in the body", clip.name);
                }
            }
        }
    }
}

/// Winding number of a surface about a point: 1 inside, 0 outside. Van Oosterom & Strackee 1983.
fn winding(point: DVec3, positions: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let angle = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| positions[v as usize] - point);
        let (x, y, z) = (a.length(), b.length(), c.length());
        2.0 * a.dot(b.cross(c)).atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
    };
    triangles.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

#[test]
fn joints_stay_within_their_limits() {
    for name in TWO_LEGGED {
        let character = cast(name);
        let at = |joint: &str| character.joint(joint).expect("a usual name");
        let bend = |pose: &[DAffine3], [a, b, c]: [&str; 3]| {
            let [a, b, c] = [a, b, c].map(|joint| pose[at(joint)].translation);
            (b - a).angle_between(c - b).to_degrees()
        };
        let bind = character.canonical_pose();
        let turn = |pose: &[DAffine3], joint: usize, parent: usize| {
            let relative =
                |pose: &[DAffine3]| DQuat::from_mat3(&(pose[parent].matrix3.transpose() * pose[joint].matrix3));
            relative(pose).angle_between(relative(&bind)).to_degrees()
        };
        for clip in &character.clips {
            for pose in clip.poses.iter().step_by(3) {
                for side in ["Left", "Right"] {
                    let [arm, fore, hand] = ["Arm", "ForeArm", "Hand"].map(|part| format!("{side}{part}"));
                    let [thigh, shank, foot] = ["UpLeg", "Leg", "Foot"].map(|part| format!("{side}{part}"));
                    let (elbow, knee) = (bend(pose, [&arm, &fore, &hand]), bend(pose, [&thigh, &shank, &foot]));
                    assert!(elbow < 125.0, "{name}, {}: elbow at {elbow}°", clip.name);
                    assert!(knee < 150.0, "{name}, {}: knee at {knee}°", clip.name);
                }
                for part in ["Spine", "Spine1", "Spine2", "Neck", "Head"] {
                    let (joint, parent) = (at(part), character.joints[at(part)].parent.expect("not the root"));
                    let angle = turn(pose, joint, parent);
                    assert!(angle < 35.0, "{name}, {}: {part} turned by {angle}°", clip.name);
                }
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
