//! One stored tensor: its type, and its numbers from and to bytes.

use half::f16;
use std::borrow::Cow;

/// Element type of a stored tensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dtype {
    /// 32-bit float.
    F32,
    /// 16-bit float.
    F16,
    /// 32-bit unsigned integer.
    U32,
    /// 16-bit unsigned integer.
    U16,
    /// 8-bit unsigned integer.
    U8,
    /// 8-bit signed integer, which a scale makes a real number: [`Tensors::f32`].
    I8,
}

impl Dtype {
    pub(super) const NAMES: [(&'static str, Dtype); 6] = [
        ("F32", Dtype::F32),
        ("F16", Dtype::F16),
        ("U32", Dtype::U32),
        ("U16", Dtype::U16),
        ("U8", Dtype::U8),
        ("I8", Dtype::I8),
    ];

    /// Name in the header.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|entry| entry.1 == self).map_or("?", |entry| entry.0)
    }

    pub(super) fn size(self) -> usize {
        match self {
            Dtype::F32 | Dtype::U32 => 4,
            Dtype::F16 | Dtype::U16 => 2,
            Dtype::U8 | Dtype::I8 => 1,
        }
    }
}

/// One stored tensor: type, shape and little-endian bytes, borrowed from a file that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensor<'a> {
    /// Element type.
    pub dtype: Dtype,
    /// Shape, row-major.
    pub shape: Vec<usize>,
    /// Little-endian elements.
    pub bytes: Cow<'a, [u8]>,
}

impl Tensor<'_> {
    /// Tensor of F32 elements.
    pub fn f32(shape: &[usize], values: &[f32]) -> Self {
        debug_assert_eq!(shape.iter().product::<usize>(), values.len());
        let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        Self { dtype: Dtype::F32, shape: shape.to_vec(), bytes }
    }

    /// Tensor of F16 elements, rounded from `values`.
    pub fn f16(shape: &[usize], values: &[f32]) -> Self {
        let bytes = values.iter().flat_map(|value| f16::from_f32(*value).to_le_bytes()).collect();
        Self { dtype: Dtype::F16, shape: shape.to_vec(), bytes }
    }

    /// Tensor of U32 elements.
    pub fn u32(shape: &[usize], values: &[u32]) -> Self {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        Self { dtype: Dtype::U32, shape: shape.to_vec(), bytes }
    }

    /// Tensor of the narrowest unsigned type that holds `values`.
    pub fn narrow(shape: &[usize], values: &[u32]) -> Self {
        let (dtype, size) = match values.iter().max().copied().unwrap_or(0) {
            0..=0xff => (Dtype::U8, 1),
            0x100..=0xffff => (Dtype::U16, 2),
            _ => (Dtype::U32, 4),
        };
        let bytes = values.iter().flat_map(|value| value.to_le_bytes().into_iter().take(size)).collect();
        Self { dtype, shape: shape.to_vec(), bytes }
    }

    /// Tensor of I8 elements.
    pub fn i8(shape: &[usize], values: &[i8]) -> Self {
        let bytes = values.iter().map(|value| *value as u8).collect();
        Self { dtype: Dtype::I8, shape: shape.to_vec(), bytes }
    }

    /// Elements as f32; `None` for an integer tensor.
    pub fn to_f32(&self) -> Option<Vec<f32>> {
        match self.dtype {
            Dtype::F32 => Some(self.bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect()),
            Dtype::F16 => Some(self.bytes.as_chunks().0.iter().map(|b| f16::from_le_bytes(*b).to_f32()).collect()),
            Dtype::U32 | Dtype::U16 | Dtype::U8 | Dtype::I8 => None,
        }
    }

    /// Elements as u32; `None` for a tensor of any other than unsigned integers.
    pub fn to_u32(&self) -> Option<Vec<u32>> {
        let whole = |bytes: &[u8]| bytes.iter().rev().fold(0, |sum, byte| sum << 8 | u32::from(*byte));
        let unsigned = matches!(self.dtype, Dtype::U32 | Dtype::U16 | Dtype::U8);
        unsigned.then(|| self.bytes.chunks_exact(self.dtype.size()).map(whole).collect())
    }
}
