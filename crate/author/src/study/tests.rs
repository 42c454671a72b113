//! A whole study of a small dataset: every form learns, outcomes are read again, and another study's are refused.

use super::*;
use crate::synthetic;

/// Sixty poses of one clip, whose truth is the garment at rest skinned by its weights, and a swelling that the pose decides.
fn dataset() -> Dataset {
    let (setup, mut samples) = synthetic::dataset(60, 3, 60);
    let dressed = setup.character().expect("a character");
    let rows: Vec<_> = setup.nearest().expect("nearest").into_iter().map(|i| setup.body_weights[i].clone()).collect();
    let cloth = crate::rig::Character {
        body: crate::rig::Mesh { positions: crate::rig::vertices(&setup.template), ..Default::default() },
        weights: rows,
        ..dressed.clone()
    };
    for sample in &mut samples {
        let pose = crate::simulate::to_body_frame(&dressed, &crate::rig::pose(&sample.joints));
        let swell = 4.0 * pose[2].translation.x;
        let wider = |p: glam::DVec3| p + glam::DVec3::new(p.x, 0.0, p.z) * swell.clamp(-0.4, 0.4);
        let posed = cloth.pose_body(&pose).into_iter().map(wider).collect::<Vec<_>>();
        sample.truth = crate::rig::numbers(&posed);
    }
    Dataset::new(setup, samples)
}

#[test]
fn every_form_learns_and_outcomes_are_kept() {
    let (dataset, folder) = (dataset(), tempfile::tempdir().expect("a folder"));
    let settings = Settings { epochs: 30, ..Settings::default() };
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
    for form in ["pbns", "deepsd", "no-mesh", "no-weights", "no-skeleton", "L2-F64-m64-k64"] {
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
    let grid = Grid::new(Table::Ablation, &study, &Table::Ablation.entries()[..1], &outcomes[1..2]).to_string();
    assert!(
        grid.contains("| (a) simulation ")
            && grid.contains("| (b) smoothed W_C^I alone ")
            && grid.contains("0.00 ± 0.00")
    );
    let other = Study::new(&dataset, Settings { epochs: 2, ..settings }, folder.path()).expect("a study");
    let message = other.outcome(&all[0], |_| ()).expect_err("another study").to_string();
    assert!(message.contains("another study") && message.contains("epochs: 2"), "{message}");
}

#[test]
fn the_front_s_grid_names_the_recommended_size() {
    let (dataset, folder) = (dataset(), tempfile::tempdir().expect("a folder"));
    let study = Study::new(&dataset, Settings::default(), folder.path()).expect("a study");
    let sizes = Table::Front.entries();
    let names: std::collections::BTreeSet<&str> = sizes.iter().map(|entry| entry.name.as_str()).collect();
    assert_eq!(names.len(), sizes.len(), "every size once");
    let outcomes: Vec<Outcome> = sizes
        .iter()
        .enumerate()
        .map(|(i, entry)| Outcome {
            name: entry.name.clone(),
            made_of: String::new(),
            errors: Errors::default(),
            validation: 0.006 - 0.0005 * i.min(3) as f64,
            bytes: 1_000_000,
            flops: 1_000_000 * (i + 1),
            epoch: 1,
            seconds: 1.0,
        })
        .collect();
    let grid = Grid::new(Table::Front, &study, &sizes, &outcomes);
    assert!(grid.note.contains("Recommended: L 2, F 64, m 64, k 64"), "{}", grid.note);
    let pairs: Vec<_> = sizes.into_iter().zip(outcomes).collect();
    let page = page("a study", &[grid], &pairs).expect("a page");
    assert_eq!(page.matches("<circle").count(), 12, "a dot per size");
    assert!(page.contains("recommended") && !page.contains("<script"));
}
