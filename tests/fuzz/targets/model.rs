//! A golden model with some of its bytes changed: refused, or it predicts finite positions and unit normals, or refuses
//! the pose. Raw bytes would hardly ever be a model.
#![no_main]

use ctsn_core::file::Tensors;
use ctsn_core::model::file_bytes;
use ctsn_core::model::pack::{narrow, quantise};
use ctsn_core::{Predictor, Streams};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

const MODELS: [&[u8]; 2] = [
    include_bytes!("../../golden/tiny.safetensors"),
    include_bytes!("../../golden/isolated.safetensors"),
];

/// The first of them as `ctsn pack` keeps it.
static PACKED: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut file = Tensors::parse(MODELS[0]).expect("a model").into_owned();
    let real = file.tensors.iter().filter(|(_, tensor)| tensor.to_f32().is_some() && tensor.shape.len() > 1);
    let names: Vec<String> = real.map(|(name, _)| name.clone()).collect();
    names.iter().for_each(|name| quantise(&mut file, name, 500, None).expect("a real tensor"));
    narrow(&mut file);
    file_bytes(file)
});

fuzz_target!(|input: &[u8]| {
    let Some((which, edits)) = input.split_first() else { return };
    let mut bytes = if which & 4 == 0 { MODELS[usize::from(which & 1)].to_vec() } else { PACKED.clone() };
    // Length to keep, if the next bit says so.
    let edits = match edits.split_first_chunk::<2>() {
        Some((length, rest)) if which & 2 != 0 => {
            bytes.truncate(usize::from(u16::from_le_bytes(*length)));
            rest
        }
        _ => edits,
    };
    for [low, high, value] in edits.as_chunks().0 {
        if let Some(byte) = bytes.get_mut(usize::from(u16::from_le_bytes([*low, *high]))) {
            *byte = *value;
        }
    }
    let Ok(mut predictor) = Predictor::new(&bytes) else { return };
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.1, 0.2, 0.3, 1.0];
    let pose = identity.repeat(predictor.joints().len());
    for streams in [Streams::Both, Streams::Skeleton, Streams::None] {
        if predictor.predict(&pose, streams).is_ok() {
            assert!(predictor.positions().iter().chain(predictor.normals()).all(|value| value.is_finite()));
        }
    }
    assert!(predictor.bytes() > 0 && predictor.confidence().is_finite());
});
