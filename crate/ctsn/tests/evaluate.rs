//! `ctsn evaluate` and `ctsn train` on a dataset on disk: what is written, and what is refused.

mod made;

use ctsn_core::file::Tensors;
use ctsn_core::model::Storage;
use ctsn_train::dataset::{Sample, Setup, pose_path};
use ctsn_train::synthetic;
use ctsn_train::training::{Architecture, initial};
use made::Folder;
use serde_json::Value;

/// Frames of each of the two clips.
const FRAMES: usize = 30;

/// Writes the dataset `data` of two clips and the untrained model `model.safetensors`.
fn write(folder: &Folder) -> (Setup, Vec<Sample>) {
    let (mut setup, mut samples) = synthetic::dataset(300, 4, 2 * FRAMES);
    setup.description.clips = vec!["walk".to_owned(), "wave <3>".to_owned()];
    for sample in &mut samples {
        (sample.record.clip, sample.record.frame) = (sample.record.frame / FRAMES, sample.record.frame % FRAMES);
    }
    write_dataset(folder, "data", &setup, &samples);
    let architecture = Architecture { embedding: 2, basis: 2, layers: 1, heads: 1, features: 4 };
    let seen: Vec<&Sample> = samples.iter().collect();
    let model = initial(&setup, &seen, architecture, 1).expect("a model");
    folder.write("model.safetensors", &model.to_bytes(Storage::F16));
    (setup, samples)
}

fn write_dataset(folder: &Folder, name: &str, setup: &Setup, samples: &[Sample]) {
    let path = folder.path(name);
    setup.write(&path).expect("a setup written");
    for sample in samples {
        let file = pose_path(&path, sample.record.clip, sample.record.frame);
        sample.write(&file).expect("a pose written");
    }
    std::fs::create_dir_all(path.join("poses")).expect("a folder");
}

#[test]
fn the_report_is_told_written_and_drawn() {
    let folder = Folder::new();
    write(&folder);
    let told = folder.accepts("evaluate model.safetensors data --json report.json --html report.html");
    for part in ["tube on synthetic", "6 unseen frames of 2 clips", "E_dist mm", "plain skinning", "mm per metre"] {
        assert!(told.contains(part), "wanted {part:?} in {told}");
    }
    assert!(told.lines().count() <= 13, "the tables are short: {told}");
    let json = std::fs::read(folder.path("report.json")).expect("a report");
    let json: Value = serde_json::from_slice(&json).expect("JSON");
    let number = |path: &str| json.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {json}"));
    assert!(number("/network/distance/mean") > 0.0 && number("/network/distance/p95") > 0.0);
    assert!(number("/skinning/normal/std") >= 0.0 && number("/truth/distance/mean") == 0.0);
    assert_eq!((number("/clips/1/frames"), json["clips"][1]["clip"].as_str()), (3.0, Some("wave <3>")));
    assert!(number("/network/jitter") > 0.0 && number("/truth/jitter") > 0.0);
    let page = std::fs::read_to_string(folder.path("report.html")).expect("a page");
    for part in ["<!DOCTYPE html>", "tube on synthetic", "wave &lt;3&gt;", "<svg", "data:image/png;base64,", "joint2"] {
        assert!(page.contains(part), "wanted {part:?}");
    }
    for part in ["<script", "<link", "href=", "src=\"http", "url("] {
        assert!(!page.contains(part), "a page of its own: found {part:?}");
    }
}

#[test]
fn data_that_cannot_be_judged_is_refused() {
    let folder = Folder::new();
    let (setup, samples) = write(&folder);
    let refuses = |data: &str, says: &[&str]| folder.refuses(&format!("evaluate model.safetensors {data}"), says);
    let mut long = setup.clone();
    long.description.frames = vec![10; long.description.clips.len()];
    write_dataset(&folder, "early", &long, &samples[..5]);
    refuses("early", &["unseen poses", "last tenth", "5 poses of 2 clips"]);
    write_dataset(&folder, "empty", &setup, &[]);
    refuses("empty", &["unseen poses", "0 poses"]);
    folder.refuses("train empty -o out.safetensors", &["at least 50 poses, found 0"]);
    let (other, poses) = synthetic::dataset(200, 4, 20);
    write_dataset(&folder, "other", &other, &poses);
    let sizes = [&setup, &other].map(|setup| format!("{} vertices", setup.template.len() / 3));
    refuses("other", &["cloth is not the model's", &sizes[0], &sizes[1]]);
    let broken = pose_path(&folder.path("data"), 1, 7);
    let bytes = std::fs::read(&broken).expect("a pose");
    let mut file = Tensors::parse(&bytes).expect("tensors");
    let truth = file.tensors.get_mut("truth.positions").expect("a tensor");
    truth.bytes.to_mut()[8..12].copy_from_slice(&f32::NAN.to_le_bytes());
    std::fs::write(&broken, file.to_bytes()).expect("a file written");
    for command in ["evaluate model.safetensors data", "train data -o out.safetensors"] {
        folder.refuses(command, &["001-00007.safetensors", "truth.positions", "NaN", "element 2"]);
    }
}

#[test]
fn a_study_prints_its_tables_goes_on_and_refuses_another_s_outcomes() {
    let folder = Folder::new();
    let (setup, samples) = write(&folder);
    let command = "study data -o study --tables comparison,sizes --epochs 1";
    let told = folder.accepts(command);
    for part in ["# tube on synthetic", "## Comparison", "| PBNS-form", "| DeePSD-form", "| m = 100, k = 256", "| ---"]
    {
        assert!(told.contains(part), "wanted {part:?} in {told}");
    }
    let page = std::fs::read_to_string(folder.path("study/study.html")).expect("a page");
    assert!(page.contains("DeePSD-form") && !page.contains("<script"));
    let model = std::fs::metadata(folder.path("study/L1-F64-m5-k64.safetensors")).expect("a model").len();
    let json: Value =
        serde_json::from_slice(&std::fs::read(folder.path("study/study.json")).expect("outcomes")).expect("JSON");
    let outcomes = json.as_array().expect("a list");
    let small = outcomes.iter().find(|outcome| outcome["name"] == "L1-F64-m5-k64").expect("an outcome");
    assert_eq!((outcomes.len(), small["bytes"].as_u64()), (8, Some(model)), "bytes are the file's");
    // Without one of its outcomes the study makes that one anew, and the tables are the same.
    std::fs::remove_file(folder.path("study/pbns.json")).expect("an outcome");
    assert_eq!(folder.accepts(command), told);
    folder.refuses("study data -o study --tables comparison --epochs 2", &["another study", "epochs: Some(2)"]);
    write_dataset(&folder, "early", &setup, &samples[..5]);
    folder.refuses("study early -o other", &["at least 50 poses, found 5"]);
}
