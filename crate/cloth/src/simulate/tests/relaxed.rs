//! Relaxation from a start that is near, of the garment itself and of its thinned form.

use glam::DVec3;

use super::pose::{simulator, stride};
use super::scene::{legs, skirt};
use crate::simulate::{Material, Outcome, Settings, Simulator, Status};
use ctsn_rig::{Garment, Pose};

fn mean(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).sum::<f64>() / a.len() as f64
}

/// As a prediction would lie: waves of so many metres on what is true.
fn waved(truth: &[DVec3], height: f64) -> Vec<DVec3> {
    truth.iter().map(|p| *p + height * DVec3::new((40.0 * p.y).sin(), 0.0, (40.0 * p.x).sin())).collect()
}

/// A skirt with so many vertices around and rows, its template, a stride, and where the skirt comes to along the path.
fn striding(around: usize, rows: usize) -> (Simulator, Vec<DVec3>, Pose, Vec<DVec3>) {
    let character = legs();
    let simulator = simulator(&character, skirt(around, rows), around as u32).unwrap();
    let template = simulator.drape().unwrap();
    let pose = stride(&character, 40.0, 20.0, 10.0);
    let rest = simulator.simulate(&template, &pose).positions;
    (simulator, template, pose, rest)
}

#[test]
fn from_a_start_near_it_a_pose_comes_to_the_same_rest() {
    let (simulator, template, pose, rest) = striding(30, 9);
    let start = waved(&rest, 0.01);
    let relaxed = simulator.relax(&template, &pose, &start);
    assert!(relaxed.converged(), "{:?}", relaxed.status);
    let [before, after] = [&start, &relaxed.positions].map(|state| mean(state, &rest));
    assert!(before > 5e-3 && after < 0.5 * before, "{before} m away at first, {after} in the end");
    assert_eq!(relaxed, simulator.relax(&template, &pose, &start), "no state is kept");
    assert_eq!(relaxed, simulator.try_relax(&template, &pose, &start), "at rest soon");
    assert_eq!(simulator.relax_coarse(&template, &pose, &start), None, "this skirt is not fine");
    for bad in [&start[1..], &vec![DVec3::NAN; start.len()][..]] {
        let Status::Rejected { reason } = simulator.relax(&template, &pose, bad).status else { panic!("accepted") };
        assert!(reason.contains("start: wanted") && reason.contains("found"), "{reason}");
    }
}

/// 2,976 vertices, relaxed as 700.
#[test]
fn a_fine_skirt_is_laid_where_its_coarse_one_comes_to_rest() {
    let (simulator, template, pose, fine) = striding(96, 30);
    assert!(simulator.is_fine());
    let start = waved(&fine, 0.03);
    let coarse = simulator.relax_coarse(&template, &pose, &start).expect("a fine skirt");
    assert!(coarse.converged() && coarse.residual < 1e-2, "{:?}", coarse.status);
    let [before, after] = [&start, &coarse.positions].map(|state| mean(state, &fine));
    // Such waves buckle it elsewhere, so it does not come back all the way.
    assert!(before > 0.02 && after < 0.8 * before, "{before} m away at first, {after} in the end");
    let Some(Outcome { status: Status::Rejected { reason }, .. }) =
        simulator.relax_coarse(&template, &pose, &start[1..])
    else {
        panic!("accepted")
    };
    assert!(reason.contains("start: wanted 2976"), "{reason}");
    let hasty = Settings { relax_iterations: 60, ..simulator.settings.clone() };
    let garment = Garment { mesh: skirt(96, 30), ..Garment::default() };
    let hasty = Simulator::new(&legs(), &garment, Material::default(), hasty).unwrap();
    let patient = hasty.relax_coarse(&template, &pose, &start).expect("a fine skirt");
    assert!(patient.converged() && patient.iterations > 60, "{:?} after {}", patient.status, patient.iterations);
    // From the waves themselves the fine one is still moving by millimetres then.
    let relaxed = hasty.relax(&template, &pose, &start);
    assert!(relaxed.converged() && relaxed.iterations < 60, "{:?} after {}", relaxed.status, relaxed.iterations);
    // A tenth of a metre aside, through both legs.
    let aside: Vec<DVec3> = start.iter().map(|p| *p + 0.1 * DVec3::X).collect();
    let outcome = simulator.relax_coarse(&template, &pose, &aside).expect("a fine skirt");
    assert!(outcome.positions.iter().all(|p| p.is_finite()), "finite in every case");
}

/// Waves of 10 cm fold the skirt into itself. Of 48 starts (10 to 16 cm, 60 to 93 in place of 75) this and one other
/// jam, a limb is out of 16, and the others come to rest within 165 iterations.
#[test]
fn layers_that_jam_are_given_up_soon() {
    let (simulator, template, pose, rest) = striding(30, 9);
    let wave = |p: &DVec3| DVec3::new((60.0 * p.y).sin(), (60.0 * p.z).cos(), (75.0 * p.x).sin());
    let jammed: Vec<DVec3> = rest.iter().map(|p| *p + 0.1 * wave(p)).collect();
    let outcome = simulator.relax(&template, &pose, &jammed);
    let Status::Rejected { reason } = outcome.status else { panic!("at rest after {}", outcome.iterations) };
    assert!(reason.contains("held by short steps"), "{reason}");
    let most = simulator.settings.relax_iterations / 4;
    assert!(outcome.iterations < most, "wanted below {most} iterations, found {}", outcome.iterations);
}

/// The skirt with its left half behind the left leg, which comes out through the front.
fn behind_the_leg(rest: &[DVec3]) -> Vec<DVec3> {
    let back = |p: &DVec3| 0.3 * (p.x / 0.05).clamp(0.0, 1.0) * ((0.1 - p.y) / 0.1).clamp(0.0, 1.0);
    rest.iter().map(|p| *p - back(p) * DVec3::Z).collect()
}

#[test]
fn cloth_that_a_leg_has_come_out_of_is_no_start() {
    let (simulator, template, pose, rest) = striding(30, 9);
    assert_eq!(simulator.out(&pose, &rest), None, "along the path both legs stay in it");
    let start = behind_the_leg(&rest);
    let Status::Rejected { reason } = simulator.relax(&template, &pose, &start).status else { panic!("accepted") };
    assert!(reason.contains("every limb in the cloth") && reason.contains("left thigh"), "{reason}");
    assert!(simulator.inside(&pose, &start).out.is_some(), "nor would it be kept");

    // Thinned it is carried along the path instead, from where the fine one can be relaxed.
    let (simulator, template, pose, rest) = striding(96, 30);
    let start = behind_the_leg(&rest);
    assert!(simulator.out(&pose, &start).is_some());
    let coarse = simulator.relax_coarse(&template, &pose, &start).expect("a fine skirt");
    for outcome in [coarse, simulator.relax(&template, &pose, &start), simulator.try_relax(&template, &pose, &start)] {
        assert!(outcome.converged(), "{:?}", outcome.status);
        assert_eq!(simulator.out(&pose, &outcome.positions), None);
        let off = mean(&outcome.positions, &rest);
        assert!(off < 0.02, "{off} m from where the path leads");
    }
}
