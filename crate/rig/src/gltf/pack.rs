//! A GLB made small: what its accessors hold becomes whole numbers in the coding of meshoptimizer, and all clips share
//! a few streams (EXT_meshopt_compression, KHR_mesh_quantization). `unpack/meshopt.rs` reads it, and three.js with its
//! MeshoptDecoder.

mod kept;

use super::Read;
use super::unpack::{list, size, split};
use crate::file::{read, write};
use crate::{Error, Result};
use ::gltf::binary::{Glb, Header};
use kept::{Kept, keep, plain};
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{self, IndexEncoding, VertexEncoding};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

const CODING: &str = "EXT_meshopt_compression";

/// Packs the GLB at `path` and writes it to `output`.
///
/// # Errors
/// The file is no GLB with one buffer, or it is packed already.
pub fn pack(path: &Path, output: &Path) -> Result<()> {
    let packed = packed(&read(path)?).map_err(|reason| Error::File { path: path.into(), reason })?;
    write(output, &packed)
}

fn packed(bytes: &[u8]) -> Read<Vec<u8>> {
    let (mut json, bin) = split(bytes)?;
    let bin = bin.ok_or("wanted a GLB with a binary chunk, found none")?;
    if list(&json, "buffers").len() != 1 || !list(&json, "extensionsRequired").is_empty() {
        return Err("wanted one buffer and no required extension; is it packed already?".to_owned());
    }
    let mut out = Output::default();
    let (roles, accessors, views) = (roles(&json), list(&json, "accessors"), list(&json, "bufferViews"));
    let mut places = BTreeMap::new();
    let mut streams: BTreeMap<&str, (Vec<usize>, Vec<Kept>)> = BTreeMap::new();
    for (index, accessor) in accessors.iter().enumerate() {
        let Some(role) = roles.get(&index) else { continue };
        let Some(kept) = plain(&bin, accessor, &views).and_then(|bytes| keep(role, accessor, &bytes)) else { continue };
        let stream = streams.entry(if role.starts_with('.') { role } else { "" }).or_default();
        stream.0.push(index);
        stream.1.push(kept);
    }
    for (name, (indices, kept)) in streams {
        let alone = name.is_empty();
        let groups: Vec<(&[usize], &[Kept])> =
            if alone { indices.chunks(1).zip(kept.chunks(1)).collect() } else { vec![(&indices, &kept)] };
        for (indices, kept) in groups {
            out.add(indices, kept, alone, &mut places)?;
        }
    }
    out.leave_others(&mut json, &bin, &views, &places);
    out.finish(json, &accessors, &places)
}

/// What the accessors are for: the name of an attribute, `indices`, or what an animation moves, with a dot before it.
fn roles(json: &Value) -> BTreeMap<usize, String> {
    let mut roles = BTreeMap::new();
    let mut note = |accessor: &Value, role: &str| {
        if let Some(index) = accessor.as_u64() {
            // An accessor that is two things stays as it is.
            let before = roles.insert(index as usize, role.to_owned());
            if before.is_some_and(|before| before != role) {
                roles.insert(index as usize, "several".to_owned());
            }
        }
    };
    for mesh in list(json, "meshes") {
        for primitive in list(&mesh, "primitives") {
            let triangles = primitive["mode"].as_u64().unwrap_or(4) == 4;
            note(&primitive["indices"], if triangles { "indices" } else { "several" });
            for (name, accessor) in primitive["attributes"].as_object().into_iter().flatten() {
                note(accessor, name);
            }
        }
    }
    for animation in list(json, "animations") {
        for channel in list(&animation, "channels") {
            let sampler = &animation["samplers"][size(&channel, "sampler")];
            note(&sampler["input"], ".time");
            let path = channel["target"]["path"].as_str().unwrap_or_default();
            // Of a cubic spline two of three are tangents, of any length.
            let curved = sampler["interpolation"] == "CUBICSPLINE";
            note(&sampler["output"], &if curved { "several".to_owned() } else { format!(".{path}") });
        }
    }
    roles
}

/// The new file's binary chunk and views, and the bytes that the views are unpacked to.
#[derive(Default)]
struct Output {
    bin: Vec<u8>,
    views: Vec<Value>,
    unpacked: usize,
}

impl Output {
    /// A compressed view of what these accessors hold, one behind the other: of a mesh, or what animates. Notes where:
    /// view, offset, how.
    fn add(&mut self, indices: &[usize], kept: &[Kept], of_mesh: bool, places: &mut Places) -> Read<()> {
        let Kept { stride, mode, filter, .. } = kept[0];
        let mut workspace = Workspace::default();
        let bytes: Vec<u8> = kept.iter().flat_map(|part| &part.bytes).copied().collect();
        let (count, coded) = if mode == "TRIANGLES" {
            let corners: Vec<u32> = bytes.as_chunks::<4>().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
            let coded =
                IndexEncoding::new(1).and_then(|coding| codec::encode_index_buffer(&corners, coding, &mut workspace));
            (corners.len(), coded)
        } else {
            let count = bytes.len() / stride;
            let coding = VertexEncoding::new(0, 2);
            (
                count,
                coding.and_then(|coding| codec::encode_vertex_buffer(&bytes, count, stride, coding, &mut workspace)),
            )
        };
        let coded = coded.map_err(|error| error.to_string())?;
        let mut view = json!({ "buffer": 1, "byteOffset": self.unpacked, "byteLength": count * stride,
            "extensions": { CODING: { "buffer": 0, "byteOffset": self.bin.len(), "byteLength": coded.len(),
                "byteStride": stride, "count": count, "mode": mode, "filter": filter } } });
        // Of vertices the format wants the stride where elements are padded; of what animates it forbids it.
        if mode == "ATTRIBUTES" && of_mesh {
            view["byteStride"] = json!(stride);
        }
        let mut offset = 0;
        for (index, part) in indices.iter().zip(kept) {
            places.insert(*index, (self.views.len(), offset, (part.component, part.normalized)));
            offset += part.bytes.len();
        }
        self.unpacked = (self.unpacked + count * stride).next_multiple_of(4);
        self.append(&coded);
        self.views.push(view);
        Ok(())
    }

    fn append(&mut self, bytes: &[u8]) {
        self.bin.extend(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
    }

    /// Copies the views that something else than a packed accessor needs.
    fn leave_others(&mut self, json: &mut Value, bin: &[u8], views: &[Value], places: &Places) {
        let mut moved = BTreeMap::new();
        for (index, accessor) in list(json, "accessors").iter().enumerate() {
            if !places.contains_key(&index) {
                needed(accessor, &mut moved);
            }
        }
        list(json, "images").iter().for_each(|image| needed(image, &mut moved));
        for (old, new) in &mut moved {
            let Some(view) = views.get(*old) else { continue };
            let (from, length) = (size(view, "byteOffset"), size(view, "byteLength"));
            let mut copy = view.clone();
            copy["byteOffset"] = json!(self.bin.len());
            *new = self.views.len();
            self.append(bin.get(from..from.saturating_add(length)).unwrap_or_default());
            self.views.push(copy);
        }
        for part in ["images", "accessors"] {
            json.get_mut(part).into_iter().for_each(|part| rename(part, &moved));
        }
    }

    fn finish(mut self, mut json: Value, accessors: &[Value], places: &Places) -> Read<Vec<u8>> {
        for (index, (view, offset, (component, normalized))) in places {
            let mut accessor = accessors[*index].clone();
            (accessor["bufferView"], accessor["componentType"]) = (json!(view), json!(component));
            if *offset > 0 {
                accessor["byteOffset"] = json!(offset);
            }
            if *normalized {
                accessor["normalized"] = json!(true);
            }
            json["accessors"][*index] = accessor;
        }
        // What is the default of the format need not be said a thousand times.
        for animation in json.get_mut("animations").and_then(Value::as_array_mut).into_iter().flatten() {
            let samplers = animation.get_mut("samplers").and_then(Value::as_array_mut).into_iter().flatten();
            for sampler in samplers.filter_map(Value::as_object_mut) {
                if sampler.get("interpolation") == Some(&json!("LINEAR")) {
                    sampler.remove("interpolation");
                }
            }
        }
        json["bufferViews"] = json!(std::mem::take(&mut self.views));
        let unpacked = json!({ "byteLength": self.unpacked, "extensions": { CODING: { "fallback": true } } });
        json["buffers"] = json!([{ "byteLength": self.bin.len() }, unpacked]);
        json["extensionsRequired"] = json!([CODING, "KHR_mesh_quantization"]);
        let mut used = list(&json, "extensionsUsed");
        used.extend([json!(CODING), json!("KHR_mesh_quantization")]);
        json["extensionsUsed"] = json!(used);
        let header = Header { magic: *b"glTF", version: 2, length: 0 };
        let glb = Glb { header, json: json.to_string().into_bytes().into(), bin: Some(self.bin.into()) };
        glb.to_vec().map_err(|error| error.to_string())
    }
}

/// By accessor: its view, where in it, its component type and whether it is normalized.
type Places = BTreeMap<usize, (usize, usize, (u32, bool))>;

/// Notes every view that is named in `value`.
fn needed(value: &Value, views: &mut BTreeMap<usize, usize>) {
    match value {
        Value::Object(object) => {
            views.extend(object.get("bufferView").and_then(Value::as_u64).map(|view| (view as usize, 0)));
            object.values().for_each(|value| needed(value, views));
        }
        Value::Array(values) => values.iter().for_each(|value| needed(value, views)),
        _ => {}
    }
}

/// Gives views that are named in `value` their new numbers.
fn rename(value: &mut Value, views: &BTreeMap<usize, usize>) {
    match value {
        Value::Object(object) => {
            if let Some(view) = object.get_mut("bufferView")
                && let Some(new) = view.as_u64().and_then(|view| views.get(&(view as usize)))
            {
                *view = json!(new);
            }
            object.values_mut().for_each(|value| rename(value, views));
        }
        Value::Array(values) => values.iter_mut().for_each(|value| rename(value, views)),
        _ => {}
    }
}
