//! Poses no body should take: kept only if the cloth is as sound as in any other, and never worse than left out.

use glam::{DAffine3, DQuat, DVec3};

use super::pose::{simulator, stride};
use super::scene::{legs, skirt};
use crate::simulate::{BodyDistance, Status};
use ctsn_rig::Pose;

#[test]
fn wild_poses_are_sound_or_left_out() {
    let character = legs();
    let cloth = skirt(30, 9);
    let body = BodyDistance::new(&character, &cloth).unwrap();
    let simulator = simulator(&character, cloth, 30).unwrap();
    let template = simulator.drape().unwrap();
    let turned = |joint: usize, turn: DQuat| {
        let mut pose = character.canonical_pose();
        (joint..joint + 2).for_each(|j| {
            let about = DAffine3::from_translation(character.canonical_pose()[joint].translation);
            pose[j] = about * DAffine3::from_quat(turn) * about.inverse() * pose[j];
        });
        pose
    };
    let scaled: Pose =
        character.canonical_pose().iter().map(|j| DAffine3::from_scale(DVec3::splat(0.01)) * *j).collect();
    let wild = [
        ("thigh through thigh", turned(1, DQuat::from_rotation_z(-0.9))),
        ("thigh turned round", turned(1, DQuat::from_rotation_y(std::f64::consts::PI))),
        ("thigh bent back to front", turned(1, DQuat::from_rotation_x(std::f64::consts::PI))),
        ("split", stride(&character, 170.0, 150.0, 120.0)),
        ("a hundredth of its size", scaled),
    ];
    let mut left_out = 0;
    for (name, pose) in wild {
        let outcome = simulator.simulate(&template, &pose);
        assert!(outcome.positions.iter().all(|p| p.is_finite()), "{name}");
        eprintln!("{name}: {:?}, residual {:.3}, stretch {:.2}", outcome.status, outcome.residual, outcome.stretch_max);
        match &outcome.status {
            Status::Rejected { reason } => {
                assert!(reason.contains("wanted") && reason.contains("found"), "{name}: {reason}");
                left_out += 1;
            }
            Status::Converged => {
                let least = body.signed(&pose, &outcome.positions).into_iter().fold(f64::INFINITY, f64::min);
                assert!(least >= 0.0, "{name}: {:.2} mm inside", -1e3 * least);
                assert!(outcome.crossings == 0 && outcome.stretch_max < 1.5, "{name}");
            }
        }
    }
    // A skirt cannot follow a thigh that passes through the other one.
    assert!(left_out > 0);
}
