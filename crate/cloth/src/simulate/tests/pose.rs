//! The whole way on a pelvis with two legs and a skirt: drape, poses, determinism, bad input.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::scene::{legs, skirt};
use crate::simulate::{Material, Settings, Simulator, Status};
use ctsn_rig::path::{body_frame, path, to_body_frame};
use ctsn_rig::{Character, Garment, Mesh, Pose};

pub fn simulator(character: &Character, mesh: Mesh, around: u32) -> crate::Result<Simulator> {
    let settings = Settings { attached: (0..around).collect(), ..Settings::default() };
    Simulator::new(character, &Garment { mesh, ..Garment::default() }, Material::default(), settings)
}

/// Left thigh forward and out, left knee bent, right thigh back; degrees. The hip turned and moved.
pub fn stride(character: &Character, thigh: f64, knee: f64, back: f64) -> Pose {
    let mut pose = character.canonical_pose();
    let place = |pose: &Pose, child: usize, parent: usize, turn: DQuat| {
        let bind = character.joints[parent].inverse_bind * character.joints[child].inverse_bind.inverse();
        pose[parent] * bind * DAffine3::from_quat(turn)
    };
    pose[0] = DAffine3::from_rotation_translation(DQuat::from_rotation_y(0.7), DVec3::new(0.3, 0.9, -2.0));
    let flex = |degrees: f64| DQuat::from_rotation_x(-degrees.to_radians());
    pose[1] = place(&pose, 1, 0, DQuat::from_rotation_z(0.15) * flex(thigh));
    pose[2] = place(&pose, 2, 1, flex(-knee));
    pose[3] = place(&pose, 3, 0, flex(-back));
    pose[4] = place(&pose, 4, 3, flex(-0.5 * knee));
    pose
}

#[test]
fn skirt_follows_the_legs_to_equilibrium() {
    let character = legs();
    let simulator = simulator(&character, skirt(48, 16), 48).unwrap();
    let template = simulator.drape().unwrap();
    for (thigh, knee, back) in [(0.0, 0.0, 0.0), (30.0, 30.0, 15.0), (70.0, 60.0, 10.0)] {
        let pose = stride(&character, thigh, knee, back);
        let start = std::time::Instant::now();
        let outcome = simulator.simulate(&template, &pose);
        eprintln!(
            "stride {thigh}: {:.2} s, {} iterations, residual {:.4}, stretch {:.3}/{:.3}, least {:.2} mm, {:?}",
            start.elapsed().as_secs_f64(),
            outcome.iterations,
            outcome.residual,
            outcome.stretch_p99,
            outcome.stretch_max,
            1e3 * outcome.least_distance,
            outcome.status
        );
        assert!(outcome.converged(), "{:?}", outcome.status);
        assert!(outcome.residual < 1e-2 && outcome.least_distance > 0.0 && outcome.stretch_max < 1.2);
    }
}

/// 2,976 vertices travel as 1,500.
#[test]
fn a_fine_skirt_follows_the_legs_to_equilibrium() {
    let character = legs();
    let simulator = simulator(&character, skirt(96, 30), 96).unwrap();
    let template = simulator.drape().unwrap();
    let pose = stride(&character, 50.0, 40.0, 10.0);
    let simulate = || simulator.simulate(&template, &pose);
    let (first, second) = rayon::join(simulate, simulate);
    assert_eq!(first, second, "bits");
    assert!(first.converged() && first.crossings == 0, "{:?}", first.status);
    assert!(first.residual < 1e-2 && first.least_distance > 0.0 && first.stretch_max < 1.2);
}

#[test]
fn same_pose_gives_the_same_bits_on_any_thread_and_ignores_heading() {
    let character = legs();
    let simulator = simulator(&character, skirt(30, 9), 30).unwrap();
    let template = simulator.drape().unwrap();
    let pose = stride(&character, 40.0, 20.0, 10.0);
    let here = simulator.simulate(&template, &pose);
    let there = std::thread::scope(|scope| {
        let runs: Vec<_> = (0..2).map(|_| scope.spawn(|| simulator.simulate(&template, &pose))).collect();
        runs.into_iter().map(|run| run.join().unwrap()).collect::<Vec<_>>()
    });
    assert!(there.iter().all(|outcome| *outcome == here));
    let move_all = DAffine3::from_translation(DVec3::new(5.0, 1.0, 2.0)) * DAffine3::from_rotation_y(-2.0);
    let moved: Pose = pose.iter().map(|joint| move_all * *joint).collect();
    let same = to_body_frame(&character, &moved);
    let wanted = to_body_frame(&character, &pose);
    assert!(same.iter().zip(&wanted).all(|(a, b)| a.abs_diff_eq(*b, 1e-12)));
}

#[test]
fn path_leads_from_canonical_to_the_pose() {
    let character = legs();
    let pose = stride(&character, 90.0, 40.0, 10.0);
    let poses = path(&character, &pose, 24);
    let canonical = to_body_frame(&character, &character.canonical_pose());
    assert_eq!(poses.len(), 25);
    assert!(poses[0] == canonical && poses[24] == to_body_frame(&character, &pose));
    for pose in &poses {
        let frame = body_frame(&character, pose);
        assert!(frame.abs_diff_eq(DAffine3::IDENTITY, 1e-12));
    }
}

#[test]
fn bad_garments_are_refused_with_the_reason() {
    let character = legs();
    let fails = |mesh: Mesh, wanted: &str| {
        let error = simulator(&character, mesh, 0).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains(wanted), "wanted {wanted:?} in {error:?}");
    };
    let mut far = skirt(12, 4);
    far.positions.iter_mut().for_each(|p| p.x += 9.0);
    fails(far, "found 8.");
    fails(Mesh { triangles: Vec::new(), ..skirt(12, 4) }, "wanted triangles, found none");
    let mut broken = skirt(12, 4);
    broken.positions[7].y = f64::NAN;
    fails(broken, "vertex 7");
    let mut sliver = skirt(12, 4);
    sliver.positions[12] = sliver.positions[0].lerp(sliver.positions[1], 0.5);
    fails(sliver, "degenerate");
    let mut fin = skirt(12, 4);
    let [a, b, _] = fin.triangles[0];
    fin.positions.push(DVec3::new(0.2, 1.2, 0.2));
    fin.triangles.push([a, b, fin.positions.len() as u32 - 1]);
    fin.triangles.push([b, a, 30]);
    fails(fin, "wanted at most two triangles");
    let mut wild = skirt(12, 4);
    wild.triangles[3][1] = 4000;
    fails(wild, "found 4000");
}

#[test]
fn bad_poses_are_rejected_not_propagated() {
    let character = legs();
    let simulator = simulator(&character, skirt(16, 5), 16).unwrap();
    let template = simulator.drape().unwrap();
    let good = character.canonical_pose();
    let mut broken = good.clone();
    broken[2].translation.x = f64::NAN;
    let mut flat = good.clone();
    flat[1].matrix3 = DMat3::ZERO;
    for pose in [broken, flat, good[1..].to_vec()] {
        let outcome = simulator.simulate(&template, &pose);
        assert!(matches!(outcome.status, Status::Rejected { .. }));
        assert!(outcome.positions.iter().all(|p| p.is_finite()));
    }
    assert!(matches!(simulator.simulate(&template[1..], &good).status, Status::Rejected { .. }));
}
