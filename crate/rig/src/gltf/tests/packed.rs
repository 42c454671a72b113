//! Files as the web ships them: compressed, quantised, with pictures that nobody here decodes, with targets to morph
//! to. Each is packed here from the tube and must read back as the tube.

use super::{RATE, edit, tube, tube_file};
use crate::gltf::{read_character, read_garment};
use draco_core::{EncoderBuffer, EncoderOptions, GeometryAttributeType, Mesh, MeshEncoder, PointAttribute};
use glam::DVec3;
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{self, ExpMode, IndexEncoding, VertexEncoding};
use serde_json::{Value, json};
use std::path::Path;

/// Largest distance from a vertex of the tube to the nearest that was read, in the canonical pose and in the last of
/// its clips, metres.
fn distance_from_tube(path: &Path) -> f64 {
    let (read, tube) = (read_character(path, RATE).unwrap(), tube());
    assert_eq!(read.body.mesh.positions.len(), tube.body.mesh.positions.len());
    assert_eq!(read.clips.len(), tube.clips.len());
    let nearest = |p: &DVec3| {
        let points = read.body.mesh.positions.iter().enumerate();
        points.min_by(|a, b| a.1.distance(*p).total_cmp(&b.1.distance(*p))).unwrap().0
    };
    let partner: Vec<usize> = tube.body.mesh.positions.iter().map(nearest).collect();
    let pairs = |now: &[DVec3], then: &[DVec3]| {
        partner.iter().zip(then).map(|(&at, p)| now[at].distance(*p)).fold(0.0, f64::max)
    };
    let posed = |character: &crate::Character| character.pose_body(character.clips[0].poses.last().unwrap());
    pairs(&read.body.mesh.positions, &tube.body.mesh.positions).max(pairs(&posed(&read), &posed(&tube)))
}

fn view_of(json: &Value, accessor: &Value) -> usize {
    json["accessors"][accessor.as_u64().unwrap() as usize]["bufferView"].as_u64().unwrap() as usize
}

/// What an accessor of floats holds.
fn floats(json: &Value, bin: &[u8], accessor: &Value) -> Vec<f32> {
    let view = &json["bufferViews"][view_of(json, accessor)];
    let [from, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
    bin[from..from + length].as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect()
}

/// Positions as whole numbers of 16 bits, made long again by the inverse bind matrices, as gltfpack does it.
fn quantise(json: &mut Value, bin: &mut Vec<u8>) {
    let (scale, from) = (1.4 / 65535.0, DVec3::new(-0.2, -0.05, -0.2));
    let index = json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].clone();
    let points = floats(json, bin, &index);
    let start = bin.len();
    for point in points.as_chunks::<3>().0 {
        let whole = (0..3).map(|i| ((f64::from(point[i]) - from[i]) / scale).round() as u16);
        bin.extend(whole.chain([0]).flat_map(u16::to_le_bytes));
    }
    let length = bin.len() - start;
    json["bufferViews"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "buffer": 0, "byteOffset": start, "byteLength": length, "byteStride": 8 }));
    let view = json["bufferViews"].as_array().unwrap().len() - 1;
    let accessor = &mut json["accessors"][index.as_u64().unwrap() as usize];
    (accessor["bufferView"], accessor["componentType"]) = (json!(view), json!(5123));
    let binds = json["skins"][0]["inverseBindMatrices"].clone();
    let at = json["bufferViews"][view_of(json, &binds)]["byteOffset"].as_u64().unwrap() as usize;
    let numbers: Vec<f64> = floats(json, bin, &binds).into_iter().map(f64::from).collect();
    let grow = glam::DMat4::from_scale_rotation_translation(DVec3::splat(scale), glam::DQuat::IDENTITY, from);
    let grown = numbers.as_chunks::<16>().0.iter().map(|m| glam::DMat4::from_cols_array(m) * grow);
    let bytes: Vec<u8> = grown.flat_map(|m| m.to_cols_array()).flat_map(|x| (x as f32).to_le_bytes()).collect();
    bin[at..at + bytes.len()].copy_from_slice(&bytes);
    json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
}

/// Every buffer view by meshoptimizer's codecs: indices as triangles, floats of vectors by the exponential filter where
/// `filtered`, all else as it is; the plain buffer stays a fallback without bytes.
fn meshopt(json: &mut Value, bin: &mut Vec<u8>, name: &str, filtered: bool) {
    let version = if name.starts_with("EXT") { 0 } else { 1 };
    let mut workspace = Workspace::default();
    let indices = json["meshes"][0]["primitives"][0]["indices"].as_u64();
    let positions = json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64();
    let mut packed = Vec::new();
    for at in 0..json["accessors"].as_array().unwrap().len() {
        let accessor = json["accessors"][at].clone();
        let index = view_of(json, &json!(at));
        let view = json["bufferViews"][index].clone();
        let [from, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
        let (bytes, count) = (&bin[from..from + length], accessor["count"].as_u64().unwrap() as usize);
        let stride = length / count;
        let exponential = filtered && Some(at as u64) == positions && accessor["componentType"] == json!(5126);
        let (mode, coded) = if Some(at as u64) == indices {
            let corners: Vec<u32> = bytes.as_chunks::<4>().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
            let coding = IndexEncoding::new(1).unwrap();
            ("TRIANGLES", codec::encode_index_buffer(&corners, coding, &mut workspace).unwrap())
        } else {
            let plain = match exponential {
                true => {
                    let numbers = floats(json, bin, &json!(at));
                    let mode = ExpMode::Separate;
                    codec::encode_filter_exp(count, stride, 20, &numbers, mode, &mut workspace).unwrap()
                }
                false => bytes.to_vec(),
            };
            let coding = VertexEncoding::new(version, 2).unwrap();
            ("ATTRIBUTES", codec::encode_vertex_buffer(&plain, count, stride, coding, &mut workspace).unwrap())
        };
        let filter = if exponential { "EXPONENTIAL" } else { "NONE" };
        json["bufferViews"][index]["buffer"] = json!(1);
        json["bufferViews"][index]["extensions"] = json!({ name: { "buffer": 0, "byteOffset": packed.len(),
            "byteLength": coded.len(), "byteStride": stride, "count": count, "mode": mode, "filter": filter } });
        packed.extend(coded);
        packed.resize(packed.len().next_multiple_of(4), 0);
    }
    let plain = json!({ "byteLength": bin.len(), "extensions": { name: { "fallback": true } } });
    json["buffers"] = json!([{ "byteLength": packed.len() }, plain]);
    json["extensionsRequired"] = json!([name, "KHR_mesh_quantization"]);
    *bin = packed;
}

/// The body of the tube by Draco, without quantisation.
fn draco(json: &mut Value, bin: &mut Vec<u8>) {
    let primitive = json["meshes"][0]["primitives"][0].clone();
    let mut mesh = Mesh::new();
    let mut ids = serde_json::Map::new();
    for (name, accessor) in primitive["attributes"].as_object().unwrap() {
        let accessor_json = &json["accessors"][accessor.as_u64().unwrap() as usize];
        let width = match accessor_json["type"].as_str().unwrap() {
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 4,
        };
        let kind = if name == "POSITION" { GeometryAttributeType::Position } else { GeometryAttributeType::Generic };
        let whole = accessor_json["componentType"] == json!(5123);
        let number = if whole { draco_core::DataType::Uint16 } else { draco_core::DataType::Float32 };
        let view = &json["bufferViews"][view_of(json, accessor)];
        let [from, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
        let count = accessor_json["count"].as_u64().unwrap() as usize;
        let mut attribute = PointAttribute::new();
        attribute.init(kind, width, number, false, count);
        attribute.buffer_mut().write(0, &bin[from..from + length]);
        let id = mesh.add_attribute(attribute);
        ids.insert(name.clone(), json!(mesh.attribute(id).unique_id()));
    }
    let view = &json["bufferViews"][view_of(json, &primitive["indices"])];
    let [from, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
    mesh.set_num_faces(length / 12);
    mesh.set_faces_from_le_u32_indices(&bin[from..from + length]);
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut out = EncoderBuffer::new();
    encoder.encode(&EncoderOptions::new(), &mut out).unwrap();
    let start = bin.len();
    bin.extend(out.data());
    let views = json["bufferViews"].as_array_mut().unwrap();
    views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": out.data().len() }));
    let view = views.len() - 1;
    let used: Vec<u64> = ids.keys().map(|name| primitive["attributes"][name].as_u64().unwrap()).collect();
    for accessor in used.into_iter().chain(primitive["indices"].as_u64()) {
        json["accessors"][accessor as usize].as_object_mut().unwrap().remove("bufferView");
    }
    json["meshes"][0]["primitives"][0]["extensions"] =
        json!({ "KHR_draco_mesh_compression": { "bufferView": view, "attributes": ids } });
    json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
}

#[test]
fn quantised_and_compressed_files_read_as_the_plain_one() {
    let folder = tempfile::tempdir().unwrap();
    let tube = tube_file(folder.path());
    let quantised = edit(&tube, quantise);
    assert!(distance_from_tube(&quantised) < 4e-5);
    let scale = read_character(&quantised, RATE).unwrap().metres_per_unit;
    assert_eq!(scale, 1.0);
    for (name, filtered) in
        [("EXT_meshopt_compression", false), ("EXT_meshopt_compression", true), ("KHR_meshopt_compression", true)]
    {
        let packed = edit(&tube, |json, bin| meshopt(json, bin, name, filtered));
        assert!(distance_from_tube(&packed) < 4e-6, "{name} {filtered}");
        assert_eq!(read_garment(&packed, 1.0).unwrap().0.mesh.triangles.len(), super::tube().body.mesh.triangles.len());
    }
    let both = edit(&tube, |json, bin| {
        quantise(json, bin);
        meshopt(json, bin, "EXT_meshopt_compression", false);
    });
    assert!(distance_from_tube(&both) < 4e-5);
    assert!(distance_from_tube(&edit(&tube, draco)) < 4e-6);
}

#[test]
fn damage_to_compressed_files_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let tube = tube_file(folder.path());
    let name = "EXT_meshopt_compression";
    let packed = |change: fn(&mut Value, &mut Vec<u8>)| {
        let path = edit(&tube, |json, bin| {
            meshopt(json, bin, name, false);
            change(json, bin);
        });
        read_character(&path, RATE).expect_err("wanted a refusal").to_string()
    };
    let cases: [fn(&mut Value, &mut Vec<u8>); 4] = [
        |_, bin| bin.fill(0xee),
        |json, _| json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = json!(1u64 << 60),
        |json, _| json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["mode"] = json!("SIDEWAYS"),
        |json, _| json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["byteLength"] = json!(1u64 << 40),
    ];
    for change in cases {
        let message = packed(change);
        assert!(message.contains("buffer view 0, compressed by meshopt"), "{message}");
    }
    let broken = edit(&tube, |json, bin| {
        draco(json, bin);
        let view = json["bufferViews"].as_array_mut().unwrap().last_mut().unwrap();
        view["byteLength"] = json!(view["byteLength"].as_u64().unwrap() / 2);
    });
    let message = read_character(&broken, RATE).unwrap_err().to_string();
    assert!(message.contains("mesh 0, primitive 0, compressed by Draco"), "{message}");
}

#[test]
fn pictures_in_other_formats_are_not_read() {
    let folder = tempfile::tempdir().unwrap();
    for extension in ["EXT_texture_webp", "KHR_texture_basisu"] {
        let path = edit(&tube_file(folder.path()), |json, _| {
            json["images"] = json!([{ "bufferView": 0, "mimeType": "image/webp" }]);
            json["textures"] = json!([{ "extensions": { extension: { "source": 0 } } }, {}]);
            json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0,
                "extensions": { "KHR_texture_transform": { "offset": [0.5, 0.0], "scale": [0.5, 0.5] } } });
            json["extensionsRequired"] = json!([extension, "KHR_texture_transform"]);
        });
        assert!(distance_from_tube(&path) < 4e-6, "{extension}");
    }
}

#[test]
fn morph_targets_are_taken_as_exported() {
    let folder = tempfile::tempdir().unwrap();
    let wide = |weights: Value, of_node: bool| {
        let path = edit(&tube_file(folder.path()), |json, _| {
            // Each vertex moves by its own normal, which is of length one.
            let normals = json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"].clone();
            json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": normals }]);
            if of_node { json["nodes"][6]["weights"] = weights } else { json["meshes"][0]["weights"] = weights }
        });
        let character = read_character(&path, RATE).unwrap();
        let middle = |p: &&DVec3| (p.y - 0.6).abs() < 0.01;
        character.body.mesh.positions.iter().filter(middle).map(|p| p.with_y(0.0).length()).fold(0.0, f64::max)
    };
    assert!((wide(json!([0.0]), false) - 0.1).abs() < 1e-6);
    assert!((wide(json!([0.05]), false) - 0.15).abs() < 1e-6);
    assert!((wide(json!([0.02]), true) - 0.12).abs() < 1e-6);
}

#[test]
fn a_gltf_reads_the_files_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = tube_file(folder.path());
    let bytes = std::fs::read(&path).unwrap();
    let glb = ::gltf::Glb::from_slice(&bytes).unwrap();
    let mut json: Value = serde_json::from_slice(&glb.json).unwrap();
    std::fs::write(folder.path().join("the tube.bin"), glb.bin.unwrap()).unwrap();
    json["buffers"][0]["uri"] = json!("the%20tube.bin");
    let apart = folder.path().join("tube.gltf");
    std::fs::write(&apart, json.to_string()).unwrap();
    assert!(distance_from_tube(&apart) < 4e-6);
    std::fs::remove_file(folder.path().join("the tube.bin")).unwrap();
    let message = read_character(&apart, RATE).unwrap_err().to_string();
    assert!(message.contains("buffer 0") && message.contains("the%20tube.bin"), "{message}");
}

#[test]
fn the_parts_that_a_vrm_names_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let old = json!({ "VRM": { "humanoid": { "humanBones": [{ "bone": "hips", "node": 1 },
        { "bone": "leftUpperArm", "node": 3 }, { "bone": "jaw", "node": 4 }, { "bone": "head", "node": 6 }] } } });
    let new = json!({ "VRMC_vrm": { "humanoid": { "humanBones":
        { "hips": { "node": 1 }, "leftUpperArm": { "node": 3 }, "jaw": { "node": 4 } } } } });
    for (extensions, name) in [(old, "VRM"), (new, "VRMC_vrm")] {
        let path = edit(&tube_file(folder.path()), |json, _| {
            json["extensions"] = extensions;
            json["extensionsRequired"] = json!([name]);
        });
        let character = read_character(&path, RATE).unwrap();
        // Node 6 holds the mesh, and the jaw is no part that motion turns.
        let parts: Vec<(&str, usize)> = character.parts.iter().map(|(part, joint)| (part.as_str(), *joint)).collect();
        assert_eq!(parts, [("Hips", 1), ("LeftArm", 3)], "{name}");
        assert_eq!(character.root, 1);
    }
}
