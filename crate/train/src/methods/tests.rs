//! A whole study of a small dataset: every form learns, outcomes are read again, those of another study are refused.

use super::*;
use crate::synthetic;

/// Sixty poses of one clip, whose truth is the garment at rest skinned by its weights, and a swelling that the pose
/// decides.
fn dataset() -> Dataset {
    let (setup, mut samples) = synthetic::dataset(60, 3, 60);
    let dressed = setup.character().expect("a character");
    let rows: Vec<_> = setup.nearest().expect("nearest").into_iter().map(|i| setup.body_weights[i].clone()).collect();
    let mesh = ctsn_rig::Mesh { positions: ctsn_rig::vertices(&setup.template), ..Default::default() };
    let cloth = ctsn_rig::SkinnedMesh { mesh, weights: rows };
    for sample in &mut samples {
        let pose = ctsn_rig::path::to_body_frame(&dressed, &ctsn_rig::pose(&sample.joints));
        let swell = 4.0 * pose[2].translation.x;
        let wider = |p: glam::DVec3| p + glam::DVec3::new(p.x, 0.0, p.z) * swell.clamp(-0.4, 0.4);
        let posed = cloth.pose(&dressed.skinning(&pose)).into_iter().map(wider).collect::<Vec<_>>();
        sample.truth = ctsn_rig::numbers(&posed);
    }
    Dataset::new(setup, samples)
}

#[test]
fn every_form_learns_and_outcomes_are_kept() {
    let (dataset, folder) = (dataset(), tempfile::tempdir().expect("a folder"));
    let settings = Settings { epochs: Some(30), ..Settings::default() };
    let study = Study::new(&dataset, settings, folder.path()).expect("a study");
    let tables = [Table::Comparison, Table::Ablation];
    let all = entries(&tables);
    assert_eq!(all.len(), 5 + 5 - 2, "skinning and the whole network stand in both");
    let outcome = |entry: &Entry| study.outcome(entry, |_| ()).expect("an outcome");
    let outcomes: Vec<Outcome> = all.iter().map(outcome).collect();
    let error = |name: &str| {
        let found = outcomes.iter().find(|outcome| outcome.name == name).expect("an entry");
        found.errors.distance.mean
    };
    for form in ["pbns", "deepsd", "no-mesh", "no-weights", "no-skeleton", "L1-F64-m64-k64"] {
        assert!(error(form) < 0.8 * error("skinning"), "{form}: {} of {}", error(form), error("skinning"));
    }
    let curve = std::fs::read_to_string(folder.path().join("pbns.curve.csv")).expect("a curve");
    assert_eq!(curve.lines().count(), 31);
    for entry in &all {
        let again = study.outcome(entry, |_| panic!("trained again")).expect("an outcome");
        let made = outcomes.iter().find(|outcome| outcome.name == again.name).expect("an outcome");
        // JSON keeps all but the last bit of a number.
        let moved =
            (made.errors.distance.mean - again.errors.distance.mean).abs() + (made.validation - again.validation).abs();
        assert!(moved < 1e-12 && (made.bytes, made.flops) == (again.bytes, again.flops), "{made:?} {again:?}");
    }
    let other = Study::new(&dataset, Settings { epochs: Some(2), ..settings }, folder.path()).expect("a study");
    let message = other.outcome(&all[0], |_| ()).expect_err("another study").to_string();
    assert!(message.contains("another study") && message.contains("epochs: Some(2)"), "{message}");
}

#[test]
fn a_form_with_a_network_of_its_own_goes_on_after_an_interruption() {
    let (dataset, folder) = (dataset(), tempfile::tempdir().expect("a folder"));
    let (setup, slices) = (&dataset.setup, slices(&dataset).expect("slices"));
    let settings = Settings { epochs: Some(7), variant: Method::Deepsd.variant(), ..Settings::default() };
    let start = || {
        let model = Method::Deepsd.initial(setup, &slices.train, 1).expect("a model");
        let (model, network) = deepsd::deepsd(model, setup, 1).expect("a form");
        Trainer::with(model, Some(network), LOSSES, setup, &slices.train, settings).expect("a trainer")
    };
    let file = |name: &str| folder.path().join(name);
    let files = Files { checkpoint: file("checkpoint"), curve: file("curve.csv") };
    let mut whole = start();
    let first = whole.model();
    whole.fit(&slices.validation, &files, |_, _| ()).expect("a training");
    assert!(
        whole.model().skeleton_basis != first.skeleton_basis && whole.model().skinning != first.skinning,
        "nothing was made anew"
    );
    // The checkpoint is that of the fifth epoch.
    let mut resumed = start();
    resumed.resume(&files.checkpoint).expect("a checkpoint");
    assert_eq!(resumed.epoch, 5);
    resumed.fit(&slices.validation, &files, |_, _| ()).expect("a training");
    assert_eq!(whole.model(), resumed.model());
}
