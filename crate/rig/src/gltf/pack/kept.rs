//! What an accessor holds, by what it is for: as whole numbers, or filtered for meshoptimizer's coding.

use super::super::unpack::size;
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{self, ExpMode};
use serde_json::Value;

const I8: u32 = 5120;
const U8: u32 = 5121;
const I16: u32 = 5122;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;
/// Bits of a position's mantissa: 0.01 mm at 1 m. Of a joint's place; of a normal; of a rotation: 0.005°.
const PLACE_BITS: u32 = 17;
const NORMAL_BITS: u32 = 8;
const TURN_BITS: u32 = 14;

/// How the numbers of an accessor are kept.
pub(super) struct Kept {
    pub component: u32,
    pub normalized: bool,
    /// Bytes of an element, a multiple of four but for indices.
    pub stride: usize,
    pub mode: &'static str,
    pub filter: &'static str,
    /// Elements, filtered, not yet coded.
    pub bytes: Vec<u8>,
}

/// The bytes of an accessor that has a view for itself, tightly packed; nothing of another.
pub(super) fn plain(bin: &[u8], accessor: &Value, views: &[Value]) -> Option<Vec<u8>> {
    let view = views.get(accessor["bufferView"].as_u64()? as usize)?;
    let odd = [&view["byteStride"], &accessor["byteOffset"], &accessor["sparse"]].iter().any(|value| !value.is_null());
    let from = size(view, "byteOffset");
    let bytes = bin.get(from..from.checked_add(size(view, "byteLength"))?)?;
    let width = match (accessor["type"].as_str()?, accessor["componentType"].as_u64()? as u32) {
        ("SCALAR", F32 | U32) => 4,
        ("VEC2", F32) | ("VEC4", U16) => 8,
        ("VEC3", F32) => 12,
        ("VEC4", F32) => 16,
        _ => return None,
    };
    (!odd && bytes.len() == width * size(accessor, "count")).then(|| bytes.to_vec())
}

/// The numbers of an accessor as they are kept; nothing of one that stays as it is.
pub(super) fn keep(role: &str, accessor: &Value, bytes: &[u8]) -> Option<Kept> {
    let floats: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
    let (count, kind) = (size(accessor, "count"), accessor["type"].as_str()?);
    let real = accessor["componentType"].as_u64()? as u32 == F32;
    let mut workspace = Workspace::default();
    let kept = |component, normalized, stride, filter, bytes| {
        Some(Kept { component, normalized, stride, mode: "ATTRIBUTES", filter, bytes })
    };
    match (role, kind) {
        ("POSITION" | ".translation" | ".scale", "VEC3") if real => {
            let mode = ExpMode::Separate;
            let bytes = codec::encode_filter_exp(count, 12, PLACE_BITS, &floats, mode, &mut workspace).ok()?;
            kept(F32, false, 12, "EXPONENTIAL", bytes)
        }
        ("NORMAL", "VEC3") if real => {
            let four: Vec<f32> = floats.as_chunks::<3>().0.iter().flat_map(|[x, y, z]| [*x, *y, *z, 0.0]).collect();
            let bytes = codec::encode_filter_oct(count, 4, NORMAL_BITS, &four, &mut workspace).ok()?;
            kept(I8, true, 4, "OCTAHEDRAL", bytes)
        }
        (".rotation", "VEC4") if real => {
            let bytes = codec::encode_filter_quat(count, 8, TURN_BITS, &floats, &mut workspace).ok()?;
            kept(I16, true, 8, "QUATERNION", bytes)
        }
        (".time", "SCALAR") if real => kept(F32, false, 4, "NONE", bytes.to_vec()),
        (name, "VEC4") if name.starts_with("WEIGHTS_") && real => kept(U16, true, 8, "NONE", whole(&floats, 4)),
        (name, "VEC3" | "VEC4") if name.starts_with("COLOR_") && real => {
            kept(U16, true, 8, "NONE", whole(&floats, if kind == "VEC3" { 3 } else { 4 }))
        }
        (name, "VEC2") if name.starts_with("TEXCOORD_") && floats.iter().all(|uv| (0.0..=1.0).contains(uv)) => {
            kept(U16, true, 4, "NONE", whole(&floats, 2))
        }
        (name, "VEC4")
            if name.starts_with("JOINTS_") && bytes.as_chunks::<2>().0.iter().all(|[_, high]| *high == 0) =>
        {
            kept(U8, false, 4, "NONE", bytes.iter().step_by(2).copied().collect())
        }
        ("indices", "SCALAR") if !real => {
            let narrow = bytes.as_chunks::<4>().0.iter().all(|[.., a, b]| [*a, *b] == [0, 0]);
            let (component, stride) = if narrow { (U16, 2) } else { (U32, 4) };
            Some(Kept {
                component,
                normalized: false,
                stride,
                mode: "TRIANGLES",
                filter: "NONE",
                bytes: bytes.to_vec(),
            })
        }
        _ => None,
    }
}

/// Numbers from 0 to 1 as whole numbers of 16 bits, in elements of a multiple of four bytes.
fn whole(floats: &[f32], width: usize) -> Vec<u8> {
    let element = |numbers: &[f32]| -> Vec<u8> {
        let mut bytes: Vec<u8> =
            numbers.iter().flat_map(|x| ((x.clamp(0.0, 1.0) * 65535.0).round() as u16).to_le_bytes()).collect();
        bytes.resize((2 * width).next_multiple_of(4), 0);
        bytes
    };
    floats.chunks_exact(width).flat_map(element).collect()
}
