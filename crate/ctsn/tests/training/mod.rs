//! `ctsn train` on made-up data: what it leaves behind, and what is refused.

use super::made::Folder;
use ctsn_core::file::{Tensor, Tensors};
use ctsn_core::model::HostModel;
use ctsn_train::dataset::{Sample, pose_path};
use ctsn_train::loss::LOSSES;
use ctsn_train::synthetic;

const TRAIN: &str = "train data -o out.safetensors --embedding 4 --basis 8 --layers 1 --features 8 --heads 2";

/// Writes dataset `data`: one clip of `poses` poses.
fn write_dataset(folder: &Folder, poses: usize) -> Vec<Sample> {
    let (setup, samples) = synthetic::dataset(60, 3, poses);
    std::fs::create_dir_all(folder.path("data/poses")).expect("a folder");
    setup.write(&folder.path("data")).expect("a setup");
    samples.iter().for_each(|sample| rewrite(folder, sample));
    samples
}

fn rewrite(folder: &Folder, sample: &Sample) {
    sample.write(&pose_path(&folder.path("data"), sample.record.clip, sample.record.frame)).expect("a pose");
}

#[test]
fn a_model_and_its_learning_curve_come_out_the_same_twice() {
    let folder = Folder::new();
    write_dataset(&folder, 60);
    let shown = folder.accepts(&format!("{TRAIN} --epochs 3"));
    for part in ["49 poses to learn from, 5 to validate", "epoch 3", "E_dist", "ms an optimisation step"] {
        assert!(shown.contains(part), "wanted {part:?} in {shown}");
    }
    let read = |name: &str| std::fs::read(folder.path(name)).expect("a file");
    let first = read("out.safetensors");
    let model = HostModel::parse(&first).expect("a model");
    assert!(model.training.is_some_and(|text| text.contains("validation_metres")));
    let curve = String::from_utf8(read("out.curve.csv")).expect("text");
    let mut lines = curve.lines();
    let losses = LOSSES.iter().map(|term| format!("{}_loss", term.name));
    let rest = ["validation_distance", "validation_normal", "validation_bending", "learning_rate", "seconds"]
        .map(str::to_owned);
    let names: Vec<String> = ["epoch".to_owned()].into_iter().chain(losses).chain(rest).collect();
    assert_eq!(lines.next(), Some(names.join(",").as_str()));
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|number| number.parse().expect("a number")).collect()).collect();
    assert!(
        rows.len() == 3
            && rows
                .iter()
                .all(|row| row.len() == names.len() && row[names.len() - 5..].iter().all(|value| *value > 0.0)),
        "{curve}"
    );
    assert!(!folder.path("out.checkpoint").exists());
    let shown = folder.accepts(&format!("{TRAIN} --epochs 3"));
    assert!(shown.contains("has been trained so already"), "{shown}");
    std::fs::remove_file(folder.path("out.safetensors")).expect("removed");
    folder.accepts(&format!("{TRAIN} --epochs 3"));
    assert!(first == read("out.safetensors"), "the same seed gave another model");
    folder.accepts(&format!("{TRAIN} --epochs 3 --storage f32"));
    assert!(read("out.safetensors").len() > first.len(), "wanted another storage, found the model as it was");
    folder.accepts(&format!("{TRAIN} --epochs 2 --without mesh,weights"));
    HostModel::parse(&read("out.safetensors")).expect("an ablated model");
    let shown = folder.accepts(&format!("{TRAIN} --time-budget 0.5s --patience 9999"));
    assert!(shown.contains("E_dist"), "{shown}");
}

#[test]
fn data_that_cannot_be_learned_from_are_refused() {
    let folder = Folder::new();
    let samples = write_dataset(&folder, 49);
    folder.refuses(TRAIN, &["dataset", "wanted at least 50 poses, found 49"]);
    write_dataset(&folder, 60);
    let mut sample = samples[7].clone();
    sample.truth[10] = f32::NAN;
    rewrite(&folder, &sample);
    folder.refuses(TRAIN, &["000-00007.safetensors", "truth.positions", "NaN at element 10"]);
    let mut sample = samples[7].clone();
    sample.truth.truncate(30);
    rewrite(&folder, &sample);
    folder.refuses(TRAIN, &["000-00007.safetensors", "truth.positions", "wanted shape", "found [10, 3]"]);
    rewrite(&folder, &samples[7]);
    let path = folder.path("data/setup.safetensors");
    let mut setup = Tensors::parse(&std::fs::read(&path).expect("a setup")).expect("tensors").into_owned();
    setup.tensors.insert("cloth.triangles".to_owned(), Tensor::u32(&[1, 3], &[0, 1, 9999]));
    std::fs::write(&path, setup.to_bytes()).expect("a setup");
    folder.refuses(TRAIN, &["cloth.triangles", "9999"]);
    for path in std::fs::read_dir(folder.path("data/poses")).expect("poses") {
        std::fs::remove_file(path.expect("a pose").path()).expect("removed");
    }
    write_dataset(&folder, 60);
    for mut sample in synthetic::dataset(60, 3, 60).1 {
        sample.record.rejected = Some("moved".to_owned());
        rewrite(&folder, &sample);
    }
    folder.refuses(TRAIN, &["wanted at least 50 poses, found 0 (60 were left out by the simulation)"]);
}

#[test]
fn a_diverging_training_says_so() {
    let folder = Folder::new();
    write_dataset(&folder, 60);
    folder.refuses(&format!("{TRAIN} --learning-rate 1e30"), &["diverged at epoch 1", "lower learning rate"]);
    // Slow enough for a first epoch that counts: what was best so far is kept.
    let output = folder.run(&format!("{TRAIN} --learning-rate 30"));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && message.contains("diverged"), "{message}");
    assert_eq!(folder.path("out.safetensors").exists(), message.contains("is of the best epoch before"), "{message}");
    let again = folder.run(&format!("{TRAIN} --learning-rate 30"));
    assert!(!again.status.success(), "what diverged counts as trained");
    for wrong in ["90", "m", "-1m", "0s", "1d"] {
        let output = folder.run(&format!("{TRAIN} --time-budget={wrong}"));
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && message.contains("wanted a time as 90s"), "{wrong}: {message}");
    }
}

#[test]
fn another_storage_is_stored_from_what_was_learned() {
    let folder = Folder::new();
    write_dataset(&folder, 60);
    let read = |name: &str| std::fs::read(folder.path(name)).expect("a file");
    let train = format!("{TRAIN} --epochs 2");
    folder.accepts(&train);
    let half = read("out.safetensors");
    let shown = folder.accepts(&format!("{train} --storage f32"));
    assert!(shown.contains("stored anew") && !shown.contains("epoch"), "trained anew: {shown}");
    let whole = read("out.safetensors");
    assert!(folder.accepts(&format!("{train} --storage f32")).contains("has been trained so already; delete it"));
    let shown = folder.accepts(&train);
    assert!(shown.contains("stored anew") && half == read("out.safetensors"), "{shown}");
    // As if it had been trained with that storage.
    folder.accepts(&format!("{train} --storage f32 -o other.safetensors").replacen("-o out.safetensors ", "", 1));
    assert!(whole == read("other.safetensors"), "stored anew with less than was learned");
    // Another training of the same name is another model.
    let shown = folder.accepts(&format!("{train} --storage f32 --seed 2"));
    assert!(shown.contains("epoch 2"), "{shown}");
}
