//! A model repairs its cloth against an obstacle as against the body: alone behind a sheet, and held in a hand.

use ctsn_cast::character::character;
use ctsn_cloth::garment::{Cut, Kind, shell};
use ctsn_cloth::simulate::BodyDistance;
use ctsn_core::cpu::Level;
use ctsn_core::model::{HostModel, Skinning};
use ctsn_core::{Predictor, Streams};
use ctsn_rig::path::body_frame;
use ctsn_rig::{Character, Garment, Joint, Pose, joints, numbers, row_major, vertices};
use ctsn_train::body::body;
use ctsn_train::dataset::{Description, Record, Sample, Setup};
use ctsn_train::training::{Architecture, initial};
use glam::{DAffine3, DVec3};

/// What a dataset of the character in this garment says of them.
fn setup(character: &Character, garment: &Garment) -> Setup {
    let description = Description {
        joints: character.joints.iter().map(|joint| joint.name.clone()).collect(),
        root: character.root,
        inverse_bind: character.joints.iter().map(|joint| row_major(&joint.inverse_bind).to_vec()).collect(),
        clips: vec!["made here".to_owned()],
        rate: 1.0,
        ..Description::default()
    };
    let cloth = numbers(&garment.mesh.positions);
    Setup {
        description,
        garment: cloth.clone(),
        template: cloth,
        triangles: garment.mesh.triangles.as_flattened().to_vec(),
        surface: Default::default(),
        drawn: None,
        body: numbers(&character.body.mesh.positions),
        body_triangles: character.body.mesh.triangles.as_flattened().to_vec(),
        body_weights: character.body.weights.clone(),
    }
}

/// The pose with the cloth where it is in the canonical pose.
fn sample(character: &Character, garment: &Garment, pose: &Pose) -> Sample {
    let frame = body_frame(character, &character.canonical_pose());
    let truth: Vec<DVec3> = garment.mesh.positions.iter().map(|p| frame.transform_point3(*p)).collect();
    Sample { record: Record::default(), joints: joints(pose), truth: numbers(&truth) }
}

/// An untrained model whose cloth follows the root alone, with the body for its repair.
fn model(character: &Character, garment: &Garment, poses: &[Pose]) -> HostModel {
    let setup = setup(character, garment);
    let samples: Vec<Sample> = poses.iter().map(|pose| sample(character, garment, pose)).collect();
    let samples: Vec<&Sample> = samples.iter().collect();
    let small = Architecture { embedding: 2, basis: 2, layers: 1, heads: 1, features: 4 };
    let mut model = initial(&setup, &samples, small, 1).expect("a model");
    let n = model.sizes.vertices;
    model.skinning = Skinning { joints: vec![character.root as u32; n], weights: vec![1.0; n], width: 1 };
    model.skeleton_basis.fill(0.0);
    model.mesh_basis.fill(0.0);
    model.body = Some(body(&setup, &samples, &samples).expect("a body"));
    model
}

/// Vertices predicted inside the obstacle and the greatest depth, metres: without and with repair.
fn inside(character: &Character, garment: &Garment, model: &HostModel, pose: &Pose) -> [(usize, f64); 2] {
    let body = character.body.part(|joint| character.is_obstacle(joint));
    let obstacle = Character { body, ..character.clone() };
    let distance = BodyDistance::new(&obstacle, &garment.mesh).expect("a body");
    let into = body_frame(character, pose);
    [HostModel { body: None, ..model.clone() }, model.clone()].map(|model| {
        let mut predictor = Predictor::from_model(model, Level::new());
        predictor.predict_row_major(&joints(pose), Streams::Both).expect("a prediction");
        let cloth: Vec<DVec3> = vertices(predictor.positions()).into_iter().map(|p| into.transform_point3(p)).collect();
        let depths = distance.signed(pose, &cloth).into_iter().filter(|distance| *distance < 0.0);
        depths.fold((0, 0.0), |(count, depth): (usize, f64), distance| (count + 1, depth.max(-distance)))
    })
}

#[test]
fn a_sheet_is_moved_out_of_the_obstacle_behind_it() {
    for (name, forward) in [("sphere", 0.09), ("box", 0.14)] {
        let scene = character(name).expect("a scene");
        let sheet = shell(&scene, &Cut { vertices: Some(500), ..Cut::default() }).expect("a sheet");
        let placed = |sideways: f64, up: f64, turn: f64| {
            let mut pose = scene.canonical_pose();
            pose[1].translation += DVec3::new(sideways, up, forward);
            pose[1].matrix3 *= glam::DMat3::from_rotation_y(turn);
            pose
        };
        let poses: Vec<Pose> =
            (0..9).map(|i| placed(0.1 * f64::from(i % 3 - 1), 0.1 * f64::from(i / 3 - 1), 0.0)).collect();
        let model = model(&scene, &sheet, &poses);
        for pose in [placed(0.07, 0.03, 0.0), placed(-0.09, 0.06, 0.1), placed(0.02, -0.08, -0.1)] {
            let [before, after] = inside(&scene, &sheet, &model, &pose);
            assert!(before.0 > 10 && before.1 > 0.01, "{name}: only {before:?} inside before the repair");
            assert!(after.0 == 0, "{name}: {after:?} of {before:?} still inside");
        }
    }
}

/// Andy, in a T-shirt, presses a round shield to his chest.
#[test]
fn a_shirt_is_moved_out_of_what_a_hand_holds() {
    let mut andy = character("andy").expect("andy");
    let shirt =
        shell(&andy, &Cut { kind: Some(Kind::Tshirt), vertices: Some(600), ..Cut::default() }).expect("a shirt");
    let hand = andy.joint("LeftHand").expect("a hand");
    let place = andy.canonical_pose()[hand].translation;
    let shield = andy.joints.len();
    let inverse_bind = DAffine3::from_translation(-place);
    andy.joints.push(Joint { name: "Obstacle shield".to_owned(), parent: Some(hand), inverse_bind });
    let mut ball = character("sphere").expect("a scene").body.part(|joint| joint == 1);
    let positions = &mut ball.mesh.positions;
    let middle = positions.iter().sum::<DVec3>() / positions.len() as f64;
    positions.iter_mut().for_each(|p| *p = place + (*p - middle) * DVec3::new(0.8, 0.8, 0.2));
    ball.weights.fill(vec![(shield, 1.0)]);
    andy.body.extend(ball);

    let chest = shirt.mesh.positions.iter().copied().max_by(|a, b| a.z.total_cmp(&b.z)).expect("a chest");
    let held = |sideways: f64, depth: f64| {
        let mut pose = andy.canonical_pose();
        pose[shield].translation = chest + DVec3::new(sideways, 0.0, 0.2 * 0.22 - depth);
        pose
    };
    let poses: Vec<Pose> = (0..6).map(|i| held(0.02 * f64::from(i) - 0.05, 0.0)).collect();
    let model = model(&andy, &shirt, &poses);
    let carried = model.body.as_ref().expect("a body");
    let of_shield = |row: &[u32]| row.iter().all(|joint| *joint == shield as u32 || *joint == 0);
    assert!(carried.skinning.joints.chunks(carried.skinning.width).any(of_shield), "the model's body has no shield");
    let [before, after] = inside(&andy, &shirt, &model, &held(0.01, 0.008));
    assert!(before.0 > 3 && before.1 > 0.004, "only {before:?} inside before the repair");
    assert!(after.1 < 1e-3, "{after:?} of {before:?} still inside the shield");
}
