//! A glTF file in memory. Accessors are decoded here, not by the `gltf` crate's readers: those trust type, stride and
//! count, and panic on files that lie about them. glTF 2.0 §3.6 (buffers), §3.6.2.3 (sparse), §3.6.2.2 (normalised).

use super::unpack::Container;
use super::{Read, vrm};
use crate::Error;
use ::gltf::accessor::{DataType, Dimensions, sparse::IndexType};
use ::gltf::buffer::{self, Data, View};
use ::gltf::json::Root;
use ::gltf::json::animation::VALID_PROPERTIES;
use ::gltf::json::image::MimeType;
use ::gltf::json::validation::Checked;
use ::gltf::{Accessor, Document, Semantic};
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};

/// Most components one accessor may hold: 2^27 f64 are 1 GiB, far more than any character needs.
const MOST_COMPONENTS: usize = 1 << 27;

/// A parsed file: its document, and the bytes its buffers hold.
pub(super) struct File {
    pub document: Document,
    /// Accessor of `_PIN` by mesh and primitive: the `gltf` crate drops the attributes it does not know.
    pub pins: BTreeMap<(usize, usize), usize>,
    /// Nodes that are not shown, nor what is below them (KHR_node_visibility).
    pub hidden: HashSet<usize>,
    /// Node of each part of a body that the file names, see [`super::vrm`].
    pub parts: BTreeMap<String, usize>,
    buffers: Vec<Vec<u8>>,
    folder: PathBuf,
}

impl File {
    /// Reads and validates a `.glb` or `.gltf`, with the buffers it names.
    pub fn open(path: &Path) -> crate::Result<File> {
        let bytes = crate::file::read(path)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        File::parse(&bytes, folder).map_err(|reason| Error::File { path: path.into(), reason })
    }

    pub fn parse(bytes: &[u8], folder: PathBuf) -> Read<File> {
        let Container { mut json, buffers } = Container::read(bytes, &folder)?;
        drop_channels_without_node(&mut json);
        say_what_zeros_are(&mut json);
        let (pins, hidden, parts) = (pins(&json), hidden(&json), vrm::parts(&json));
        let mut json: Root = serde_json::from_value(json).map_err(|error| format!("not a glTF: {error}"))?;
        mend(&mut json)?;
        let document = Document::from_json(json).map_err(|error| format!("not a valid glTF: {error}"))?;
        Ok(File { document, pins, hidden, parts, buffers, folder })
    }

    /// All components of an accessor, finite; normalised integers are mapped to [0, 1] or [-1, 1]. `what` names the
    /// accessor in messages. -> [count · components of `wanted`]
    pub fn components(&self, accessor: &Accessor, wanted: Dimensions, what: &str) -> Read<Vec<f64>> {
        let name = format!("{what} (accessor {})", accessor.index());
        if accessor.dimensions() != wanted {
            return Err(format!("{name}: wanted {wanted:?}, found {:?}", accessor.dimensions()));
        }
        let (count, width, kind) = (accessor.count(), wanted.multiplicity(), accessor.data_type());
        if count.checked_mul(width).is_none_or(|total| total > MOST_COMPONENTS) {
            return Err(format!("{name}: {count} elements are more than the {MOST_COMPONENTS} components allowed"));
        }
        let mut values = match accessor.view() {
            Some(view) => self.decode(&view, accessor.offset(), count, width, kind),
            None => Ok(vec![0.0; count * width]),
        }
        .map_err(|reason| format!("{name}: {reason}"))?;
        if let Some(sparse) = accessor.sparse() {
            let (at, to) = (sparse.indices(), sparse.values());
            let index_kind = match at.index_type() {
                IndexType::U8 => DataType::U8,
                IndexType::U16 => DataType::U16,
                IndexType::U32 => DataType::U32,
            };
            let sparse_error = |reason| format!("{name}, its sparse part: {reason}");
            let changed = self.decode(&at.view(), at.offset(), sparse.count(), 1, index_kind).map_err(sparse_error)?;
            let fresh = self.decode(&to.view(), to.offset(), sparse.count(), width, kind).map_err(sparse_error)?;
            for (index, element) in changed.iter().map(|&index| index as usize).zip(fresh.chunks_exact(width)) {
                let range = index * width..index * width + width;
                let slot = values.get_mut(range).ok_or_else(|| sparse_error(format!("index {index} of {count}")))?;
                slot.copy_from_slice(element);
            }
        }
        if accessor.normalized() {
            let (scale, lowest) = normalisation(kind);
            values.iter_mut().for_each(|value| *value = (*value * scale).max(lowest));
        }
        match values.iter().position(|value| !value.is_finite()) {
            Some(at) => Err(format!("{name}: element {} is {}, wanted a finite number", at / width, values[at])),
            None => Ok(values),
        }
    }

    /// Raw elements of a buffer view. -> [count · width]
    fn decode(&self, view: &View, offset: usize, count: usize, width: usize, kind: DataType) -> Read<Vec<f64>> {
        let bytes = self.view(view)?;
        let size = width * kind.size();
        let stride = view.stride().unwrap_or(size);
        let end = match count {
            0 => Some(offset),
            _ => stride.checked_mul(count - 1).and_then(|s| s.checked_add(size)).and_then(|s| s.checked_add(offset)),
        };
        if stride < size || end.is_none_or(|end| end > bytes.len()) {
            let found = bytes.len();
            let wanted = format!("wanted {count} elements of {size} bytes every {stride} bytes from byte {offset} on");
            return Err(format!("{wanted}, found {found} bytes"));
        }
        let element = |i: usize| bytes[offset + i * stride..][..size].chunks_exact(kind.size());
        Ok((0..count).flat_map(element).map(|component| number(component, kind)).collect())
    }

    /// The bytes of a buffer view.
    pub fn view(&self, view: &View) -> Read<&[u8]> {
        let bytes = self.buffers.get(view.buffer().index()).map_or(&[][..], Vec::as_slice);
        let end = view.offset().checked_add(view.length());
        end.and_then(|end| bytes.get(view.offset()..end)).ok_or_else(|| {
            let (from, length) = (view.offset(), view.length());
            let found = bytes.len();
            format!("buffer view {}: wanted {length} bytes from byte {from} on, found {found} in all", view.index())
        })
    }

    /// The bytes behind a URI of the file: data URI, or a path beside it.
    pub fn uri(&self, uri: &str) -> Read<Vec<u8>> {
        check_uri(uri)?;
        let data = Data::from_source(buffer::Source::Uri(uri), Some(&self.folder));
        data.map(|data| data.0).map_err(|error| format!("{uri}: {error}"))
    }
}

/// A channel may move something else than a node (KHR_animation_pointer), which is nothing to us; the `gltf` crate
/// demands a node of each.
fn drop_channels_without_node(json: &mut Value) {
    let animations = json.get_mut("animations").and_then(Value::as_array_mut);
    for animation in animations.into_iter().flatten() {
        if let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) {
            channels.retain(|it| it["target"].as_object().is_none_or(|target| target.contains_key("node")));
        }
    }
}

/// An accessor without bytes is all zeros (glTF 2.0 §5.1.1); the `gltf` crate demands some. A sparse part that
/// changes no element says the same.
fn say_what_zeros_are(json: &mut Value) {
    let views = json["bufferViews"].as_array().map_or(0, Vec::len);
    let accessors = json.get_mut("accessors").and_then(Value::as_array_mut).into_iter().flatten();
    for accessor in accessors.filter_map(Value::as_object_mut).filter(|_| views > 0) {
        if !accessor.contains_key("bufferView") && !accessor.contains_key("sparse") {
            let nothing = json!({ "bufferView": 0, "componentType": 5121 });
            accessor.insert("sparse".into(), json!({ "count": 0, "indices": nothing, "values": nothing }));
        }
    }
}

/// Refuses references that the `gltf` crate does not validate and panics on. Fills in what the crate demands and
/// nothing here needs: bounds of positions, and the type of an image, which its bytes tell anyway.
fn mend(json: &mut Root) -> Read<()> {
    for (index, animation) in json.animations.iter().enumerate() {
        for target in animation.channels.iter().map(|channel| &channel.target) {
            let node = target.node.value();
            if node >= json.nodes.len() {
                return Err(format!("animation {index} moves node {node}, of {} nodes", json.nodes.len()));
            }
            if matches!(target.path, Checked::Invalid) {
                return Err(format!("animation {index}: a channel's path is none of {VALID_PROPERTIES:?}"));
            }
        }
    }
    let accessors = json.accessors.len();
    for (index, mesh) in json.meshes.iter_mut().enumerate() {
        for primitive in &mut mesh.primitives {
            // Other programs' own attributes, which validation would refuse.
            primitive.attributes.retain(|semantic, _| matches!(semantic, Checked::Valid(_)));
            let Some(at) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else { continue };
            let Some(accessor) = json.accessors.get_mut(at.value()) else {
                return Err(format!("mesh {index}: its positions are in accessor {at}, of {accessors} accessors"));
            };
            accessor.min.get_or_insert_with(|| vec![0.0; 3].into());
            accessor.max.get_or_insert_with(|| vec![0.0; 3].into());
        }
    }
    for (index, image) in json.images.iter_mut().enumerate() {
        match (&image.buffer_view, &image.uri) {
            (None, None) => return Err(format!("image {index} has neither bytes nor a URI")),
            (Some(_), _) => {
                image.mime_type.get_or_insert_with(|| MimeType("image/png".to_string()));
            }
            (None, Some(_)) => {}
        }
    }
    Ok(())
}

/// Accessor of `_PIN` by mesh and primitive.
fn pins(json: &Value) -> BTreeMap<(usize, usize), usize> {
    let list = |value: &Value, key: &str| value[key].as_array().cloned().unwrap_or_default();
    let meshes = list(json, "meshes").into_iter().enumerate();
    let primitives = meshes.flat_map(|(mesh, value)| {
        list(&value, "primitives").into_iter().enumerate().map(move |(at, primitive)| ((mesh, at), primitive))
    });
    let accessor = |primitive: &Value| primitive["attributes"]["_PIN"].as_u64().map(|index| index as usize);
    primitives.filter_map(|(place, primitive)| Some((place, accessor(&primitive)?))).collect()
}

/// Nodes that say of themselves not to be visible.
fn hidden(json: &Value) -> HashSet<usize> {
    let nodes = json["nodes"].as_array().into_iter().flatten().enumerate();
    let hidden = |node: &Value| node["extensions"]["KHR_node_visibility"]["visible"] == false;
    nodes.filter(|(_, node)| hidden(node)).map(|(index, _)| index).collect()
}

/// Refuses percent-encodings that are not UTF-8, on which the `gltf` crate panics.
pub(super) fn check_uri(uri: &str) -> Read<()> {
    let mut bytes = Vec::new();
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let escaped = tail.get(..2).filter(|_| first == b'%').and_then(|hex| std::str::from_utf8(hex).ok());
        let decoded = escaped.and_then(|hex| u8::from_str_radix(hex, 16).ok());
        bytes.push(decoded.unwrap_or(first));
        rest = if decoded.is_some() { &tail[2..] } else { tail };
    }
    std::str::from_utf8(&bytes).map(|_| ()).map_err(|_| format!("the URI {uri:?} is not UTF-8 once decoded"))
}

/// Factor and lower bound of normalised integers. glTF 2.0 §3.6.2.2, table of conversions.
fn normalisation(kind: DataType) -> (f64, f64) {
    match kind {
        DataType::I8 => (1.0 / 127.0, -1.0),
        DataType::U8 => (1.0 / 255.0, 0.0),
        DataType::I16 => (1.0 / 32767.0, -1.0),
        DataType::U16 => (1.0 / 65535.0, 0.0),
        DataType::U32 | DataType::F32 => (1.0, f64::NEG_INFINITY),
    }
}

/// One little-endian component; `bytes` has the size of its kind.
fn number(bytes: &[u8], kind: DataType) -> f64 {
    let bits = bytes.iter().rev().fold(0, |bits: u32, &byte| bits << 8 | u32::from(byte));
    match kind {
        DataType::I8 => f64::from(bits as u8 as i8),
        DataType::I16 => f64::from(bits as u16 as i16),
        DataType::U8 | DataType::U16 | DataType::U32 => f64::from(bits),
        DataType::F32 => f64::from(f32::from_bits(bits)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The components of the one accessor of a file whose buffer is 01 80 FF 7F 02 00 00 00.
    fn read(accessor: Value, wanted: Dimensions) -> Read<Vec<f64>> {
        let json = json!({ "asset": { "version": "2.0" }, "accessors": [accessor],
            "buffers": [{ "byteLength": 8, "uri": "data:;base64,AYD/fwIAAAA=" }],
            "bufferViews": [{ "buffer": 0, "byteLength": 8 }, { "buffer": 0, "byteOffset": 4, "byteLength": 1 }] });
        let file = File::parse(json.to_string().as_bytes(), PathBuf::new())?;
        file.components(&file.document.accessors().next().ok_or("no accessor")?, wanted, "numbers")
    }

    #[test]
    fn each_component_type_is_decoded() {
        let one = |kind: u32, normalized: bool, count: usize| {
            let accessor = json!({ "bufferView": 0, "componentType": kind, "normalized": normalized, "count": count,
                "type": "SCALAR" });
            read(accessor, Dimensions::Scalar).unwrap()
        };
        assert_eq!(one(5120, false, 4), [1.0, -128.0, -1.0, 127.0]);
        assert_eq!(one(5120, true, 4), [1.0 / 127.0, -1.0, -1.0 / 127.0, 1.0]);
        assert_eq!(one(5121, true, 3), [1.0 / 255.0, 128.0 / 255.0, 1.0]);
        assert_eq!(one(5122, false, 2), [-32767.0, 32767.0]);
        assert_eq!(one(5123, true, 2), [32769.0 / 65535.0, 32767.0 / 65535.0]);
        assert_eq!(one(5125, false, 2)[1], 2.0);
    }

    #[test]
    fn an_accessor_without_bytes_is_zeros() {
        let nothing = json!({ "componentType": 5126, "count": 2, "type": "VEC2" });
        assert_eq!(read(nothing, Dimensions::Vec2).unwrap(), [0.0; 4]);
    }

    #[test]
    fn sparse_accessors_change_single_elements() {
        let sparse = |count: usize| {
            json!({ "componentType": 5121, "count": count, "type": "SCALAR", "sparse": { "count": 1,
                "indices": { "bufferView": 1, "componentType": 5121 }, "values": { "bufferView": 0, "byteOffset": 3 } } })
        };
        assert_eq!(read(sparse(4), Dimensions::Scalar).unwrap(), [0.0, 0.0, 127.0, 0.0]);
        assert!(read(sparse(2), Dimensions::Scalar).unwrap_err().contains("index 2 of 2"));
        assert!(read(sparse(usize::MAX / 2), Dimensions::Scalar).unwrap_err().contains("more than"));
    }
}
