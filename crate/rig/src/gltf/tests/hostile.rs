//! Files that lie: each is refused with a message of its own, and none causes a panic.

use super::{RATE, edit, overwrite, tube_file};
use crate::gltf::file::File;
use crate::gltf::{character, garment, read_character, read_garment};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The error of reading the tube after a change to its JSON and bytes.
fn refusal(change: impl FnOnce(&mut Value, &mut Vec<u8>)) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = edit(&tube_file(folder.path()), change);
    read_character(&path, RATE).expect_err("wanted a refusal").to_string()
}

#[track_caller]
fn assert_says(message: &str, wanted: &[&str]) {
    wanted.iter().for_each(|part| assert!(message.contains(part), "wanted {part:?} in {message:?}"));
}

fn attribute(json: &Value, name: &str) -> usize {
    json["meshes"][0]["primitives"][0]["attributes"][name].as_u64().unwrap() as usize
}

#[test]
fn what_is_no_gltf_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file.glb");
    let cases: [(&[u8], &str); 6] = [
        (b"", "not a glTF"),
        (b"a picture of a fox", "not a glTF"),
        (b"{}", "not a glTF"),
        (b"glTF", "truncated"),
        (b"glTF\x02\0\0\0\x04\0\0\0", "truncated"),
        (b"{\"asset\":{\"version\":\"2.0\"}}", "no skin"),
    ];
    for (bytes, wanted) in cases {
        std::fs::write(&path, bytes).unwrap();
        assert_says(&read_character(&path, RATE).unwrap_err().to_string(), &["file.glb", wanted]);
    }
    assert_says(&read_character(&folder.path().join("none.glb"), RATE).unwrap_err().to_string(), &["none.glb"]);
}

#[test]
fn what_is_no_character_is_refused() {
    let no_skin = refusal(|json, _| {
        json.as_object_mut().unwrap().remove("skins");
        json["nodes"][6].as_object_mut().unwrap().remove("skin");
    });
    assert_says(&no_skin, &["no skin"]);
    let unused = refusal(|json, _| drop(json["nodes"][6].as_object_mut().unwrap().remove("skin")));
    assert_says(&unused, &["skin", "no mesh", "uses it"]);
    let lines = refusal(|json, _| {
        json["meshes"][0]["primitives"].as_array_mut().unwrap().iter_mut().for_each(|p| p["mode"] = json!(1));
    });
    assert_says(&lines, &["no mesh of triangles"]);
    let unknown = refusal(|json, _| json["extensionsRequired"] = json!(["ACME_teapots", "EXT_meshopt_compression"]));
    assert_says(&unknown, &["ACME_teapots", "not supported"]);
    assert!(!unknown.contains("meshopt"), "{unknown}");
}

#[test]
fn infinite_and_undefined_numbers_are_refused() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for (name, wanted) in [("POSITION", "positions"), ("WEIGHTS_0", "weights"), ("TEXCOORD_0", "texture")] {
            let message = refusal(|json, bin| overwrite(json, bin, attribute(json, name), &value.to_le_bytes()));
            assert_says(&message, &[wanted, "finite"]);
        }
        let binds = refusal(|json, bin| {
            let accessor = json["skins"][0]["inverseBindMatrices"].as_u64().unwrap() as usize;
            overwrite(json, bin, accessor, &value.to_le_bytes());
        });
        assert_says(&binds, &["inverse bind", "finite"]);
        let keys = refusal(|json, bin| {
            let accessor = json["animations"][0]["samplers"][0]["output"].as_u64().unwrap() as usize;
            overwrite(json, bin, accessor, &value.to_le_bytes());
        });
        assert_says(&keys, &["animation bend", "finite"]);
    }
    let huge = refusal(|json, _| json["nodes"][0]["translation"] = json!([1e39, 0, 0]));
    assert_says(&huge, &["node 0", "finite"]);
}

#[test]
fn numbers_out_of_range_are_refused() {
    let index = refusal(|json, bin| {
        let accessor = json["meshes"][0]["primitives"][0]["indices"].as_u64().unwrap() as usize;
        overwrite(json, bin, accessor, &99_999u32.to_le_bytes());
    });
    assert_says(&index, &["indices", "99999", "91 vertices"]);
    let joint = refusal(|json, bin| overwrite(json, bin, attribute(json, "JOINTS_0"), &77u16.to_le_bytes()));
    assert_says(&joint, &["joint 77", "6 joints"]);
    let count = refusal(|json, _| {
        let accessor = attribute(json, "POSITION");
        json["accessors"][accessor]["count"] = json!(1_000_000);
    });
    assert_says(&count, &["positions", "1000000 elements"]);
    let uneven = refusal(|json, _| {
        let accessor = attribute(json, "TEXCOORD_0");
        json["accessors"][accessor]["count"] = json!(17);
    });
    assert_says(&uneven, &["texture coordinates", "91", "17"]);
    let unpainted = refusal(|json, _| {
        let accessor = attribute(json, "COLOR_0");
        json["accessors"][accessor]["count"] = json!(17);
    });
    assert_says(&unpainted, &["vertex colours", "91", "17"]);
    let kind = refusal(|json, _| {
        let accessor = attribute(json, "POSITION");
        json["accessors"][accessor]["type"] = json!("SCALAR");
    });
    assert_says(&kind, &["positions", "Vec3", "Scalar"]);
}

#[test]
fn references_to_nowhere_are_refused() {
    let missing = refusal(|json, _| json["nodes"][6]["mesh"] = json!(5));
    assert_says(&missing, &["not a valid glTF"]);
    let circle = refusal(|json, _| {
        json["nodes"][5]["children"] = json!([0]);
        json["scenes"][0]["nodes"] = json!([6]);
    });
    assert_says(&circle, &["circle"]);
    let twice = refusal(|json, _| json["nodes"][6]["children"] = json!([3]));
    assert_says(&twice, &["node 3", "two parents"]);
    let nowhere = refusal(|json, _| json["animations"][1]["channels"][0]["target"]["node"] = json!(70));
    assert_says(&nowhere, &["animation 1", "node 70", "of 7"]);
    let path = refusal(|json, _| json["animations"][1]["channels"][0]["target"]["path"] = json!("colour"));
    assert_says(&path, &["animation 1", "rotation"]);
    let positions = refusal(|json, _| json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(70));
    assert_says(&positions, &["mesh 0", "accessor 70"]);
    let image = refusal(|json, _| json["images"] = json!([{ "name": "empty" }]));
    assert_says(&image, &["image 0", "neither"]);
}

#[test]
fn impossible_animations_and_binds_are_refused() {
    let backwards = refusal(|json, bin| {
        let accessor = json["animations"][0]["samplers"][0]["input"].as_u64().unwrap() as usize;
        overwrite(json, bin, accessor, &5f32.to_le_bytes());
    });
    assert_says(&backwards, &["animation bend", "decrease"]);
    let endless = refusal(|json, bin| {
        let accessor = json["animations"][0]["samplers"][0]["input"].as_u64().unwrap() as usize;
        overwrite(json, bin, accessor, &(-1e30f32).to_le_bytes());
    });
    assert_says(&endless, &["animation bend", "poses"]);
    let singular = refusal(|json, bin| {
        let accessor = json["skins"][0]["inverseBindMatrices"].as_u64().unwrap() as usize;
        overwrite(json, bin, accessor, &[0; 64]);
    });
    assert_says(&singular, &["Hips", "inverted"]);
    let folder = tempfile::tempdir().unwrap();
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_says(&read_character(&tube_file(folder.path()), rate).unwrap_err().to_string(), &["poses per second"]);
    }
}

#[test]
fn a_uri_that_is_not_text_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("uri.gltf");
    let json = json!({ "asset": { "version": "2.0" }, "buffers": [{ "byteLength": 4, "uri": "%ff.bin" }] });
    std::fs::write(&path, json.to_string()).unwrap();
    assert_says(&read_character(&path, RATE).unwrap_err().to_string(), &["%ff.bin", "UTF-8"]);
}

#[test]
fn garments_without_triangles_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let empty = edit(&tube_file(folder.path()), |json, _| {
        for node in json["nodes"].as_array_mut().unwrap() {
            node.as_object_mut().unwrap().remove("mesh");
            node.as_object_mut().unwrap().remove("skin");
        }
    });
    assert_says(&read_garment(&empty, 1.0).unwrap_err().to_string(), &["no garment", "triangle"]);
    let flat = edit(&tube_file(folder.path()), |json, bin| {
        let accessor = attribute(json, "POSITION");
        overwrite(json, bin, accessor, &[0; 91 * 12]);
    });
    assert_says(&read_garment(&flat, 1.0).unwrap_err().to_string(), &["no garment"]);
    assert_says(&read_garment(&tube_file(folder.path()), f64::NAN).unwrap_err().to_string(), &["metres per unit"]);
}

/// Whether bytes are accepted as a character, as a garment. Then they must be finite, with indices in range.
fn read_both(bytes: &[u8]) -> (bool, bool) {
    let Ok(file) = File::parse(bytes, PathBuf::new()) else { return (false, false) };
    let character = character(&file, RATE).ok();
    if let Some(character) = &character {
        let bodies = character.clips.iter().flat_map(|clip| clip.poses.last()).map(|pose| character.pose_body(pose));
        assert!(bodies.flatten().chain(character.body.mesh.positions.iter().copied()).all(|p| p.is_finite()));
        assert!(
            character.body.mesh.triangles.iter().flatten().all(|&i| (i as usize) < character.body.mesh.positions.len())
        );
        assert!(character.surface.vertex.iter().all(|&i| (i as usize) < character.body.mesh.positions.len()));
    }
    let garment = garment(&file, 1.0).ok();
    if let Some(garment) = &garment {
        assert!(garment.0.mesh.positions.iter().all(|p| p.is_finite()));
    }
    (character.is_some(), garment.is_some())
}

/// Number of damaged files; `CTSN_FUZZ=100000` asks for more.
fn rounds() -> usize {
    std::env::var("CTSN_FUZZ").ok().and_then(|rounds| rounds.parse().ok()).unwrap_or(3000)
}

#[test]
fn truncated_and_flipped_files_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let whole = std::fs::read(tube_file(folder.path())).unwrap();
    assert_eq!(read_both(&whole), (true, true));
    for length in (0..whole.len()).step_by(41) {
        assert_eq!(read_both(&whole[..length]), (false, false), "{length} bytes");
    }
    let mut random = 0x9E37_79B9_7F4A_7C15_u64;
    let mut next = |below: usize| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as usize % below
    };
    let json = 20 + u32::from_le_bytes([whole[12], whole[13], whole[14], whole[15]]) as usize;
    let (mut refused, rounds) = (0, rounds());
    for round in 0..rounds {
        let mut bytes = whole.clone();
        // Half of the flips are in the JSON, where a digit makes an offset lie; half are anywhere.
        let place = if round % 2 == 0 { 20 + next(json - 20) } else { next(whole.len()) };
        if round % 4 == 0 && bytes[place].is_ascii_digit() {
            bytes[place] = b'0' + next(10) as u8;
        } else {
            bytes[place] ^= 1 << next(8);
        }
        refused += usize::from(!read_both(&bytes).0);
    }
    assert!(refused > rounds / 10 && refused < rounds, "{refused} of {rounds} refused");
}

#[test]
fn folders_are_no_files() {
    assert!(read_character(Path::new("/"), RATE).is_err());
}
