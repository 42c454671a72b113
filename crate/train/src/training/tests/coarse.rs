//! Poses whose cloth was simulated coarsely teach the skeleton stream and nothing else, and are the same ones whenever
//! they are asked for.

use super::*;
use crate::judging::differences;
use crate::synthetic;

/// A tube, poses to learn from, and others whose cloth hangs 50 mm lower.
fn scene() -> (HostModel, Setup, Vec<Sample>, Vec<Sample>) {
    let (setup, mut samples) = synthetic::dataset(120, 6, 12);
    let mut coarse = samples.split_off(4);
    let lower = |sample: &mut Sample| sample.truth.iter_mut().skip(1).step_by(3).for_each(|y| *y -= 0.05);
    coarse.iter_mut().for_each(lower);
    let architecture = Architecture { embedding: 8, basis: 4, layers: 1, heads: 1, features: 4 };
    let every: Vec<&Sample> = samples.iter().chain(&coarse).collect();
    (initial(&setup, &every, architecture, 1).unwrap(), setup, samples, coarse)
}

#[test]
fn coarse_cloth_teaches_the_skeleton_stream_alone() {
    let (model, setup, samples, coarse) = scene();
    let [samples, coarse]: [Vec<&Sample>; 2] = [samples.iter().collect(), coarse.iter().collect()];
    let settings = Settings { batch: 4, ..Settings::default() };
    let trainer = |taught: bool| {
        let losses = named(&["coarse", "fine", "curvature"]);
        let mut trainer = Trainer::with(model.clone(), None, &losses, &setup, &samples, settings).unwrap();
        if taught {
            trainer.add_coarse(&setup, &coarse).unwrap();
        }
        trainer
    };
    let error = |trained: &HostModel| {
        let (recording, shared, _) = Recording::new(trained, settings.variant, Streams::Skeleton);
        let mut lane = recording.lane(&shared).unwrap();
        let mut one = |sample: &&Sample| {
            let [predicted, truth] = Item::compared(trained, sample, &recording, &shared, &mut lane).unwrap();
            differences(&predicted, &truth, &trained.triangles).0
        };
        coarse.iter().map(&mut one).sum::<f64>() / coarse.len() as f64
    };
    let [without, with] = [false, true].map(|taught| {
        let mut trainer = trainer(taught);
        (0..150).for_each(|_| _ = trainer.epoch(|_, _, _| {}).unwrap());
        error(&trainer.model())
    });
    assert!(without > 0.03 && with < 0.5 * without, "{without} m without them, {with} m with them");
    // One step: the same gradients for all that the mesh stream alone has.
    let [plain, taught] = [false, true].map(|taught| {
        let mut trainer = trainer(taught);
        trainer.epoch(|_, _, _| {}).unwrap();
        trainer.model()
    });
    assert_eq!(plain.mesh_basis, taught.mesh_basis);
    assert_eq!(plain.vertex_mlp, taught.vertex_mlp);
    assert_ne!(plain.skeleton_basis, taught.skeleton_basis);
    let only = Settings { variant: Variant::without(&[Part::Mesh]), ..settings };
    let mut alone = Trainer::new(model.clone(), &setup, &samples, only).unwrap();
    alone.add_coarse(&setup, &coarse).unwrap();
    assert!(alone.coarse.is_none(), "a stream by itself learns the truth");
}

#[test]
fn the_same_coarse_poses_are_drawn_after_an_interruption_and_by_any_number_of_threads() {
    let (model, setup, samples, coarse) = scene();
    let [samples, coarse]: [Vec<&Sample>; 2] = [samples.iter().collect(), coarse.iter().collect()];
    let settings = Settings { epochs: Some(4), batch: 3, ..Settings::default() };
    let start = || {
        let mut trainer = Trainer::new(model.clone(), &setup, &samples, settings).unwrap();
        trainer.add_coarse(&setup, &coarse).unwrap();
        trainer
    };
    let drawn = |step: usize| {
        let trainer = start();
        let poses = trainer.coarse.as_ref().expect("coarse poses").draw(step);
        poses.into_iter().map(|item| item.body_frame.vector.clone()).collect::<Vec<_>>()
    };
    assert!(drawn(7) == drawn(7) && drawn(7) != drawn(8));
    assert_eq!(drawn(1).len(), 4, "eight poses, two steps an epoch");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint");
    assert_same_after_interruption(start, &samples, settings, &path);
    let mut other = Trainer::new(model.clone(), &setup, &samples, settings).unwrap();
    let refused = other.resume(&path).unwrap_err().to_string();
    assert!(refused.contains("another training"), "{refused}");
}
