//! Bodies move as bodies do: arms stay outside of them, joints within their limits.

use super::*;

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

/// Whoever strides takes a thigh behind the hips, and none further than its joint allows.
#[test]
fn thighs_come_behind_the_hips() {
    for name in TWO_LEGGED {
        let character = cast(name);
        let bind = character.canonical_pose();
        let joint = |part: &str| character.joint(part).expect("a usual name");
        let hips = joint("Hips");
        // How far behind its canonical direction a thigh is, seen from the pelvis, degrees.
        let behind = |pose: &[DAffine3], side: &str| {
            let [upper, lower] = ["UpLeg", "Leg"].map(|part| joint(&format!("{side}{part}")));
            let direction = |pose: &[DAffine3]| {
                let thigh = pose[lower].translation - pose[upper].translation;
                let thigh = bind[hips].matrix3 * pose[hips].matrix3.inverse() * thigh;
                thigh.z.atan2(-thigh.y)
            };
            (direction(&bind) - direction(pose)).to_degrees()
        };
        let furthest = |clip: &Clip| {
            let angles = clip.poses.iter().flat_map(|pose| ["Left", "Right"].map(|side| behind(pose, side)));
            angles.fold(f64::NEG_INFINITY, f64::max)
        };
        let of = |clip: &str| furthest(character.clips.iter().find(|each| each.name == clip).expect(clip));
        let [walk, idle, lunge, wander] = ["walk", "idle", "lunge", "wander 4"].map(of);
        assert!(walk > idle + 4.0, "{name}: walking, thighs come {walk}° behind, standing {idle}°");
        assert!(lunge > 15.0 && wander > 15.0, "{name}: lunging, a thigh comes {lunge}° behind, wandering {wander}°");
        for clip in &character.clips {
            assert!(furthest(clip) < 30.0, "{name}, {}: a thigh {}° behind", clip.name, furthest(clip));
        }
    }
}
