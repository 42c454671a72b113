//! Reading what was written; welding, names, units, encodings.

use super::{RATE, edit, overwrite, tube, tube_file};
use crate::gltf::write::{Appearance, write_character, write_garment, write_part};
use crate::gltf::{read_character, read_garment};
use crate::{Garment, Mesh};
use glam::DVec3;
use serde_json::json;
use std::collections::HashMap;

/// For each position the index of the equal one among `others`.
fn matches(positions: &[DVec3], others: &[DVec3]) -> Vec<usize> {
    let find = |p: &DVec3| others.iter().position(|q| p.distance(*q) < 1e-6).unwrap();
    positions.iter().map(find).collect()
}

#[test]
fn a_character_survives_writing_and_reading() {
    let folder = tempfile::tempdir().unwrap();
    let written = tube();
    let read = read_character(&tube_file(folder.path()), RATE).unwrap();
    assert_eq!(read.metres_per_unit, 1.0);
    assert_eq!(read.root, written.root);
    let names = |c: &crate::Character| c.joints.iter().map(|j| (j.name.clone(), j.parent)).collect::<Vec<_>>();
    assert_eq!(names(&read), names(&written));
    assert_eq!(read.body.mesh.positions.len(), written.body.mesh.positions.len());
    assert_eq!(read.body.mesh.triangles.len(), written.body.mesh.triangles.len());
    assert_eq!(read.surface.vertex.len(), written.surface.vertex.len());
    assert_eq!(read.surface.uv.len(), read.surface.vertex.len());
    let corners = |c: &crate::Character| {
        let colours = c.surface.triangles.iter().flatten().map(|&corner| c.surface.colour[corner as usize]);
        colours.collect::<Vec<_>>()
    };
    assert_eq!(corners(&read), corners(&written));
    let partner = matches(&read.body.mesh.positions, &written.body.mesh.positions);
    for (vertex, &other) in partner.iter().enumerate() {
        let expected: HashMap<usize, f64> = written.body.weights[other].iter().copied().collect();
        assert_eq!(read.body.weights[vertex].len(), expected.len());
        assert!(read.body.weights[vertex].iter().all(|(joint, weight)| (expected[joint] - weight).abs() < 1e-6));
    }
    assert_eq!(read.clips.len(), written.clips.len());
    for (clip, before) in read.clips.iter().zip(&written.clips) {
        assert_eq!((&clip.name, clip.poses.len()), (&before.name, before.poses.len()));
        for (pose, was) in clip.poses.iter().zip(&before.poses) {
            let (now, then) = (read.pose_body(pose), written.pose_body(was));
            partner.iter().zip(&now).for_each(|(&at, p)| assert!(p.distance(then[at]) < 2e-6));
        }
    }
}

#[test]
fn clips_are_found_by_name_or_the_error_names_them() {
    let character = tube();
    assert_eq!(character.clip("sway").unwrap().poses.len(), 4);
    let message = character.clip("walk").unwrap_err().to_string();
    assert!(message.contains("walk") && message.contains("bend, sway"), "{message}");
    let still = crate::Character { clips: Vec::new(), ..character };
    assert!(still.clip("walk").unwrap_err().to_string().contains("no clip"));
}

#[test]
fn a_garment_survives_writing_and_reading() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("garment.glb");
    let source = tube();
    let garment = Garment { mesh: source.body.mesh, surface: source.surface, ..Garment::default() };
    write_garment(&path, &garment).unwrap();
    let (read, ours) = read_garment(&path, 0.5).unwrap();
    write_part(&path, &garment).unwrap();
    let (same, theirs) = read_garment(&path, 0.5).unwrap();
    assert!(same == read && ours.own && !theirs.own);
    assert_eq!(read.mesh.triangles.len(), garment.mesh.triangles.len());
    assert_eq!(read.surface.uv.len(), garment.surface.vertex.len());
    let doubled: Vec<DVec3> = read.mesh.positions.iter().map(|p| *p * 2.0).collect();
    let mut partner = matches(&doubled, &garment.mesh.positions);
    partner.sort_unstable();
    assert_eq!(partner, (0..garment.mesh.positions.len()).collect::<Vec<_>>());
}

fn volume(body: &Mesh) -> f64 {
    let corners = |t: &[u32; 3]| t.map(|i| body.positions[i as usize]);
    body.triangles.iter().map(corners).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

#[test]
fn the_welded_tube_is_closed_and_faces_outwards() {
    let folder = tempfile::tempdir().unwrap();
    let body = read_character(&tube_file(folder.path()), RATE).unwrap().body.mesh;
    let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
    for [a, b, c] in &body.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((*from.min(to), *from.max(to))).or_default() += if from < to { 1 } else { -1 };
        }
    }
    assert!(edges.values().all(|&sum| sum == 0), "each edge is walked once in each direction");
    let volume = volume(&body);
    let hexagon = 1.5 * 3f64.sqrt() * 0.01;
    assert!((volume - hexagon * 1.2).abs() < 1e-6, "volume {volume}");
}

#[test]
fn mirrored_characters_still_face_outwards() {
    let folder = tempfile::tempdir().unwrap();
    let path = edit(&tube_file(folder.path()), |json, _| {
        let nodes = json["nodes"].as_array_mut().unwrap();
        nodes.push(json!({ "name": "Mirror", "children": [0], "scale": [-1, 1, 1] }));
        json["scenes"][0]["nodes"] = json!([nodes.len() - 1, nodes.len() - 2]);
    });
    let body = read_character(&path, RATE).unwrap().body.mesh;
    let volume = volume(&body);
    assert!(volume > 0.03, "volume {volume}");
}

#[test]
fn a_body_that_faces_inwards_is_turned() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("inwards.glb");
    let mut inwards = tube();
    inwards
        .body
        .mesh
        .triangles
        .iter_mut()
        .chain(&mut inwards.surface.triangles)
        .for_each(|triangle| triangle.swap(1, 2));
    write_character(&path, &inwards, &Appearance::default()).unwrap();
    let found = read_character(&path, RATE).unwrap();
    assert!(
        volume(&inwards.body.mesh) < -0.03 && volume(&found.body.mesh) > 0.03,
        "volume {}",
        volume(&found.body.mesh)
    );
    let drawn = |t: &[u32; 3]| t.map(|i| found.surface.vertex[i as usize]);
    assert_eq!(found.surface.triangles.iter().map(drawn).collect::<Vec<_>>(), found.body.mesh.triangles);
}

#[test]
fn names_are_made_unique_and_the_hip_is_found_without_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = edit(&tube_file(folder.path()), |json, _| {
        for joint in 0..5 {
            json["nodes"][joint]["name"] = json!("bone");
        }
        json["nodes"][5].as_object_mut().unwrap().remove("name");
    });
    let character = read_character(&path, RATE).unwrap();
    let names: Vec<&str> = character.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["bone", "bone_1", "bone_2", "bone_3", "bone_4", "joint_5"]);
    assert_eq!(character.root, 0);
}

#[test]
fn vertices_without_weights_follow_the_nearest_that_has_some() {
    let folder = tempfile::tempdir().unwrap();
    let path = edit(&tube_file(folder.path()), |json, bin| {
        for set in ["WEIGHTS_0", "WEIGHTS_1"] {
            if let Some(accessor) = json["meshes"][0]["primitives"][0]["attributes"][set].as_u64() {
                overwrite(json, bin, accessor as usize, &[0; 7 * 16]);
            }
        }
    });
    let character = read_character(&path, RATE).unwrap();
    let plain = tube();
    let lowest = |y: f64| matches(&[DVec3::new(0.0, y, 0.1)], &plain.body.mesh.positions)[0];
    let at = matches(&[DVec3::new(0.0, 0.0, 0.1)], &character.body.mesh.positions)[0];
    let (found, expected) = (&character.body.weights[at], &plain.body.weights[lowest(0.1)]);
    assert_eq!(found.len(), expected.len());
    assert!(found.iter().zip(expected).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-6));
    let all = edit(&path, |json, bin| {
        for set in ["WEIGHTS_0", "WEIGHTS_1"] {
            if let Some(accessor) = json["meshes"][0]["primitives"][0]["attributes"][set].as_u64() {
                overwrite(json, bin, accessor as usize, &[0; 13 * 7 * 16]);
            }
        }
    });
    assert!(read_character(&all, RATE).unwrap().body.weights.iter().all(|weights| weights == &vec![(0, 1.0)]));
}

#[test]
fn units_are_recognised_by_size() {
    let folder = tempfile::tempdir().unwrap();
    for (size, expected) in [(1000.0, 0.001), (100.0, 0.01), (5.0, 1.0), (0.1, 1.0), (0.01, 100.0)] {
        let mut character = tube();
        character.body.mesh.positions.iter_mut().for_each(|p| *p *= size);
        let path = folder.path().join("sized.glb");
        write_character(&path, &character, &Appearance::default()).unwrap();
        let found = read_character(&path, RATE).unwrap().metres_per_unit;
        assert!((found / expected - 1.0).abs() < 1e-12, "{size}: {found}");
    }
}

#[test]
fn unindexed_triangles_weld_to_the_same_body() {
    let folder = tempfile::tempdir().unwrap();
    let character = tube();
    let mut split = character.clone();
    split.surface.vertex =
        character.surface.triangles.iter().flatten().map(|&c| character.surface.vertex[c as usize]).collect();
    split.surface.triangles =
        (0..character.surface.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    split.surface.uv = Vec::new();
    split.surface.colour = Vec::new();
    let path = folder.path().join("split.glb");
    write_character(&path, &split, &Appearance::default()).unwrap();
    let path = edit(&path, |json, _| {
        json["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    });
    let read = read_character(&path, RATE).unwrap();
    assert_eq!(read.body.mesh.positions.len(), character.body.mesh.positions.len());
    assert_eq!(read.surface.vertex.len(), 3 * character.body.mesh.triangles.len());
}

/// A second mesh on the tube's joints, with a skin of its own whose bind space is turned and in centimetres.
#[test]
fn a_second_skin_joins_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let path = tube_file(folder.path());
    let plain = read_character(&path, RATE).unwrap();
    let path = edit(&path, |json, bin| {
        let turn = glam::DMat4::from_rotation_x(1.0) * glam::DMat4::from_scale(DVec3::splat(0.01));
        let binds = plain.joints.iter().map(|joint| glam::DMat4::from(joint.inverse_bind) * turn);
        let offset = bin.len();
        bin.extend(binds.flat_map(|m| m.to_cols_array()).flat_map(|x| (x as f32).to_le_bytes()));
        // Three vertices: the tube's triangle at the bottom, seen from the new bind space.
        let ring: Vec<DVec3> =
            (0..3).map(|i| plain.body.mesh.positions[plain.body.mesh.triangles[0][i] as usize]).collect();
        let at = bin.len();
        bin.extend(
            ring.iter()
                .flat_map(|p| turn.inverse().transform_point3(*p).as_vec3().to_array())
                .flat_map(f32::to_le_bytes),
        );
        let rigid = bin.len();
        bin.extend([1u8, 0, 0, 0].repeat(3));
        bin.extend([255u8, 0, 0, 0].repeat(3));
        let views = json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": 6 * 64 }));
        views.push(json!({ "buffer": 0, "byteOffset": at, "byteLength": 36 }));
        views.push(json!({ "buffer": 0, "byteOffset": rigid, "byteLength": 24 }));
        let view = views.len() - 3;
        let accessors = json["accessors"].as_array_mut().unwrap();
        accessors.push(json!({ "bufferView": view, "componentType": 5126, "count": 6, "type": "MAT4" }));
        accessors.push(json!({ "bufferView": view + 1, "componentType": 5126, "count": 3, "type": "VEC3" }));
        accessors.push(json!({ "bufferView": view + 2, "componentType": 5121, "count": 3, "type": "VEC4" }));
        accessors.push(json!({ "bufferView": view + 2, "byteOffset": 12, "componentType": 5121, "normalized": true,
            "count": 3, "type": "VEC4" }));
        let first = accessors.len() - 4;
        json["skins"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "joints": [0, 1, 2, 3, 4, 5], "inverseBindMatrices": first }));
        json["meshes"].as_array_mut().unwrap().push(json!({ "primitives": [{
            "attributes": { "POSITION": first + 1, "JOINTS_0": first + 2, "WEIGHTS_0": first + 3 } }] }));
        json["nodes"].as_array_mut().unwrap().push(json!({ "mesh": 1, "skin": 1 }));
        json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(7));
    });
    let read = read_character(&path, RATE).unwrap();
    assert_eq!(read.body.mesh.triangles.len(), plain.body.mesh.triangles.len() + 1);
    let added = read.body.mesh.triangles[plain.body.mesh.triangles.len()];
    for (corner, before) in added.iter().zip(plain.body.mesh.triangles[0]) {
        let (now, was) = (read.body.mesh.positions[*corner as usize], plain.body.mesh.positions[before as usize]);
        assert!(now.distance(was) < 1e-6, "{now} was {was}");
        assert_eq!(read.body.weights[*corner as usize], vec![(1, 1.0)]);
    }
}

#[test]
fn a_texture_and_vertex_colours_multiply() {
    let folder = tempfile::tempdir().unwrap();
    // One texel, sRGB 188: half of the light.
    let mut png = std::io::Cursor::new(Vec::new());
    let pixel = image::RgbImage::from_pixel(1, 1, image::Rgb([188, 0, 255]));
    pixel.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let path = edit(&tube_file(folder.path()), |json, bin| {
        let views = json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": png.get_ref().len() }));
        // Without mimeType: the bytes tell.
        json["images"] = json!([{ "bufferView": views.len() - 1 }]);
        json["textures"] = json!([{ "source": 0 }]);
        json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0 });
        bin.extend(png.get_ref());
    });
    let [red, green, blue] = read_character(&path, RATE).unwrap().surface.colour[0];
    assert!((red - 0.25 * 0.503).abs() < 1e-3 && green == 0.0 && blue == 0.125, "{red} {green} {blue}");
}
