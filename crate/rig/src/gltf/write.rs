//! Characters and garments as binary glTF 2.0: the JSON is put together as a value (the typed structs of `gltf::json`
//! have no defaults, which tripled this file), the container comes from the `gltf` crate. Positions are f32,
//! metres.

use super::vrm;
use crate::file::write;
use crate::mesh::{bounds, triangle};
use crate::path::local;
use crate::{Character, Clip, Error, Garment, Mesh, Result, SkinWeights, Surface};
use ::gltf::binary::{Glb, Header};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use serde_json::{Value, json};
use std::collections::HashSet;
use std::path::Path;

const F32: u32 = 5126;
const U32: u32 = 5125;
const U16: u32 = 5123;

/// By this a file of ours is known.
pub(super) const GENERATOR: &str = "ctsn";

/// How a surface without colours of its own looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Appearance {
    /// Linear RGB.
    pub colour: [f32; 3],
    /// 0 = mirror, 1 = matt.
    pub roughness: f32,
}

impl Default for Appearance {
    fn default() -> Self {
        Appearance { colour: [0.6, 0.6, 0.62], roughness: 0.85 }
    }
}

/// Writes a character as GLB: the body with its skin, and one animation per clip, sampled at the clip's rate.
///
/// Joints become nodes with translation, rotation and scale; shear in a pose is lost. Named parts become VRM's bones.
/// What is drawn and holds no cloth is a primitive of its own, whose material is named hair. The file's own pose is the
/// canonical one, so a character of 0.1 to 10 m reads back with `metres_per_unit` 1.
pub fn write_character(path: &Path, character: &Character, appearance: &Appearance) -> Result<()> {
    let mut file = Writer::default();
    let primitives =
        file.primitives(&character.body.mesh, &character.surface, appearance, Some(&character.body.weights));
    let binds = character.joints.iter().flat_map(|joint| DMat4::from(joint.inverse_bind).to_cols_array());
    let binds = file.floats("MAT4", 16, binds);
    let rest = local(character, &character.canonical_pose());
    let mut nodes: Vec<Value> = Vec::new();
    for (index, (joint, local)) in character.joints.iter().zip(&rest).enumerate() {
        let (scale, rotation, translation) = local.to_scale_rotation_translation();
        let mut node = json!({
            "name": joint.name,
            "translation": translation.to_array().map(|x| x as f32),
            "rotation": rotation.normalize().to_array().map(|x| x as f32),
            "scale": scale.to_array().map(|x| x as f32),
        });
        let children: Vec<usize> =
            (0..character.joints.len()).filter(|&child| character.joints[child].parent == Some(index)).collect();
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        nodes.push(node);
    }
    let animations: Vec<Value> = character.clips.iter().map(|clip| file.animation(character, clip, &rest)).collect();
    let mut top: Vec<usize> = (0..nodes.len()).filter(|&joint| character.joints[joint].parent.is_none()).collect();
    top.push(nodes.len());
    nodes.push(json!({ "name": "body", "mesh": 0, "skin": 0 }));
    let joints: Vec<usize> = (0..character.joints.len()).collect();
    let mut document = json!({
        "asset": { "version": "2.0", "generator": GENERATOR },
        "scene": 0, "scenes": [{ "nodes": top }], "nodes": nodes,
        "meshes": [{ "name": "body", "primitives": primitives }],
        "skins": [{ "joints": joints, "inverseBindMatrices": binds }],
    });
    if !animations.is_empty() {
        document["animations"] = json!(animations);
    }
    if let Some(bones) = vrm::extension(&character.parts) {
        document["extensionsUsed"] = json!(["VRMC_vrm"]);
        document["extensions"] = json!({ "VRMC_vrm": bones });
    }
    file.save(path, document)
}

/// Writes a garment as GLB, in metres. Its pins become the attribute `_PIN`, 1 or 0 per vertex.
pub fn write_garment(path: &Path, garment: &Garment) -> Result<()> {
    write_cloth(path, garment, GENERATOR)
}

/// The same of a garment that somebody else made: read again, it is no [`Source::own`](super::Source::own).
pub fn write_part(path: &Path, garment: &Garment) -> Result<()> {
    write_cloth(path, garment, "ctsn split")
}

fn write_cloth(path: &Path, garment: &Garment, generator: &str) -> Result<()> {
    let mut file = Writer::default();
    let mut primitives = file.primitives(&garment.mesh, &garment.surface, &Appearance::default(), None);
    if !garment.pins.is_empty() {
        let Garment { mesh, surface, pins, .. } = garment;
        let plain = surface.triangles.is_empty();
        let vertex = if plain { (0..mesh.positions.len() as u32).collect() } else { surface.vertex.clone() };
        let pinned = vertex.iter().map(|at| f64::from(u8::from(pins.contains(at))));
        let pinned = file.floats("SCALAR", 1, pinned);
        for primitive in primitives.as_array_mut().into_iter().flatten() {
            primitive["attributes"]["_PIN"] = json!(pinned);
        }
    }
    let document = json!({
        "asset": { "version": "2.0", "generator": generator },
        "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "name": "garment", "mesh": 0 }],
        "meshes": [{ "name": "garment", "primitives": primitives }],
    });
    file.save(path, document)
}

/// The binary chunk, and the JSON lists that describe it.
#[derive(Default)]
struct Writer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
}

impl Writer {
    /// Appends an accessor with a buffer view of its own. -> its index
    fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: impl Iterator<Item = u8>) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        let length = self.bytes.len() - offset;
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": length }));
        let view = self.views.len() - 1;
        self.accessors.push(json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }));
        self.accessors.len() - 1
    }

    fn floats(&mut self, kind: &str, width: usize, numbers: impl Iterator<Item = f64>) -> usize {
        let numbers: Vec<f32> = numbers.map(|number| number as f32).collect();
        self.accessor(kind, F32, numbers.len() / width, numbers.iter().flat_map(|number| number.to_le_bytes()))
    }

    /// Writes the bounds per component, which the format demands of positions and key times.
    fn state_bounds(&mut self, accessor: usize, points: &[DVec3], width: usize) {
        let [low, high] = bounds(points.iter().map(|point| point.as_vec3().as_dvec3())).map(|corner| corner.as_vec3());
        self.accessors[accessor]["min"] = json!(low.to_array()[..width]);
        self.accessors[accessor]["max"] = json!(high.to_array()[..width]);
    }

    /// The primitives of a mesh: one, and one of what of its surface is not in it. Colours become COLOR_0.
    fn primitives(
        &mut self,
        mesh: &Mesh,
        surface: &Surface,
        appearance: &Appearance,
        weights: Option<&[SkinWeights]>,
    ) -> Value {
        let plain = surface.triangles.is_empty();
        let vertex = if plain { (0..mesh.positions.len() as u32).collect() } else { surface.vertex.clone() };
        let triangles = if plain { &mesh.triangles } else { &surface.triangles };
        let positions: Vec<DVec3> = vertex.iter().map(|&at| mesh.positions[at as usize]).collect();
        let normals = mesh.normals(&mesh.positions);
        let position = self.floats("VEC3", 3, positions.iter().flat_map(|point| point.to_array()));
        self.state_bounds(position, &positions, 3);
        let normal = self.floats("VEC3", 3, vertex.iter().flat_map(|&at| normals[at as usize].to_array()));
        let mut attributes = json!({ "POSITION": position, "NORMAL": normal });
        if !plain && !surface.uv.is_empty() {
            attributes["TEXCOORD_0"] = json!(self.floats("VEC2", 2, surface.uv.iter().flat_map(|uv| uv.to_array())));
        }
        if let Some(weights) = weights {
            self.skin_attributes(&mut attributes, &vertex, weights);
        }
        let painted = !plain && !surface.colour.is_empty();
        if painted {
            let colours = surface.colour.iter().flatten().map(|&channel| f64::from(channel));
            attributes["COLOR_0"] = json!(self.floats("VEC3", 3, colours));
        }
        let [red, green, blue] = if painted { [1.0; 3] } else { appearance.colour };
        let material = json!({ "pbrMetallicRoughness": { "baseColorFactor": [red, green, blue, 1.0],
            "metallicFactor": 0.0, "roughnessFactor": appearance.roughness }, "doubleSided": weights.is_none() });
        let known: HashSet<[u32; 3]> = mesh.triangles.iter().copied().collect();
        let loose = |triangle: &&[u32; 3]| {
            let corners = triangle.map(|corner| vertex[corner as usize]);
            let area = || triangle::area(corners.map(|corner| mesh.positions[corner as usize]));
            weights.is_some() && !known.contains(&corners) && area() > 1e-12
        };
        let (hair, body): (Vec<&[u32; 3]>, Vec<&[u32; 3]>) = triangles.iter().partition(loose);
        let mut primitives = Vec::new();
        for (triangles, name) in [(body, None), (hair, Some("hair"))].into_iter().filter(|(list, _)| !list.is_empty()) {
            let corners = triangles.iter().copied().flatten().flat_map(|corner| corner.to_le_bytes());
            let indices = self.accessor("SCALAR", U32, 3 * triangles.len(), corners);
            let mut material = material.clone();
            name.iter().for_each(|name| material["name"] = json!(name));
            self.materials.push(material);
            let material = self.materials.len() - 1;
            primitives.push(json!({ "attributes": attributes, "indices": indices, "material": material }));
        }
        json!(primitives)
    }

    /// JOINTS_n and WEIGHTS_n, four joints each, as many sets as the richest vertex needs.
    fn skin_attributes(&mut self, attributes: &mut Value, vertex: &[u32], weights: &[SkinWeights]) {
        let most = weights.iter().map(|list| list.len()).max().unwrap_or(0);
        for set in 0..most.div_ceil(4).max(1) {
            let slots = || vertex.iter().flat_map(|&at| (4 * set..4 * set + 4).map(move |slot| (at as usize, slot)));
            let entry = |(at, slot): (usize, usize)| weights[at].get(slot).copied().unwrap_or((0, 0.0));
            let joints = slots().flat_map(|slot| (entry(slot).0 as u16).to_le_bytes());
            attributes[format!("JOINTS_{set}")] = json!(self.accessor("VEC4", U16, vertex.len(), joints));
            attributes[format!("WEIGHTS_{set}")] = json!(self.floats("VEC4", 4, slots().map(|slot| entry(slot).1)));
        }
    }

    /// Joints that stay at `rest` get no channel, except the first, whose channel keeps the clip's length.
    fn animation(&mut self, character: &Character, clip: &Clip, rest: &[DAffine3]) -> Value {
        let times: Vec<DVec3> = (0..clip.poses.len()).map(|frame| DVec3::splat(frame as f64 / clip.rate)).collect();
        let input = self.floats("SCALAR", 1, times.iter().map(|time| time.x));
        self.state_bounds(input, &times, 1);
        let frames: Vec<Vec<DAffine3>> = clip.poses.iter().map(|pose| local(character, pose)).collect();
        let (mut channels, mut samplers) = (Vec::new(), Vec::new());
        for joint in 0..character.joints.len() {
            let keys: Vec<(DVec3, DQuat, DVec3)> =
                frames.iter().map(|frame| frame[joint].to_scale_rotation_translation()).collect();
            let (scale, rotation, translation) = rest[joint].to_scale_rotation_translation();
            let near = |a: DVec3, b: DVec3| a.abs_diff_eq(b, 1e-7);
            let turned = |key: DQuat| key.normalize().dot(rotation.normalize()).abs() < 1.0 - 1e-13;
            let mut add = |path: &str, output: usize| {
                channels.push(json!({ "sampler": samplers.len(), "target": { "node": joint, "path": path } }));
                samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
            };
            if joint == 0 || keys.iter().any(|key| turned(key.1)) {
                let turns = keys.iter().flat_map(|key| key.1.normalize().to_array());
                add("rotation", self.floats("VEC4", 4, turns));
            }
            if keys.iter().any(|key| !near(key.2, translation)) {
                add("translation", self.floats("VEC3", 3, keys.iter().flat_map(|key| key.2.to_array())));
            }
            if keys.iter().any(|key| !near(key.0, scale)) {
                add("scale", self.floats("VEC3", 3, keys.iter().flat_map(|key| key.0.to_array())));
            }
        }
        json!({ "name": clip.name, "channels": channels, "samplers": samplers })
    }

    fn save(mut self, path: &Path, mut document: Value) -> Result<()> {
        document["accessors"] = json!(std::mem::take(&mut self.accessors));
        document["bufferViews"] = json!(std::mem::take(&mut self.views));
        document["materials"] = json!(std::mem::take(&mut self.materials));
        document["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        let header = Header { magic: *b"glTF", version: 2, length: 0 };
        let json = document.to_string().into_bytes().into();
        let glb = Glb { header, json, bin: Some(self.bytes.into()) };
        let bytes = glb.to_vec().map_err(|error| Error::File { path: path.into(), reason: error.to_string() })?;
        write(path, &bytes)
    }
}
