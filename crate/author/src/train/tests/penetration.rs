//! The loss of penetration: its gradient, and poses without truth.

use super::*;
use crate::body::body;
use crate::synthetic;
use crate::train::penetration::{Penetration, Unlabelled, WEIGHT};
use ctsn_core::cpu::skin;
use ctsn_core::model::{Body, Storage};
use glam::Vec3;

/// A trunk of two joints with two limbs of two, and cloth whose truth is inside the body, so that only the loss of penetration says
/// otherwise.
fn scene() -> (HostModel, Setup, Vec<Sample>) {
    let (mut setup, mut samples) = synthetic::dataset(120, 6, 16);
    setup.description.parents = vec![None, Some(0), Some(1), Some(2), Some(1), Some(4)];
    let architecture = Architecture { embedding: 8, basis: 4, layers: 1, heads: 1, features: 4 };
    let mut model = initial(&setup, &samples.iter().collect::<Vec<_>>(), architecture, 1).unwrap();
    model.body = Some(body(&setup, &samples.iter().collect::<Vec<_>>()).unwrap());
    for sample in &mut samples {
        sample.truth = narrow(&model, &Item::posed(&model, &sample.joints).unwrap());
    }
    (model, setup, samples)
}

/// The cloth in a pose, narrower than the body: 0.85 times as wide as at rest, the body 0.9 times.
fn narrow(model: &HostModel, item: &Item) -> Vec<f32> {
    let rest: Vec<f32> = model.rest.as_chunks::<3>().0.iter().flat_map(|[x, y, z]| [0.85 * x, *y, 0.85 * z]).collect();
    let (transforms, mut posed) = (&item.frame.transforms, vec![0.0; rest.len()]);
    skin::skin(Level::new(), &rest, &model.skin.joints, &model.skin.weights, transforms, Space::Body, &mut posed);
    posed
}

#[test]
fn cloth_inside_the_body_is_told_the_way_out() {
    // An octahedron with its edges halved, all on the unit sphere, on one joint that stays where it is.
    let axes = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    let faces: [[usize; 3]; 8] =
        [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    let mut points = axes.to_vec();
    let mut triangles = Vec::new();
    for [a, b, c] in faces {
        let mut middle = |a: usize, b: usize| {
            let point = (points[a] + points[b]).normalize();
            points.iter().position(|other| other.abs_diff_eq(point, 1e-6)).unwrap_or_else(|| {
                points.push(point);
                points.len() - 1
            })
        };
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        triangles.extend([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca].map(|corner| corner as u32));
    }
    let n = points.len();
    let at = |radius: f32| points.iter().flat_map(|point| (radius * point).to_array()).collect::<Vec<f32>>();
    let skin = Skin { joints: vec![0; n], weights: vec![1.0; n], width: 1 };
    let body = Body::new(at(1.0), skin, triangles, (0..n as u32).collect());
    let mut frame = BodyFrame::new(1);
    (0..3).for_each(|axis| frame.transforms[5 * axis] = 1.0);
    let mut penetration = Penetration::new(&body, n);
    penetration.pose(&frame);
    let mut learn = |radius: f32| {
        let mut g = vec![5.0; 3 * n];
        (penetration.loss(&at(radius), 0.5, &mut g), g)
    };
    assert_eq!(learn(1.01), (0.0, vec![5.0; 3 * n]), "outside, nothing is added");
    let ((deep, g), (deeper, _)) = (learn(0.95), learn(0.94));
    assert!((0.03..0.06).contains(&deep) && deeper > deep, "{deep} m, {deeper} m");
    let slope: f32 = g.iter().zip(at(0.94).iter().zip(at(0.95))).map(|(g, (b, a))| (g - 5.0) * (b - a)).sum();
    // Corners are lifted along their own normals: the faces beside them are inclined by up to 30°, and as much further.
    let share = 0.5 * (deeper - deep) * WEIGHT / slope;
    assert!((0.7..1.01).contains(&share), "{slope} against {}", deeper - deep);
}

#[test]
fn poses_without_truth_teach_to_stay_outside_the_body() {
    let (model, setup, samples) = scene();
    // Few of them: many simulated poses teach it by themselves.
    let samples: Vec<&Sample> = samples.iter().take(3).collect();
    let settings = Settings { epochs: 30, batch: 4, ..Settings::default() };
    let train = |unlabelled: bool| {
        let mut trainer = Trainer::new(model.clone(), &setup, &samples, settings).unwrap();
        if !unlabelled {
            trainer.unlabelled = None;
        }
        (0..settings.epochs).for_each(|_| _ = trainer.round(&samples).unwrap());
        trainer.model()
    };
    let poses = Unlabelled::new(&model, &setup, &samples, &settings).unwrap().expect("limbs to mix");
    let unseen = poses.draw(&model, 1_000_000).unwrap();
    let inside = |trained: &HostModel| {
        let (recording, shared, _) = Recording::new(trained, settings.variant, Streams::Both);
        let mut lane = recording.tape.lane(&shared);
        let mut penetration = Penetration::new(model.body.as_ref().unwrap(), model.sizes.vertices);
        let mut loss = |item: &Item| item.learn(&recording, &shared, &mut lane, Some(&mut penetration), 1).penetration;
        unseen.iter().map(&mut loss).sum::<f32>() / unseen.len() as f32
    };
    let [without, with] = [false, true].map(|unlabelled| inside(&train(unlabelled)));
    assert!(without > 2e-3 && with < 0.7 * without, "{without} m without them, {with} m with them");
}

#[test]
fn the_same_poses_are_drawn_after_an_interruption_and_by_any_number_of_threads() {
    let (model, setup, samples) = scene();
    let samples: Vec<&Sample> = samples.iter().collect();
    let settings = Settings { epochs: 4, batch: 3, ..Settings::default() };
    let start = || Trainer::new(model.clone(), &setup, &samples, settings).unwrap();
    let drawn = |step: usize| {
        let items = start().unlabelled.expect("limbs to mix").draw(&model, step).unwrap();
        items.into_iter().map(|item| item.frame.vector).collect::<Vec<_>>()
    };
    assert!(drawn(7) == drawn(7) && drawn(7) != drawn(8));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint");
    let train = |threads: usize, stop: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut trainer = start();
            (0..stop).for_each(|_| _ = trainer.round(&samples).unwrap());
            trainer.save(&path).unwrap();
            let mut resumed = start();
            resumed.resume(&path).unwrap();
            (stop..settings.epochs).for_each(|_| _ = resumed.round(&samples).unwrap());
            resumed.model().to_bytes(Storage::F32)
        })
    };
    let whole = train(1, settings.epochs);
    assert!(whole == train(1, 2), "interrupted");
    assert!(whole == train(3, 1), "by three threads");
}
