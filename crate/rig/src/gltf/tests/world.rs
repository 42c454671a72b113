//! A second, independent evaluation of skinning in a file's own world: with the `gltf` crate's readers, recursion over
//! nodes and no canonical space. What we read must agree with it, times the scale.

use super::{RATE, edit, tube_file};
use crate::Character;
use crate::gltf::read_character;
use ::gltf::animation::Property;
use ::gltf::animation::util::ReadOutputs;
use ::gltf::buffer::Data;
use ::gltf::{Document, Node};
use glam::{DMat4, DQuat, DVec3, DVec4};
use serde_json::json;
use std::collections::HashMap;
use std::path::Path;

/// Local T, R, S of a node.
type Trs = (DVec3, DQuat, DVec3);

/// Corners of all triangles of skinned meshes, file units, in file order: [3 · triangles].
fn world_corners(document: &Document, buffers: &[Data], locals: &HashMap<usize, DMat4>) -> Vec<DVec3> {
    let mut world = HashMap::new();
    let is_child: Vec<usize> =
        document.nodes().flat_map(|n| n.children().map(|c| c.index()).collect::<Vec<_>>()).collect();
    document
        .nodes()
        .filter(|node| !is_child.contains(&node.index()))
        .for_each(|node| walk(&node, DMat4::IDENTITY, locals, &mut world));
    let mut corners = Vec::new();
    for node in document.nodes() {
        let (Some(mesh), Some(skin)) = (node.mesh(), node.skin()) else { continue };
        let binds = skin.reader(|buffer| Some(&buffers[buffer.index()])).read_inverse_bind_matrices().unwrap();
        let binds: Vec<DMat4> = binds.map(|m| DMat4::from_cols_array_2d(&m.map(|c| c.map(f64::from)))).collect();
        let matrices: Vec<DMat4> =
            skin.joints().zip(&binds).map(|(joint, bind)| world[&joint.index()] * *bind).collect();
        for primitive in mesh.primitives() {
            let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
            let points: Vec<DVec4> =
                reader.read_positions().unwrap().map(|p| DVec3::from(p.map(f64::from)).extend(1.0)).collect();
            let mut posed = vec![DVec4::ZERO; points.len()];
            for set in 0.. {
                let (Some(joints), Some(weights)) = (reader.read_joints(set), reader.read_weights(set)) else { break };
                for (at, (joints, weights)) in joints.into_u16().zip(weights.into_f32()).enumerate() {
                    for (joint, weight) in joints.iter().zip(weights) {
                        posed[at] += matrices[usize::from(*joint)] * points[at] * f64::from(weight);
                    }
                }
            }
            let posed: Vec<DVec3> = posed.iter().map(|p| p.truncate() / p.w).collect();
            match reader.read_indices() {
                Some(indices) => corners.extend(indices.into_u32().map(|index| posed[index as usize])),
                None => corners.extend(posed),
            }
        }
    }
    corners
}

fn walk(node: &Node, above: DMat4, locals: &HashMap<usize, DMat4>, world: &mut HashMap<usize, DMat4>) {
    let here = above * locals[&node.index()];
    world.insert(node.index(), here);
    node.children().for_each(|child| walk(&child, here, locals, world));
}

fn trs((translation, rotation, scale): &Trs) -> DMat4 {
    DMat4::from_scale_rotation_translation(*scale, *rotation, *translation)
}

fn rest_locals(document: &Document) -> HashMap<usize, DMat4> {
    let local = |node: &Node| DMat4::from_cols_array_2d(&node.transform().matrix().map(|c| c.map(f64::from)));
    document.nodes().map(|node| (node.index(), local(&node))).collect()
}

/// Local matrices at a time; linear samplers only.
fn locals_at(document: &Document, buffers: &[Data], clip: usize, time: f64) -> HashMap<usize, DMat4> {
    let mut parts: HashMap<usize, Trs> = HashMap::new();
    for node in document.nodes() {
        let (t, r, s) = node.transform().decomposed();
        let whole = (
            DVec3::from(t.map(f64::from)),
            DQuat::from_array(r.map(f64::from)).normalize(),
            DVec3::from(s.map(f64::from)),
        );
        parts.insert(node.index(), whole);
    }
    for channel in document.animations().nth(clip).unwrap().channels() {
        let reader = channel.reader(|buffer| Some(&buffers[buffer.index()]));
        let times: Vec<f64> = reader.read_inputs().unwrap().map(f64::from).collect();
        let (mut key, mut share) = (0, 0.0);
        while key + 1 < times.len() && times[key + 1] <= time {
            key += 1;
        }
        if key + 1 < times.len() && time > times[key] {
            share = (time - times[key]) / (times[key + 1] - times[key]);
        }
        let next = (key + 1).min(times.len() - 1);
        let mix = |values: Vec<[f32; 3]>| {
            DVec3::from(values[key].map(f64::from)).lerp(DVec3::from(values[next].map(f64::from)), share)
        };
        let target = parts.get_mut(&channel.target().node().index()).unwrap();
        match (reader.read_outputs().unwrap(), channel.target().property()) {
            (ReadOutputs::Translations(values), _) => target.0 = mix(values.collect()),
            (ReadOutputs::Scales(values), Property::Scale) => target.2 = mix(values.collect()),
            (ReadOutputs::Rotations(values), _) => {
                let values: Vec<DQuat> =
                    values.into_f32().map(|q| DQuat::from_array(q.map(f64::from)).normalize()).collect();
                target.1 = values[key].slerp(values[next], share);
            }
            _ => {}
        }
    }
    parts.iter().map(|(node, local)| (*node, trs(local))).collect()
}

/// Largest distance, metres, between our posed corners and the file's own, over every `step`-th frame of each clip and
/// the canonical pose.
fn largest_difference(path: &Path, rate: f64, step: usize) -> (Character, f64) {
    let character = read_character(path, rate).unwrap();
    let (document, buffers, _) = ::gltf::import(path).unwrap();
    let corner = |corner: &u32| character.surface.vertex[*corner as usize] as usize;
    let drawn: Vec<usize> = character.surface.triangles.iter().flatten().map(corner).collect();
    let compare = |ours: &[DVec3], theirs: &[DVec3]| {
        assert_eq!(drawn.len(), theirs.len());
        let distance = |(&at, p): (&usize, &DVec3)| ours[at].distance(*p * character.metres_per_unit);
        drawn.iter().zip(theirs).map(distance).fold(0.0, f64::max)
    };
    let canonical = character.pose_body(&character.canonical_pose());
    let mut worst =
        canonical.iter().zip(&character.body.mesh.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    assert!(worst < 1e-9, "the canonical pose must leave the body where it is: {worst} m");
    for (index, clip) in character.clips.iter().enumerate() {
        let animation = document.animations().nth(index).unwrap();
        let first = |channel: ::gltf::animation::Channel| {
            let reader = channel.reader(|buffer| Some(&buffers[buffer.index()]));
            reader.read_inputs().unwrap().next().unwrap()
        };
        let start = animation.channels().map(first).fold(f32::INFINITY, f32::min);
        for frame in (0..clip.poses.len()).step_by(step) {
            let time = f64::from(start) + frame as f64 / rate;
            let theirs = world_corners(&document, &buffers, &locals_at(&document, &buffers, index, time));
            worst = worst.max(compare(&character.pose_body(&clip.poses[frame]), &theirs));
        }
    }
    (character, worst)
}

#[test]
fn posed_bodies_equal_the_files_own_skinning() {
    let folder = tempfile::tempdir().unwrap();
    let path = tube_file(folder.path());
    // At 7 poses per second, frames fall between the keys.
    let (_, worst) = largest_difference(&path, 7.0, 1);
    assert!(worst < 1e-6, "{worst} m");
}

#[test]
fn an_armature_that_scales_and_turns_is_folded_in() {
    let folder = tempfile::tempdir().unwrap();
    let path = tube_file(folder.path());
    let plain = read_character(&path, RATE).unwrap();
    let path = edit(&path, |json, _| {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let nodes = json["nodes"].as_array_mut().unwrap();
        nodes.push(
            json!({ "name": "Armature", "children": [0], "scale": [100, 100, 100], "rotation": [half, 0, 0, half] }),
        );
        json["scenes"][0]["nodes"] = json!([nodes.len() - 1, nodes.len() - 2]);
    });
    let (character, worst) = largest_difference(&path, RATE, 1);
    assert!(worst < 1e-6, "{worst} m");
    assert_eq!(character.metres_per_unit, 0.01);
    let turned = plain.body.mesh.positions.iter().zip(&character.body.mesh.positions);
    for (before, after) in turned {
        assert!(after.distance(DVec3::new(before.x, -before.z, before.y)) < 1e-6, "{before} became {after}");
    }
}

#[test]
fn a_default_pose_that_is_not_the_bind_pose_keeps_the_body_upright() {
    let folder = tempfile::tempdir().unwrap();
    let path = edit(&tube_file(folder.path()), |json, _| {
        json["nodes"][2]["rotation"] = json!([0.0, 0.0, 0.5, 0.75f64.sqrt()]);
    });
    let (character, worst) = largest_difference(&path, RATE, 1);
    assert!(worst < 1e-6, "{worst} m");
    let reference = super::tube();
    let farthest = character
        .body
        .mesh
        .positions
        .iter()
        .map(|p| reference.body.mesh.positions.iter().map(|q| p.distance(*q)).fold(f64::INFINITY, f64::min));
    assert!(farthest.fold(0.0, f64::max) < 1e-6, "the canonical body is the bound one, not the bent one");
}

/// `CTSN_CHARACTERS=a.glb:b.glb cargo test --release -p ctsn-rig -- --ignored foreign`
#[test]
#[ignore = "needs characters from outside: CTSN_CHARACTERS=a.glb:b.glb"]
fn foreign_characters_pose_as_in_their_files() {
    let paths = std::env::var("CTSN_CHARACTERS").expect("CTSN_CHARACTERS: paths separated by colons");
    for path in paths.split(':').map(Path::new) {
        let (character, worst) = largest_difference(path, 30.0, 25);
        let (document, buffers, _) = ::gltf::import(path).unwrap();
        let rest = world_corners(&document, &buffers, &rest_locals(&document));
        println!(
            "{}: {} joints, hip {}, {} welded of {} drawn vertices, {} of {} triangles, {} m per unit, clips {:?}, worst {worst:.2e} m, {} corners at rest",
            path.display(),
            character.joints.len(),
            character.joints[character.root].name,
            character.body.mesh.positions.len(),
            character.surface.vertex.len(),
            character.body.mesh.triangles.len(),
            character.surface.triangles.len(),
            character.metres_per_unit,
            character.clips.iter().map(|clip| (clip.name.as_str(), clip.poses.len())).collect::<Vec<_>>(),
            rest.len(),
        );
        // The files' f32 matrices and weights that sum to one only in f32 leave this much.
        assert!(worst < 2e-5, "{}: {worst} m", path.display());
    }
}
