//! The binary `ctsn` on good and bad input: what is refused ends with exit code 1 and a message that names the thing.

mod baked;
mod interrupted;
mod machine;
mod made;
mod strangers;
mod training;

use ctsn_core::file::{Tensor, Tensors};
use ctsn_rig::Garment;
use glam::DVec3;
use made::{Folder, change_garment, edit, spoil, write_blanket, write_character, write_garment};
use serde_json::Value;

const TINY: &[u8] = include_bytes!("../../../tests/golden/tiny.safetensors");
const EXPECTED: &[u8] = include_bytes!("../../../tests/golden/tiny.golden.safetensors");

fn poses_file(shape: &[usize], values: &[f32]) -> Vec<u8> {
    let mut file = Tensors::default();
    file.tensors.insert("pose.joints".to_owned(), Tensor::f32(shape, values));
    file.to_bytes()
}

#[test]
fn inspect_and_predict_agree_with_the_golden_file() {
    let folder = Folder::new();
    let golden = Tensors::parse(EXPECTED).expect("golden file");
    folder.write("tiny.safetensors", TINY).write("poses.safetensors", EXPECTED);
    let shown = folder.accepts("inspect tiny.safetensors");
    for part in ["24 vertices, 36 triangles", "hip, leg0, leg1", "m = 4", "2 heads × 4", "k = 8", "skeleton.basis"] {
        assert!(shown.contains(part), "wanted {part:?} in {shown}");
    }
    let shape = [Some(4), Some(24), Some(3)];
    let wanted = golden.f32("expected.positions", &shape).expect("golden positions").0;
    let tolerances: Value = serde_json::from_str(&golden.metadata["tolerance"]).expect("tolerances");
    let tolerance = tolerances["positions"].as_f64().expect("a tolerance") as f32;
    for device in ["cpu", "gpu"] {
        folder
            .accepts(&format!("predict tiny.safetensors poses.safetensors --device {device} -o {device}.safetensors"));
        let out = std::fs::read(folder.path(&format!("{device}.safetensors"))).expect("a prediction");
        let out = Tensors::parse(&out).expect("tensors");
        let found = out.f32("positions", &shape).expect("positions").0;
        out.f32("normals", &shape).expect("normals");
        let close = |(found, wanted): (&f32, &f32)| (found - wanted).abs() <= tolerance;
        assert!(found.iter().zip(&wanted).all(close), "{device}: wanted {wanted:?}, found {found:?}");
    }
}

#[test]
fn inspect_tells_what_a_character_is() {
    let folder = Folder::new();
    write_character(&folder, |character| character.joints[1].name = "Breast".to_owned());
    let shown = folder.accepts("inspect character.glb");
    for part in ["98 vertices, 192 triangles, 1.20 m", "2, root Hips: Hips, Breast", "1\n    turn", " 0.2 s"] {
        assert!(shown.contains(part), "wanted {part:?} in {shown}");
    }
}

#[test]
fn models_that_are_none_are_refused() {
    let folder = Folder::new();
    let mut lying = Tensors::parse(TINY).expect("golden model");
    lying.tensors.get_mut("cloth.rest").expect("a tensor").shape = vec![36, 2];
    folder
        .write("picture.safetensors", b"a picture of a fox")
        .write("cut.safetensors", &TINY[..TINY.len() / 2])
        .write("lying.safetensors", &lying.to_bytes())
        .write("poses.safetensors", EXPECTED);
    for (file, says) in [
        ("picture", &["not a safetensors file", "18"][..]),
        ("cut", &["truncated file", "ends at byte"]),
        ("lying", &["tensor cloth.rest", "wanted shape [*, 3]", "found [36, 2]"]),
        ("poses", &["not a ctsn model", "__metadata__ has no key ctsn"]),
        ("none", &["No such file"]),
    ] {
        let (name, says) = (format!("{file}.safetensors"), [says, &[file]].concat());
        folder.refuses(&format!("inspect {name}"), &says);
        for (command, poses) in [("predict", "poses.safetensors"), ("export", "")] {
            folder.refuses(&format!("{command} {name} {poses} -o out.safetensors"), &says);
        }
    }
}

#[test]
fn poses_that_are_none_are_refused() {
    let folder = Folder::new();
    let mut values = vec![0.5; 36];
    folder
        .write("tiny.safetensors", TINY)
        .write("four.safetensors", &poses_file(&[1, 4, 3, 4], &[0.0; 48]))
        .write("square.safetensors", &poses_file(&[1, 3, 4, 4], &[0.0; 48]));
    values[7] = f32::NAN;
    folder.write("nan.safetensors", &poses_file(&[1, 3, 3, 4], &values));
    folder.write("empty.safetensors", &Tensors::default().to_bytes());
    for (file, says) in [
        ("four", &["pose.joints", "wanted shape [*, 3, 3, 4]", "found [1, 4, 3, 4]"][..]),
        ("square", &["pose.joints", "wanted shape [*, 3, 3, 4]", "found [1, 3, 4, 4]"]),
        ("nan", &["pose.joints", "NaN at element 7"]),
        ("empty", &["tensor pose.joints is missing"]),
        ("none", &["No such file"]),
    ] {
        let name = format!("{file}.safetensors");
        let says = [says, &[&name]].concat();
        folder.refuses(&format!("predict tiny.safetensors {file}.safetensors -o out.safetensors"), &says);
    }
}

#[test]
fn characters_that_are_none_are_refused() {
    let folder = Folder::new();
    write_garment(&folder, DVec3::ZERO);
    let refuses = |says: &[&str]| {
        let says = [says, &["character.glb"]].concat();
        folder.refuses("simulate character.glb garment.glb -o data", &says);
        folder.refuses("bake character.glb garment.glb -o out.safetensors", &says);
        assert!(!folder.path("data").exists(), "a dataset of nothing");
    };
    refuses(&["No such file"]);
    folder.write("character.glb", b"a picture of a fox");
    refuses(&["not a glTF"]);
    folder.refuses("garment character.glb -o made.glb", &["character.glb", "not a glTF"]);
    write_character(&folder, |character| character.clips.clear());
    refuses(&["no clip", "wanted at least one"]);
    write_character(&folder, |_| ());
    edit(&folder.path("character.glb"), spoil);
    refuses(&["NaN"]);
    write_character(&folder, |_| ());
    edit(&folder.path("character.glb"), |json, _| {
        json.as_object_mut().expect("JSON").remove("skins");
        for node in json["nodes"].as_array_mut().expect("nodes") {
            node.as_object_mut().expect("a node").remove("skin");
        }
    });
    refuses(&["no skin"]);
}

#[test]
fn garments_that_are_none_are_refused() {
    let folder = Folder::new();
    write_character(&folder, |_| ());
    let refuses = |says: &[&str]| folder.refuses("simulate character.glb garment.glb -o data", says);
    refuses(&["garment.glb", "No such file"]);
    folder.write("garment.glb", b"a picture of a shirt");
    refuses(&["garment.glb", "not a glTF"]);
    write_garment(&folder, DVec3::ZERO);
    edit(&folder.path("garment.glb"), spoil);
    refuses(&["garment.glb", "NaN"]);
    write_garment(&folder, DVec3::ZERO);
    edit(&folder.path("garment.glb"), |json, _| {
        for node in json["nodes"].as_array_mut().expect("nodes") {
            node.as_object_mut().expect("a node").remove("mesh");
        }
    });
    refuses(&["garment.glb", "no garment", "triangle"]);
    for away in [DVec3::X * 5.0, DVec3::Y * 100.0] {
        write_garment(&folder, away);
        refuses(&["garment", "body"]);
    }
}

#[test]
fn a_garment_of_one_s_own_is_checked() {
    let folder = Folder::new();
    write_character(&folder, |_| ());
    let check = "garment character.glb --check garment.glb";
    let changed = |change: fn(&mut Garment)| {
        write_garment(&folder, DVec3::ZERO);
        change_garment(&folder, change);
    };
    changed(|_| ());
    let said = folder.accepts(check);
    assert!(said.contains("waistband") && said.contains("fit to be simulated, 1 mended, 0 warnings"), "{said}");
    changed(|garment| garment.pins = vec![3, 5, 8]);
    let said = folder.accepts(check);
    assert!(said.contains(" 3 pins; fit to be simulated"), "written and read as _PIN: {said}");
    // A face of a side, not of a rim.
    changed(|garment| {
        let positions = garment.mesh.positions.clone();
        let inner = |corners: &[u32; 3]| corners.iter().all(|corner| positions[*corner as usize].y.abs() < 0.1);
        let face = garment.mesh.triangles.iter().position(inner).expect("a face");
        garment.mesh.triangles.remove(face);
    });
    let said = folder.accepts(check);
    // Too large a part of the opening to be closed unasked.
    assert!(said.contains("hole of 3 edges") && said.contains("1 warnings"), "{said}");
    changed(|garment| garment.mesh.triangles.iter_mut().for_each(|corners| corners.swap(1, 2)));
    assert!(folder.accepts(check).contains("turned right side out: 100 %"));
    changed(|garment| garment.mesh.triangles.push(garment.mesh.triangles[7]));
    assert!(folder.accepts(check).contains("duplicated faces removed"));
    changed(|garment| garment.mesh.positions.iter_mut().for_each(|position| *position *= DVec3::new(1.9, 1.0, 1.9)));
    folder.refuses(check, &["garment.glb", "would fall", "_PIN"]);
    changed(|garment| garment.mesh.positions.iter_mut().for_each(|position| *position *= 0.01));
    folder.refuses(check, &["garment.glb", "scale", "100 times too small"]);
}

#[test]
fn names_that_are_unknown_are_refused() {
    let folder = Folder::new();
    write_character(&folder, |_| ());
    write_garment(&folder, DVec3::ZERO);
    folder.write("tiny.safetensors", TINY);
    folder.refuses("character nobody -o made.glb", &["nobody", "mannequin"]);
    folder.refuses("simulate character.glb garment.glb -o data --clip swim", &["no clip swim", "turn"]);
    folder.refuses("simulate character.glb garment.glb -o data --rate 0", &["--rate", "found 0"]);
    let render = "render tiny.safetensors character.glb -o made.png";
    folder.refuses(&format!("{render} --clip swim --frame 0"), &["swim", "turn"]);
    folder.refuses(&format!("{render} --clip turn --frame 99"), &["no frame 99", "3"]);
    folder.refuses(&format!("{render} --clip turn --frame 0"), &["joint hip"]);
    assert!(!folder.path("made.glb").exists() && !folder.path("made.png").exists());
}

#[test]
fn datasets_that_are_none_are_refused() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("data")).expect("a folder");
    folder.write("tiny.safetensors", TINY);
    for data in ["data", "missing"] {
        let says = [data, "setup.safetensors", "ctsn simulate"];
        folder.refuses(&format!("train {data} -o out.safetensors"), &says);
        folder.refuses(&format!("evaluate tiny.safetensors {data}"), &says);
    }
    folder.write("data/setup.safetensors", TINY);
    folder.refuses("train data -o out.safetensors", &["setup.safetensors", "no key setup"]);
}

#[test]
fn arguments_that_are_none_are_refused() {
    let folder = Folder::new();
    for arguments in ["", "dance", "predict", "export one", "inspect one two"] {
        let output = folder.run(arguments);
        assert_eq!(output.status.code(), Some(2), "ctsn {arguments}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("Usage"), "ctsn {arguments}");
    }
}

/// Every file of a dataset that the machine has no say in, by its path.
fn poses_of(folder: &std::path::Path) -> std::collections::BTreeMap<String, Vec<u8>> {
    let mut files = std::collections::BTreeMap::new();
    for part in ["", "poses", "twins"] {
        // A shard may have no twin.
        for entry in std::fs::read_dir(folder.join(part)).into_iter().flatten() {
            let path = entry.expect("a file").path();
            if path.extension().is_some_and(|extension| extension == "safetensors") {
                let name = path.strip_prefix(folder).expect("a path inside").display().to_string();
                files.insert(name, std::fs::read(&path).expect("a file"));
            }
        }
    }
    files
}

#[test]
fn shards_copied_together_equal_a_single_run() {
    let folder = Folder::new();
    write_character(&folder, |_| ());
    write_blanket(&folder);
    let simulate = "simulate character.glb garment.glb --resample never --noise-floor 2 -o";
    let whole = folder.accepts(&format!("{simulate} whole"));
    for part in ["3 kept, 0 left out, 0 not simulated", "2 poses with every joint turned by 0.5°", "cotton"] {
        assert!(whole.contains(part), "wanted {part:?} in {whole}");
    }
    let first = folder.accepts(&format!("{simulate} first --shard 0/2"));
    assert!(first.contains("2 kept, 0 left out, 1 not simulated"), "{first}");
    folder.accepts(&format!("{simulate} second --shard 1/2"));
    let mut merged = poses_of(&folder.path("first"));
    let second = poses_of(&folder.path("second"));
    assert_eq!(merged["setup.safetensors"], second["setup.safetensors"], "the canonical drape depends on the shard");
    for (name, bytes) in second {
        std::fs::create_dir_all(folder.path("first").join(&name).parent().expect("a folder")).expect("a folder");
        std::fs::write(folder.path("first").join(&name), &bytes).expect("a file copied");
        merged.insert(name, bytes);
    }
    let single = poses_of(&folder.path("whole"));
    assert_eq!(single.len(), 1 + 3 + 2, "{:?}", single.keys());
    assert!(merged == single, "wanted {:?}, found {:?}", single.keys(), merged.keys());
    let again = folder.accepts(&format!("{simulate} first"));
    assert!(again.contains("0 poses to simulate, 5 found done") && again.contains("3 kept"), "{again}");
    let report: Value =
        serde_json::from_slice(&std::fs::read(folder.path("first/report.json")).expect("a report")).expect("JSON");
    assert_eq!((report["kept"].as_u64(), report["missing"].as_u64()), (Some(3), Some(0)), "{report}");
    assert_eq!(report["penetration"]["vertices"].as_u64(), Some(0), "{report}");
    assert!(folder.accepts("inspect first").contains("3 kept"));
    folder.refuses(&format!("{simulate} first --mixed 2"), &["character.glb", "nothing to mix", "limbs"]);
    folder.refuses(&format!("{simulate} first --rate 5"), &["first", "other motion", "5 poses a second"]);
}

#[test]
#[cfg(unix)]
fn a_reader_that_leaves_is_no_panic() {
    let folder = Folder::new();
    folder.write("tiny.safetensors", TINY);
    // The reader has gone before the first line comes.
    let script = format!("(sleep 0.3; {} inspect tiny.safetensors; echo $? >&2) | true", env!("CARGO_BIN_EXE_ctsn"));
    let mut shell = std::process::Command::new("sh");
    let output = shell.args(["-c", &script]).current_dir(folder.path("")).output().expect("sh runs");
    assert_eq!(String::from_utf8_lossy(&output.stderr), "141\n");
}
