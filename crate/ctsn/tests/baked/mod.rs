//! `ctsn bake`: its steps, and what it keeps between them.

use super::made::{Folder, write_blanket, write_character, write_garment};
use ctsn_core::cpu::Level;
use ctsn_core::model::HostModel;
use ctsn_core::{Predictor, Streams};
use ctsn_rig::{joints, vertices};
use glam::{DAffine3, DVec3};

/// A folder with a character that turns for so many frames, and a blanket of few vertices on it.
fn turning(frames: usize) -> Folder {
    let folder = Folder::new();
    write_character(&folder, |character| {
        let bound: Vec<_> = character.joints.iter().map(|joint| joint.inverse_bind.inverse()).collect();
        let turned = |frame: usize| DAffine3::from_rotation_y(0.05 * frame as f64);
        let pose = |frame: usize| bound.iter().map(|joint| turned(frame) * *joint).collect();
        character.clips[0].poses = (0..frames).map(pose).collect();
    });
    write_blanket(&folder);
    folder
}

/// A bake on the blanket's own mesh.
const BAKE: &str = "bake character.glb garment.glb --resample never -o out.safetensors";

#[test]
fn a_bake_keeps_to_its_garment() {
    let folder = Folder::new();
    write_character(&folder, |_| ());
    write_garment(&folder, DVec3::ZERO);
    let output = folder.run("bake character.glb garment.glb --kind robe -o out.safetensors");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && message.contains("cannot be used with"), "{message}");
    std::fs::create_dir_all(folder.path("out.work")).expect("a folder");
    folder.write("out.work/garment.glb", b"made");
    folder.write("out.work/garment.txt", b"character.glb of another cut");
    folder.refuses(
        "bake character.glb --kind robe -o out.safetensors",
        &["out.work", "another garment", "of another cut", "Robe"],
    );
}

/// The model packed predicts what it does within the bound, in the character's frames, in less than half the bytes.
fn is_packed_as_it_predicts(folder: &Folder) {
    let told = folder.accepts("pack out.safetensors character.glb --report -o small.safetensors");
    assert!(told.contains("skeleton.basis") && told.contains("wanted 0.1 mm and 0.1°"), "{told}");
    let [whole, small] = ["out.safetensors", "small.safetensors"].map(|name| folder.path(name));
    let bytes = |path| std::fs::metadata(path).expect("a file").len();
    assert!(2 * bytes(&small) < bytes(&whole), "{} of {} bytes", bytes(&small), bytes(&whole));
    let character = ctsn_rig::gltf::read_character(&folder.path("character.glb"), 10.0).expect("a character");
    let cloth = |path| {
        let model = HostModel::read(&ctsn_rig::file::tensors(path).expect("tensors")).expect("a model");
        let mut predictor = Predictor::from_model(model, Level::new());
        let predict = |pose| {
            predictor.predict_row_major(&joints(pose), Streams::Both).expect("a prediction");
            vertices(predictor.positions())
        };
        character.clips[0].poses.iter().flat_map(predict).collect::<Vec<_>>()
    };
    let (whole, small) = (cloth(&whole), cloth(&small));
    let moved = whole.iter().zip(&small).map(|(a, b)| a.distance(*b)).sum::<f64>() / whole.len() as f64;
    assert!(moved > 0.0 && moved < 1.5e-4, "{} vertices moved by {moved} m", whole.len());
}

#[test]
fn a_bake_learns_from_paths_and_then_from_its_own_predictions() {
    let folder = turning(100);
    let bake = format!("{BAKE} --poses 70 --epochs 2");
    let told = folder.accepts(&bake);
    for part in ["out.safetensors: a first model", "unseen frames", "plain skinning"] {
        assert!(told.contains(part), "wanted {part:?} in {told}");
    }
    let teacher = |data: &str| {
        let setup = ctsn_train::dataset::Setup::read(&folder.path(data)).expect("readable").expect("a setup");
        setup.description.teacher
    };
    assert!(teacher("out.work/first").is_none() && teacher("out.work").is_some());
    let [first, model] = ["out.work/first.safetensors", "out.safetensors"].map(|name| std::fs::read(folder.path(name)));
    assert_ne!(first.expect("a model"), *model.as_ref().expect("a model"), "the second learned from more poses");
    let along = std::fs::read_dir(folder.path("out.work/first/poses")).expect("poses");
    for pose in along.map(|entry| entry.expect("a pose")) {
        let kept = std::fs::read(folder.path("out.work/poses").join(pose.file_name())).ok();
        assert_eq!(kept, std::fs::read(pose.path()).ok(), "{:?} is not simulated twice", pose.file_name());
    }
    let poses = |data: &str| ctsn_train::report::Report::new(&folder.path(data)).expect("a report").kept;
    assert!(poses("out.work") > poses("out.work/first"), "others are relaxed from predictions");
    let inside = folder.accepts("inspect out.safetensors --on character.glb");
    assert!(inside.contains("before the repair") && inside.contains("frames"), "{inside}");
    is_packed_as_it_predicts(&folder);
    let again = folder.accepts(&bake);
    assert!(again.contains("0 poses to simulate") && again.contains("has been trained so already"), "{again}");
    assert_eq!(std::fs::read(folder.path("out.safetensors")).ok(), model.ok());
}

#[test]
fn a_bake_of_too_few_poses_is_refused_before_they_are_simulated() {
    let folder = turning(100);
    folder.refuses(&format!("{BAKE} --poses 49 --epochs 2"), &["at least 50 poses", "found 49"]);
    assert!(!folder.path("out.work").join("first").exists());
}

#[test]
fn a_bake_in_too_little_time_still_makes_a_model() {
    let folder = turning(100);
    let bake = format!("{BAKE} --poses 90 --time-budget 1s");
    let told = folder.accepts(&bake);
    // The budget has time for a few; simulated were as many as a training wants, some of which may be left out.
    let kept = ctsn_train::report::Report::new(&folder.path("out.work")).expect("a report").kept;
    assert!((60..90).contains(&kept) && told.contains("unseen frames"), "{kept} kept: {told}");
    let finished = |told: &str| told.matches("has been simulated already").count();
    assert_eq!(finished(&folder.accepts(&bake)), 2, "both datasets are kept");
    folder.write("out.checkpoint", b"of a training that was cut off");
    let told = folder.accepts(&bake.replace("1s", "30s"));
    assert_eq!(finished(&told), 1, "a longer bake goes on: {told}");
    let more = ctsn_train::report::Report::new(&folder.path("out.work")).expect("a report").kept;
    assert!(more > kept, "wanted more than {kept}, found {more}");
    std::fs::remove_file(folder.path("out.work/simulated")).expect("what an interrupted step has not written yet");
    let told = folder.accepts(&bake);
    assert_eq!(finished(&told), 1, "the step that was interrupted goes on: {told}");
    std::fs::remove_file(folder.path("out.safetensors")).expect("a model");
    folder.refuses(&format!("{bake} --material silk"), &["first", "another material", "name: \"silk\""]);
}
