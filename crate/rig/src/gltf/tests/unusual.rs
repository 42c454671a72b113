//! What the format allows and few files do: hair with more vertices than the body, props that clips hide, channels that
//! move no node, meshes that no scene shows, parts without texture coordinates.

use super::{RATE, edit, tube, tube_file};
use crate::gltf::write::{Appearance, write_character};
use crate::gltf::{read_character, read_garment};
use crate::path;
use glam::{DMat3, DMat4, DVec2, DVec3};
use serde_json::{Value, json};
use std::path::Path;

/// Adds to a list of the JSON. -> the index
fn push(list: &mut Value, value: Value) -> usize {
    let list = list.as_array_mut().unwrap();
    list.push(value);
    list.len() - 1
}

/// Adds accessors to what these bytes hold, and a buffer view for them. -> index of the first
fn append(json: &mut Value, bin: &mut Vec<u8>, bytes: &[u8], mut accessor: Value) -> usize {
    let view = json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len() });
    accessor["bufferView"] = push(&mut json["bufferViews"], view).into();
    bin.extend(bytes);
    push(&mut json["accessors"], accessor)
}

/// Gives the tube's whole mesh to a second skin, which lists the fifth joint alone and whose bind space is not upright.
/// The body keeps its lower half, as two parts of the same vertices.
fn grow_hair(json: &mut Value, bin: &mut Vec<u8>) {
    let turn = DMat4::from_rotation_x(1.0) * DMat4::from_scale(DVec3::splat(0.01));
    let bind = DMat4::from(tube().joints[4].inverse_bind) * turn;
    let numbers: Vec<u8> = bind.to_cols_array().iter().flat_map(|x| (*x as f32).to_le_bytes()).collect();
    let bind = append(json, bin, &numbers, json!({ "componentType": 5126, "count": 1, "type": "MAT4" }));
    let points = tube().surface.vertex.iter().map(|at| tube().body.mesh.positions[*at as usize]).collect::<Vec<_>>();
    let points = points.iter().map(|point| turn.inverse().transform_point3(*point).as_vec3().to_array());
    let bytes: Vec<u8> = points.flatten().flat_map(f32::to_le_bytes).collect();
    let points = append(json, bin, &bytes, json!({ "componentType": 5126, "count": 91, "type": "VEC3" }));
    let whole = [255u8, 0, 0, 0].repeat(91);
    let full = json!({ "componentType": 5121, "normalized": true, "count": 91, "type": "VEC4" });
    let full = append(json, bin, &whole, full);
    let first = append(json, bin, &[0; 4 * 91], json!({ "componentType": 5121, "count": 91, "type": "VEC4" }));
    let mut body = json["meshes"][0]["primitives"][0].clone();
    let indices = body["indices"].clone();
    let mut quarters = [0, 1].map(|_| json["accessors"][indices.as_u64().unwrap() as usize].clone());
    let count = quarters[0]["count"].as_u64().unwrap() / 12 * 3;
    for (at, quarter) in quarters.iter_mut().enumerate() {
        (quarter["count"], quarter["byteOffset"]) = (count.into(), (4 * count * at as u64).into());
    }
    let parts = quarters.map(|quarter| {
        body["indices"] = push(&mut json["accessors"], quarter).into();
        body.clone()
    });
    json["meshes"][0]["primitives"] = json!(parts);
    let attributes = json!({ "POSITION": points, "JOINTS_0": first, "WEIGHTS_0": full });
    let mesh = push(&mut json["meshes"], json!({ "primitives": [{ "attributes": attributes, "indices": indices }] }));
    let skin = push(&mut json["skins"], json!({ "joints": [4], "inverseBindMatrices": bind }));
    let node = push(&mut json["nodes"], json!({ "name": "Hair", "mesh": mesh, "skin": skin }));
    push(&mut json["scenes"][0]["nodes"], node.into());
}

#[test]
fn a_skin_that_does_not_list_the_hip_is_not_the_bodys() {
    let folder = tempfile::tempdir().unwrap();
    let named = |change: fn(&mut Value)| {
        edit(&tube_file(folder.path()), |json, bin| {
            grow_hair(json, bin);
            change(json);
        })
    };
    let by_vrm = |json: &mut Value| {
        json["extensions"] = json!({ "VRMC_vrm": { "humanoid": { "humanBones": { "hips": { "node": 0 } } } } });
    };
    let nameless = |json: &mut Value| {
        json["nodes"].as_array_mut().unwrap().iter_mut().for_each(|node| node["name"] = "bone".into());
    };
    for (change, what) in [((|_| ()) as fn(&mut Value), "by name"), (by_vrm, "by VRM"), (nameless, "by place")] {
        let character = read_character(&named(change), RATE).unwrap();
        assert_eq!((character.root, character.joints.len()), (0, 6), "{what}");
        assert_eq!(character.metres_per_unit, 1.0, "{what}");
        let wanted = tube().body.mesh.positions;
        for found in &character.body.mesh.positions {
            assert!(wanted.iter().any(|point| point.distance(*found) < 1e-5), "{what}: {found}");
        }
    }
}

/// The tube with its last joint scaled to nothing in the first clip.
fn hide_crown(path: &Path) {
    edit(path, |json, bin| {
        let input = json["animations"][0]["samplers"][0]["input"].clone();
        let count = json["accessors"][input.as_u64().unwrap() as usize]["count"].as_u64().unwrap() as usize;
        let noughts = vec![0; 12 * count];
        let output = append(json, bin, &noughts, json!({ "componentType": 5126, "count": count, "type": "VEC3" }));
        let sampler = push(&mut json["animations"][0]["samplers"], json!({ "input": input, "output": output }));
        let channel = json!({ "sampler": sampler, "target": { "node": 5, "path": "scale" } });
        push(&mut json["animations"][0]["channels"], channel);
    });
}

#[test]
fn a_joint_that_a_clip_hides_leaves_the_pose_sound() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tube.glb");
    for size in [1.0, 1000.0] {
        // Where the file is in millimetres, so are its joints' own lengths.
        let mut sized = tube();
        sized.body.mesh.positions.iter_mut().for_each(|point| *point *= size);
        write_character(&path, &sized, &Appearance::default()).unwrap();
        hide_crown(&path);
        let character = read_character(&folder.path().join("edited.glb"), RATE).unwrap();
        assert!((character.metres_per_unit * size - 1.0).abs() < 1e-9);
        for pose in &character.clips[0].poses {
            assert_eq!(path::check(&character, pose), Ok(()));
            let long = pose[5].matrix3.x_axis.length() * size;
            assert!((long - 1e-3).abs() < 1e-9, "{long}");
        }
    }
}

#[test]
fn a_pose_that_is_not_sound_names_the_joint() {
    let character = tube();
    let mut pose = character.canonical_pose();
    assert!(path::is_sound(&character, &pose));
    pose[3].matrix3 = DMat3::ZERO;
    let message = path::check(&character, &pose).unwrap_err();
    assert!(message.contains("invertible") && message.contains("joint 3 (Neck)"), "{message}");
    assert!(!path::is_sound(&character, &pose));
    assert_eq!(path::check(&character, &pose[..2].to_vec()).unwrap_err(), "pose: wanted 6 joints, found 2");
}

#[test]
fn channels_that_move_no_node_are_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = tube_file(folder.path());
    let plain = read_character(&path, RATE).unwrap();
    let path = edit(&path, |json, _| {
        let target = json!({ "path": "pointer",
            "extensions": { "KHR_animation_pointer": { "pointer": "/materials/0/emissiveFactor" } } });
        let channel = json!({ "sampler": 0, "target": target });
        push(&mut json["animations"][0]["channels"], channel.clone());
        let samplers = json["animations"][0]["samplers"].clone();
        push(&mut json["animations"], json!({ "name": "glow", "channels": [channel], "samplers": samplers }));
        json["extensionsUsed"] = json!(["KHR_animation_pointer"]);
    });
    assert_eq!(read_character(&path, RATE).unwrap().clips, plain.clips);
}

/// A change to a file's JSON.
type Change<'a> = &'a dyn Fn(&mut Value);

#[test]
fn meshes_are_read_that_the_scene_shows() {
    let folder = tempfile::tempdir().unwrap();
    let path = tube_file(folder.path());
    let plain = read_character(&path, RATE).unwrap();
    // Node 6 holds the body, 7 the same once more, 8 stands above 7; the joints are in no scene.
    let changed = |change: Change| {
        edit(&path, |json, _| {
            push(&mut json["nodes"], json!({ "mesh": 0, "skin": 0 }));
            push(&mut json["nodes"], json!({ "children": [7] }));
            json["scenes"] = json!([{ "nodes": [6] }, { "nodes": [6, 8] }]);
            change(json);
        })
    };
    let hide = |node: usize| {
        move |json: &mut Value| {
            json["scene"] = json!(1);
            json["nodes"][node]["extensions"] = json!({ "KHR_node_visibility": { "visible": false } });
            json["extensionsRequired"] = json!(["KHR_node_visibility"]);
        }
    };
    let first = |json: &mut Value| drop(json.as_object_mut().unwrap().remove("scene"));
    let second = |json: &mut Value| json["scene"] = json!(1);
    let none = |json: &mut Value| {
        first(json);
        json.as_object_mut().unwrap().remove("scenes");
    };
    let cases: [(Change, usize); 6] =
        [(&|_| (), 1), (&first, 1), (&second, 2), (&none, 2), (&hide(7), 1), (&hide(8), 1)];
    for (at, (change, times)) in cases.into_iter().enumerate() {
        let path = changed(change);
        let (character, garment) = (read_character(&path, RATE).unwrap(), read_garment(&path, 1.0).unwrap().0);
        for surface in [&character.surface, &garment.surface] {
            assert_eq!(surface.triangles.len(), times * plain.surface.triangles.len(), "case {at}");
        }
        assert_eq!((&character.joints, &character.clips), (&plain.joints, &plain.clips), "case {at}");
    }
    let nothing = changed(&|json| json["scenes"][0]["nodes"] = json!([0]));
    let message = read_character(&nothing, RATE).unwrap_err().to_string();
    assert!(message.contains("no mesh of triangles that its scene shows"), "{message}");
}

#[test]
fn a_part_without_texture_coordinates_leaves_the_others_theirs() {
    let folder = tempfile::tempdir().unwrap();
    let path = tube_file(folder.path());
    let wanted = read_garment(&path, 1.0).unwrap().0.surface;
    let half = wanted.uv.len();
    assert_eq!(half, tube().surface.vertex.len());
    for bare in [0, 1] {
        let path = edit(&path, |json, _| {
            let primitive = json["meshes"][0]["primitives"][0].clone();
            push(&mut json["meshes"][0]["primitives"], primitive);
            json["meshes"][0]["primitives"][bare]["attributes"].as_object_mut().unwrap().remove("TEXCOORD_0");
        });
        let found = read_garment(&path, 1.0).unwrap().0.surface;
        assert_eq!(found.uv.len(), 2 * half);
        assert_eq!(found.uv[bare * half..][..half], vec![DVec2::ZERO; half]);
        assert_eq!(found.uv[(1 - bare) * half..][..half], wanted.uv);
    }
}
