//! Characters that we pack ourselves: read back, they stand and move as before.

use super::super::{pack, read_character};
use super::*;
use serde_json::Value;

fn json_of(path: &Path) -> Value {
    let bytes = std::fs::read(path).unwrap();
    serde_json::from_slice(&::gltf::Glb::from_slice(&bytes).unwrap().json).unwrap()
}

#[test]
fn a_packed_character_stands_and_moves_as_before() {
    let folder = tempfile::tempdir().unwrap();
    let [plain, small] = ["plain.glb", "small.glb"].map(|name| folder.path().join(name));
    let tube = tube();
    write_character(&plain, &tube, &Appearance::default()).unwrap();
    pack(&plain, &small).unwrap();
    let [was, is] = [&plain, &small].map(|path| read_character(path, 30.0).unwrap());
    assert_eq!((was.body.mesh.positions.len(), was.clips.len()), (is.body.mesh.positions.len(), is.clips.len()));
    assert_eq!(was.joints.len(), is.joints.len());
    for (was_clip, is_clip) in was.clips.iter().zip(&is.clips) {
        assert_eq!((&was_clip.name, was_clip.poses.len()), (&is_clip.name, is_clip.poses.len()));
        for (was_pose, is_pose) in was_clip.poses.iter().zip(&is_clip.poses) {
            let apart = was_pose.iter().zip(is_pose).map(|(a, b)| a.translation.distance(b.translation));
            assert!(apart.fold(0.0, f64::max) < 1e-3);
            let [was, is] = [(&was, was_pose), (&is, is_pose)].map(|(character, pose)| character.pose_body(pose));
            let apart = was.iter().zip(&is).map(|(a, b)| a.distance(*b));
            assert!(apart.fold(0.0, f64::max) < 1e-3);
        }
    }
    let json = json_of(&small);
    assert_eq!(json["extensionsRequired"], serde_json::json!(["EXT_meshopt_compression", "KHR_mesh_quantization"]));
    assert!(list_of(&json, "bufferViews") < list_of(&json_of(&plain), "bufferViews"), "clips share streams");
    let refused = pack(&small, &plain).unwrap_err().to_string();
    assert!(refused.contains("packed already"), "{refused}");
}

#[test]
fn only_what_meshes_are_made_of_states_its_stride() {
    let folder = tempfile::tempdir().unwrap();
    let [plain, small] = ["plain.glb", "small.glb"].map(|name| folder.path().join(name));
    // Of one clip there is one accessor of key times: a stream of a single accessor.
    let mut tube = tube();
    tube.clips.truncate(1);
    write_character(&plain, &tube, &Appearance::default()).unwrap();
    pack(&plain, &small).unwrap();
    let json = json_of(&small);
    let stride = |accessor: &Value| {
        let view = json["accessors"][accessor.as_u64().unwrap() as usize]["bufferView"].as_u64().unwrap();
        json["bufferViews"][view as usize]["byteStride"].as_u64()
    };
    for sampler in json["animations"][0]["samplers"].as_array().unwrap() {
        assert_eq!([&sampler["input"], &sampler["output"]].map(stride), [None, None], "glTF forbids it");
    }
    let primitive = &json["meshes"][0]["primitives"][0];
    assert_eq!(stride(&primitive["attributes"]["NORMAL"]), Some(4));
    assert_eq!(stride(&primitive["indices"]), None);
}

#[test]
fn what_is_not_understood_stays_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let [plain, small] = ["plain.glb", "small.glb"].map(|name| folder.path().join(name));
    write_character(&plain, &tube(), &Appearance::default()).unwrap();
    // A picture in the buffer, and an attribute of one's own.
    let bytes = std::fs::read(&plain).unwrap();
    let glb = ::gltf::Glb::from_slice(&bytes).unwrap();
    let (mut json, mut bin): (Value, _) = (serde_json::from_slice(&glb.json).unwrap(), glb.bin.unwrap().into_owned());
    let picture = b"not a picture, but bytes";
    let views = json["bufferViews"].as_array_mut().unwrap();
    views.push(serde_json::json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": picture.len() }));
    json["images"] = serde_json::json!([{ "bufferView": views.len() - 1, "mimeType": "image/png" }]);
    let own = json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].clone();
    json["meshes"][0]["primitives"][0]["attributes"]["_HEAT"] = own;
    bin.extend(picture);
    json["buffers"][0]["byteLength"] = serde_json::json!(bin.len());
    let header = ::gltf::binary::Header { magic: *b"glTF", version: 2, length: 0 };
    let json = json.to_string().into_bytes().into();
    let glb = ::gltf::Glb { header, json, bin: Some(bin.into()) };
    std::fs::write(&plain, glb.to_vec().unwrap()).unwrap();
    pack(&plain, &small).unwrap();
    let bytes = std::fs::read(&small).unwrap();
    let bin = ::gltf::Glb::from_slice(&bytes).unwrap().bin.unwrap().into_owned();
    let json = json_of(&small);
    let view = &json["bufferViews"][json["images"][0]["bufferView"].as_u64().unwrap() as usize];
    let from = view["byteOffset"].as_u64().unwrap() as usize;
    assert_eq!(&bin[from..from + picture.len()], picture);
    // Positions that are something else, too, are left alone.
    let position = json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().unwrap() as usize;
    let view = json["accessors"][position]["bufferView"].as_u64().unwrap() as usize;
    assert!(json["bufferViews"][view]["extensions"].is_null());
    read_character(&small, 30.0).unwrap();
}

fn list_of(json: &Value, key: &str) -> usize {
    json[key].as_array().unwrap().len()
}
