//! Buffer views in the coding of meshoptimizer: EXT_meshopt_compression, and KHR_meshopt_compression, its successor
//! with a newer version of the vertex coding and a filter for colours.

use super::{Container, size};
use crate::gltf::Read;
use meshoptimizer_rs::codec::{self, BufferView, Filter, Mode};
use meshoptimizer_rs::{Error, Workspace};
use serde_json::{Value, json};

const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Whether a buffer without bytes only says how large the unpacked views are together.
pub(super) fn stands_in(buffer: &Value) -> bool {
    NAMES.iter().any(|name| buffer["extensions"].get(name).is_some_and(|part| part["fallback"] == json!(true)))
}

/// Unpacks every compressed view into a buffer of its own.
pub(super) fn unpack(file: &mut Container) -> Read<()> {
    let mut workspace = Workspace::default();
    for index in 0..file.json["bufferViews"].as_array().map_or(0, Vec::len) {
        let view = &file.json["bufferViews"][index];
        let Some(packed) = NAMES.iter().find_map(|name| view["extensions"].get(name)).cloned() else { continue };
        let name = |reason: String| format!("buffer view {index}, compressed by meshopt: {reason}");
        let bytes = decode(&packed, file.slice(&packed).map_err(name)?, &mut workspace)
            .map_err(|error| name(error.to_string()))?;
        let length = bytes.len();
        let buffer = file.add_buffer(bytes);
        let view = &mut file.json["bufferViews"][index];
        (view["buffer"], view["byteOffset"], view["byteLength"]) = (json!(buffer), json!(0), json!(length));
        view["extensions"] = json!({});
    }
    Ok(())
}

/// The plain bytes of a view: `count` elements every `byteStride` bytes.
fn decode(packed: &Value, source: &[u8], workspace: &mut Workspace) -> Result<Vec<u8>, Error> {
    let (count, stride) = (size(packed, "count"), size(packed, "byteStride"));
    let mode = Mode::parse(packed["mode"].as_str().unwrap_or_default())?;
    let filter = packed["filter"].as_str().unwrap_or("NONE");
    if mode != Mode::Attributes {
        return BufferView::new(mode, Filter::parse(filter)?, count, stride)?.decode(source, workspace);
    }
    let mut bytes = codec::decode_vertex_buffer(count, stride, source, workspace)?;
    match filter {
        "COLOR" => codec::decode_filter_color(&mut bytes, count, stride, workspace)?,
        other => match Filter::parse(other)? {
            Filter::None => {}
            Filter::Octahedral => codec::decode_filter_oct(&mut bytes, count, stride, workspace)?,
            Filter::Quaternion => codec::decode_filter_quat(&mut bytes, count, stride, workspace)?,
            Filter::Exponential => codec::decode_filter_exp(&mut bytes, count, stride, workspace)?,
        },
    }
    Ok(bytes)
}
