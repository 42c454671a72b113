//! Obstacles: skins of their own, stiff, wherever they stand; cloth feels one that comes from afar.

use crate::garment::{Cut, shell};
use crate::simulate::outer_skin::outer_skin;
use crate::simulate::{BodyDistance, Material, Settings, Simulator};
use ctsn_cast::character;
use ctsn_rig::Character;
use glam::{DAffine3, DVec3};

/// The scene of a rail and a sphere, the sphere moved away in the canonical pose.
fn scene(away: DVec3) -> Character {
    let mut scene = character::character("sphere").unwrap();
    scene.joints[1].inverse_bind *= DAffine3::from_translation(-away);
    for (place, weights) in scene.body.mesh.positions.iter_mut().zip(&scene.body.weights) {
        if weights[0].0 == 1 {
            *place += away;
        }
    }
    scene
}

#[test]
fn every_part_has_a_skin_and_an_obstacle_s_is_stiff() {
    let skin = |scene: Character| outer_skin(&scene, &scene.canonical_pose(), 2000).unwrap();
    let [near, far] = [DVec3::ZERO, DVec3::new(0.0, 0.0, -6.0)].map(|away| skin(scene(away)));
    for skin in [&near, &far] {
        assert!(skin.weights.iter().all(|row| row.len() == 1), "a vertex follows two joints");
        let parts = [0, 1].map(|joint| skin.part(|own| own == joint).mesh);
        assert!(parts.iter().all(|part| part.positions.len() >= 200), "{:?}", parts.map(|part| part.positions.len()));
    }
    // What stands far away does not coarsen what is near.
    assert!(near.part(|joint| joint == 0).mesh == far.part(|joint| joint == 0).mesh);
}

/// A part that no name says to be an obstacle has a skin as well.
#[test]
fn a_body_may_be_of_several_parts() {
    let mut scene = scene(DVec3::ZERO);
    scene.joints[1].name = "Chair".into();
    let skin = outer_skin(&scene, &scene.canonical_pose(), 2000).unwrap();
    assert!([0, 1].iter().all(|joint| skin.weights.iter().any(|row| row[0].0 == *joint)));
}

#[test]
fn cloth_feels_an_obstacle_that_comes_from_afar() {
    let scene = scene(DVec3::new(0.0, 0.0, -1.0));
    let sheet = shell(&scene, &Cut { vertices: Some(500), ..Cut::default() }).unwrap();
    let settings = Settings { attached: sheet.pins.clone(), ..Settings::default() };
    let simulator = Simulator::new(&scene, &sheet, Material::default(), settings).unwrap();
    let template = simulator.drape().unwrap();
    let mut pose = scene.canonical_pose();
    pose[1].translation.z += 1.3;
    let outcome = simulator.simulate(&template, &pose);
    assert!(outcome.converged(), "{:?}", outcome.status);
    let body = BodyDistance::new(&scene, &sheet.mesh).unwrap();
    assert!(body.signed(&pose, &outcome.positions).iter().all(|distance| *distance > 0.0));
    let hung = scene.joints[0].inverse_bind.translation;
    let pushed = template.iter().zip(&outcome.positions).map(|(from, to)| to.z - (*from + hung).z).fold(0.0, f64::max);
    assert!(pushed > 0.2, "the sphere pushed the sheet by {pushed} m");
}
