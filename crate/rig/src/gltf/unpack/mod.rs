//! A file's JSON and buffers, with what extensions compress unpacked: after this every buffer view holds plain bytes,
//! and nothing else knows that the file was compressed. glTF 2.0 §3.6.1, §4 (GLB).

mod draco;
mod meshopt;

use super::Read;
use super::file::check_uri;
use ::gltf::Glb;
use ::gltf::buffer::{Data, Source};
use serde_json::{Value, json};
use std::path::Path;

/// Required extensions that change only how a surface looks, that say more of a character or what of it is shown, or
/// that are unpacked here.
const UNDERSTOOD: [&str; 12] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_mesh_quantization",
    "KHR_lights_punctual",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_draco_mesh_compression",
    "VRM",
    "VRMC_",
    "KHR_node_visibility",
];

/// A file's JSON with the bytes of its buffers.
pub(super) struct Container {
    pub json: Value,
    pub buffers: Vec<Vec<u8>>,
}

impl Container {
    /// Reads the buffers that the JSON names and unpacks them. `folder`: where the file is.
    pub fn read(bytes: &[u8], folder: &Path) -> Read<Container> {
        let (json, chunk) = split(bytes)?;
        let mut file = Container { json, buffers: Vec::new() };
        file.refuse_unknown()?;
        file.read_buffers(folder, chunk)?;
        meshopt::unpack(&mut file)?;
        draco::unpack(&mut file)?;
        file.place_textures();
        Ok(file)
    }

    fn refuse_unknown(&mut self) -> Read<()> {
        let required = list(&self.json, "extensionsRequired");
        let names = required.iter().filter_map(Value::as_str);
        let unknown: Vec<&str> = names.filter(|name| !UNDERSTOOD.iter().any(|known| name.starts_with(known))).collect();
        if !unknown.is_empty() {
            let wanted = unknown.join(", ");
            return Err(format!("needs glTF extensions that are not supported: {wanted}; export without them"));
        }
        if let Some(file) = self.json.as_object_mut() {
            file.remove("extensionsRequired");
        }
        Ok(())
    }

    /// The bytes of every buffer. One that only stands for what compressed views become has none.
    fn read_buffers(&mut self, folder: &Path, mut chunk: Option<Vec<u8>>) -> Read<()> {
        for (index, buffer) in list(&self.json, "buffers").iter().enumerate() {
            let name = |reason: String| format!("buffer {index}: its bytes cannot be read: {reason}");
            let bytes = match buffer["uri"].as_str() {
                Some(uri) => {
                    check_uri(uri)?;
                    let data = Data::from_source(Source::Uri(uri), Some(folder));
                    data.map_err(|error| name(format!("{uri}: {error}")))?.0
                }
                None if meshopt::stands_in(buffer) => Vec::new(),
                None => chunk.take().ok_or_else(|| name("wanted a URI or a binary chunk, found neither".into()))?,
            };
            let wanted = if meshopt::stands_in(buffer) { 0 } else { size(buffer, "byteLength") };
            if bytes.len() < wanted {
                return Err(name(format!("wanted {wanted} bytes, found {}", bytes.len())));
            }
            self.buffers.push(bytes);
        }
        Ok(())
    }

    /// The bytes that an object with `buffer`, `byteOffset` and `byteLength` names.
    fn slice(&self, view: &Value) -> Read<&[u8]> {
        let (offset, length) = (size(view, "byteOffset"), size(view, "byteLength"));
        let bytes = self.buffers.get(size(view, "buffer")).map_or(&[][..], Vec::as_slice);
        let found = offset.checked_add(length).and_then(|end| bytes.get(offset..end));
        found.ok_or_else(|| format!("wanted {length} bytes from byte {offset} on, found {} in all", bytes.len()))
    }

    /// Adds a buffer. -> its index
    fn add_buffer(&mut self, bytes: Vec<u8>) -> usize {
        // What a file names `buffers` may be no list; then nothing in it can be found later, and that is said.
        if let Some(buffers) = self.json["buffers"].as_array_mut() {
            buffers.push(json!({ "byteLength": bytes.len() }));
        }
        self.buffers.push(bytes);
        self.buffers.len() - 1
    }

    /// Textures whose picture only an extension names (webp, ktx2, avif) get it as their own: the `gltf` crate wants
    /// one of every texture. A picture that cannot be decoded counts as white.
    fn place_textures(&mut self) {
        let mut images = list(&self.json, "images");
        let white = images.len();
        let mut textures = list(&self.json, "textures");
        for texture in textures.iter_mut().filter(|texture| texture["source"].is_null() && texture.is_object()) {
            let named = texture["extensions"].as_object().into_iter().flat_map(|all| all.values());
            let source = named.filter_map(|extension| extension["source"].as_u64()).next();
            texture["source"] = json!(source.unwrap_or(white as u64));
        }
        if textures.iter().any(|texture| texture["source"] == json!(white)) {
            images.push(json!({ "uri": "data:," }));
            self.json["images"] = json!(images);
        }
        if !textures.is_empty() {
            self.json["textures"] = json!(textures);
        }
    }
}

/// The JSON of a file, and the binary chunk of a GLB. Checks the stated length of a GLB first: the `gltf` crate
/// subtracts its header from that.
pub(super) fn split(bytes: &[u8]) -> Read<(Value, Option<Vec<u8>>)> {
    let refuse = |error: &dyn std::fmt::Display| format!("not a glTF: {error}");
    if let Some(header) = bytes.strip_prefix(b"glTF") {
        let stated = header.get(4..8).map(|length| length.iter().rev().fold(0, |sum, &byte| sum << 8 | byte as usize));
        if stated.is_none_or(|length| length < 12 || length > bytes.len()) {
            let stated = stated.map_or("no length".to_string(), |length| format!("{length} bytes"));
            return Err(format!("a truncated GLB: its header states {stated}, the file has {} bytes", bytes.len()));
        }
        let glb = Glb::from_slice(bytes).map_err(|error| refuse(&error))?;
        let json = serde_json::from_slice(&glb.json).map_err(|error| refuse(&error))?;
        return Ok((json, glb.bin.map(|chunk| chunk.into_owned())));
    }
    if bytes.iter().find(|byte| !byte.is_ascii_whitespace()) != Some(&b'{') {
        return Err("not a glTF: it starts neither with the GLB header `glTF` nor with a JSON object".to_string());
    }
    Ok((serde_json::from_slice(bytes).map_err(|error| refuse(&error))?, None))
}

/// A list of the JSON; empty where there is none.
pub(super) fn list(json: &Value, key: &str) -> Vec<Value> {
    json[key].as_array().cloned().unwrap_or_default()
}

/// A whole number of the JSON; 0 where there is none.
pub(super) fn size(json: &Value, key: &str) -> usize {
    json[key].as_u64().map_or(0, |number| usize::try_from(number).unwrap_or(usize::MAX))
}
