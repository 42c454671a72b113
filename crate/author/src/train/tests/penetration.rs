//! The loss of penetration: its gradient, and poses without truth.

use super::*;
use crate::body::body;
use crate::synthetic;
use crate::train::penetration::{Penetration, Unlabelled, WEIGHT};
use ctsn_core::cpu::skin;
use ctsn_core::model::{Body, Fans, Storage};
use glam::Vec3;

/// A trunk of two joints with two limbs of two, and cloth that the truth has `radius` times as wide as at rest; the body is 0.9 times as wide.
fn scene(radius: f32) -> (HostModel, Setup, Vec<Sample>) {
    let (mut setup, mut samples) = synthetic::dataset(120, 6, 16);
    setup.description.parents = vec![None, Some(0), Some(1), Some(2), Some(1), Some(4)];
    let architecture = Architecture { embedding: 8, basis: 4, layers: 1, heads: 1, features: 4 };
    let mut model = initial(&setup, &samples.iter().collect::<Vec<_>>(), architecture, 1).unwrap();
    model.body = Some(body(&setup, &samples.iter().collect::<Vec<_>>()).unwrap());
    for sample in &mut samples {
        sample.truth = tube(&model, &Item::posed(&model, &sample.joints).unwrap(), radius);
    }
    (model, setup, samples)
}

/// The cloth `radius` times as wide as at rest, in a pose.
fn tube(model: &HostModel, item: &Item, radius: f32) -> Vec<f32> {
    let rest: Vec<f32> =
        model.rest.as_chunks::<3>().0.iter().flat_map(|[x, y, z]| [radius * x, *y, radius * z]).collect();
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
    let body = Body {
        vertices: n,
        rest: at(1.0),
        skin: Skin { joints: vec![0; n], weights: vec![1.0; n], width: 1 },
        fans: Fans::new(n, &triangles),
        triangles,
        seeds: (0..n as u32).collect(),
    };
    let mut frame = BodyFrame::new(1);
    (0..3).for_each(|axis| frame.transforms[5 * axis] = 1.0);
    let mut penetration = Penetration::new(&body, n);
    penetration.pose(&frame);
    let mut learn = |radius: f32| {
        let mut g = vec![0.0; 3 * n];
        (penetration.learn(&at(radius), 1.0, &mut g), g)
    };
    assert_eq!(learn(1.01), (0.0, vec![0.0; 3 * n]));
    let ((deep, g), (deeper, _)) = (learn(0.95), learn(0.94));
    assert!((0.03..0.06).contains(&deep) && deeper > deep, "{deep} m, {deeper} m");
    let slope: f32 = g.iter().zip(at(0.94).iter().zip(at(0.95))).map(|(g, (b, a))| g * (b - a)).sum();
    // Corners are lifted along their own normals: the faces beside them are inclined by up to 30°, and as much further.
    let share = (deeper - deep) * WEIGHT / slope;
    assert!((0.7..1.01).contains(&share), "{slope} against {}", deeper - deep);
}

#[test]
fn poses_without_truth_teach_to_stay_outside_and_are_drawn_again_after_an_interruption() {
    // The truth is inside the body, so that only this loss says otherwise.
    let (model, setup, samples) = scene(0.85);
    let samples: Vec<&Sample> = samples.iter().collect();
    let settings = Settings { epochs: 20, batch: 4, ..Settings::default() };
    let train = |body: bool, stop: bool| {
        let model = HostModel { body: model.body.clone().filter(|_| body), ..model.clone() };
        let start = || Trainer::new(model.clone(), &setup, &samples, settings).unwrap();
        let mut trainer = start();
        while trainer.epoch < settings.epochs {
            if stop && trainer.epoch == 10 {
                let folder = tempfile::tempdir().unwrap();
                let path = folder.path().join("checkpoint");
                trainer.round(&samples).unwrap();
                trainer.save(&path).unwrap();
                trainer = start();
                trainer.resume(&path).unwrap();
                continue;
            }
            trainer.round(&samples).unwrap();
        }
        trainer.model()
    };
    let unlabelled = Unlabelled::new(&model, &setup, &samples, &settings).unwrap().expect("limbs to mix");
    let unseen = unlabelled.draw(&model, 1_000_000, 8).unwrap();
    let poses = |items: &[Item]| items.iter().map(|item| item.frame.vector.clone()).collect::<Vec<_>>();
    assert_eq!(poses(&unseen), poses(&unlabelled.draw(&model, 1_000_000, 8).unwrap()));
    assert_ne!(poses(&unseen), poses(&unlabelled.draw(&model, 1_000_001, 8).unwrap()));
    let inside = |trained: &HostModel| {
        let (recording, shared, _) = Recording::new(trained, settings.variant, Streams::Both);
        let mut lane = recording.tape.lane(&shared);
        let mut penetration = Penetration::new(model.body.as_ref().unwrap(), model.sizes.vertices);
        let mut loss = |item: &Item| item.learn(&recording, &shared, &mut lane, Some(&mut penetration), 1).penetration;
        unseen.iter().map(&mut loss).sum::<f32>() / unseen.len() as f32
    };
    let with = train(true, false);
    let [without, with_it] = [inside(&train(false, false)), inside(&with)];
    assert!(without > 5e-3 && with_it < 0.5 * without, "{without} m, {with_it} m inside");
    assert_eq!(with.to_bytes(Storage::F32), train(true, true).to_bytes(Storage::F32));
}
