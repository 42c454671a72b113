//! Primitives in Draco's coding: KHR_draco_mesh_compression. Their accessors get plain bytes.

use super::{Container, size};
use crate::gltf::Read;
use draco_core::{DataType, DecoderBuffer, Mesh, MeshDecoder, PointIndex};
use serde_json::{Value, json};

const NAME: &str = "KHR_draco_mesh_compression";

/// Unpacks every compressed primitive.
pub(super) fn unpack(file: &mut Container) -> Read<()> {
    for mesh in 0..file.json["meshes"].as_array().map_or(0, Vec::len) {
        for at in 0..file.json["meshes"][mesh]["primitives"].as_array().map_or(0, Vec::len) {
            let primitive = file.json["meshes"][mesh]["primitives"][at].clone();
            let Some(packed) = primitive["extensions"].get(NAME) else { continue };
            let name = |reason: String| format!("mesh {mesh}, primitive {at}, compressed by Draco: {reason}");
            let decoded = decode(file, packed).map_err(name)?;
            place(file, &primitive, packed, &decoded).map_err(name)?;
            // Draco keeps lists of triangles, whatever the primitive was before.
            file.json["meshes"][mesh]["primitives"][at]["mode"] = json!(4);
        }
    }
    Ok(())
}

fn decode(file: &Container, packed: &Value) -> Read<Mesh> {
    let bytes = file.slice(&file.json["bufferViews"][size(packed, "bufferView")])?;
    let mut mesh = Mesh::new();
    let decoded = MeshDecoder::new().decode(&mut DecoderBuffer::new(bytes), &mut mesh);
    decoded.map(|()| mesh).map_err(|error| error.to_string())
}

/// Gives the accessors of a primitive the decoded numbers.
fn place(file: &mut Container, primitive: &Value, packed: &Value, mesh: &Mesh) -> Read<()> {
    let (points, attributes) = (mesh.num_points(), packed["attributes"].as_object());
    for (name, id) in attributes.into_iter().flatten() {
        let wanted = id.as_u64().and_then(|id| mesh.attribute_by_unique_id(id as u32));
        let attribute = wanted.ok_or_else(|| format!("{name}: wanted its attribute {id}, found none"))?;
        let component = match attribute.data_type() {
            DataType::Int8 => 5120,
            DataType::Uint8 => 5121,
            DataType::Int16 => 5122,
            DataType::Uint16 => 5123,
            DataType::Uint32 => 5125,
            DataType::Float32 => 5126,
            other => return Err(format!("{name}: wanted numbers that glTF has, found {other:?}")),
        };
        let width = attribute.data_type().byte_length() * usize::from(attribute.num_components());
        let mut bytes = vec![0; points * width];
        for (point, element) in bytes.chunks_exact_mut(width.max(1)).enumerate() {
            let value = attribute.mapped_index(PointIndex(point as u32)).0 as usize;
            let stored = value.checked_mul(width).and_then(|from| attribute.buffer().data().get(from..)?.get(..width));
            element.copy_from_slice(stored.ok_or_else(|| format!("{name}: vertex {point} has no value"))?);
        }
        accessor(file, &primitive["attributes"][name], bytes, points, component)?;
    }
    let corners = mesh.faces().iter().flatten().flat_map(|corner| corner.0.to_le_bytes()).collect();
    accessor(file, &primitive["indices"], corners, 3 * mesh.num_faces(), 5125)
}

/// Sets what an accessor reads: tightly packed elements.
fn accessor(file: &mut Container, index: &Value, bytes: Vec<u8>, count: usize, component: u32) -> Read<()> {
    let length = bytes.len();
    let buffer = file.add_buffer(bytes);
    let views = file.json["bufferViews"].as_array_mut().ok_or("there are no buffer views")?;
    views.push(json!({ "buffer": buffer, "byteLength": length.max(1) }));
    let view = views.len() - 1;
    let wanted = index.as_u64().and_then(|index| file.json["accessors"].get_mut(index as usize));
    let accessor = wanted.filter(|accessor| accessor.is_object());
    let accessor = accessor.ok_or_else(|| format!("wanted an accessor, found {index}"))?;
    accessor["bufferView"] = json!(view);
    (accessor["byteOffset"], accessor["count"], accessor["componentType"]) = (json!(0), json!(count), json!(component));
    Ok(())
}
