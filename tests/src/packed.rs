//! Model files as `ctsn pack` keeps them, whatever their size.

use ctsn_core::file::{Dtype, Tensors};
use ctsn_core::model::file_bytes;
use ctsn_core::model::pack::{narrow, quantise};

/// A model's tensors with every real one of two and more dimensions as whole numbers of so many levels.
pub fn packed(model: &[u8], levels: u32) -> Tensors<'static> {
    let mut file = Tensors::parse(model).expect("a model").into_owned();
    let real = |dtype: Dtype| matches!(dtype, Dtype::F32 | Dtype::F16);
    let large = file.tensors.iter().filter(|(_, tensor)| real(tensor.dtype) && tensor.shape.len() > 1);
    let names: Vec<String> = large.map(|(name, _)| name.clone()).collect();
    names.iter().for_each(|name| quantise(&mut file, name, levels, None).expect("a real tensor"));
    narrow(&mut file);
    file
}

/// Its bytes.
pub fn packed_bytes(model: &[u8], levels: u32) -> Vec<u8> {
    file_bytes(packed(model, levels))
}
