//! The tables of a study as text and as a page, from made-up outcomes.

use super::*;
use ctsn_train::dataset::Dataset;
use ctsn_train::judging::Errors;
use ctsn_train::methods::{Outcome, Study, Table};
use ctsn_train::synthetic;
use ctsn_train::training::Settings;

#[test]
fn the_grid_of_an_ablation_begins_with_the_simulation() {
    let (setup, samples) = synthetic::dataset(60, 3, 60);
    let (dataset, folder) = (Dataset::new(setup, samples), tempfile::tempdir().expect("a folder"));
    let study = Study::new(&dataset, Settings::default(), folder.path()).expect("a study");
    let first = &Table::Ablation.entries()[..1];
    let outcome = study.outcome(&first[0], |_| panic!("plain skinning is not trained")).expect("an outcome");
    let grid = Grid::new(Table::Ablation, &study, first, &[outcome]).to_string();
    assert!(
        grid.contains("| (a) simulation ")
            && grid.contains("| (b) smoothed W_C^I alone ")
            && grid.contains("0.00 ± 0.00")
    );
}

#[test]
fn the_grid_of_the_front_names_the_recommended_size() {
    let (setup, samples) = synthetic::dataset(60, 3, 60);
    let (dataset, folder) = (Dataset::new(setup, samples), tempfile::tempdir().expect("a folder"));
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
