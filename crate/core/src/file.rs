//! Bytes <-> named tensors in the safetensors format. Knows no model.
//! The `safetensors` crate brings serde_json and 39 kB of brotli to the browser (measured); the header is small, so it
//! is read here.

use crate::{Error, Result};
use half::f16;
use miniserde::json::{self, Array, Number, Object, Value};
use std::borrow::Cow;
use std::collections::{BTreeMap, BinaryHeap};

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
    const NAMES: [(&'static str, Dtype); 6] = [
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

    fn size(self) -> usize {
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
        match self.dtype {
            Dtype::U32 => Some(self.bytes.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect()),
            Dtype::U16 => Some(self.bytes.as_chunks().0.iter().map(|b| u16::from_le_bytes(*b).into()).collect()),
            Dtype::U8 => Some(self.bytes.iter().map(|b| u32::from(*b)).collect()),
            Dtype::F32 | Dtype::F16 | Dtype::I8 => None,
        }
    }
}

/// The content of one safetensors file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tensors<'a> {
    /// `__metadata__`: free strings.
    pub metadata: BTreeMap<String, String>,
    /// Tensors by name.
    pub tensors: BTreeMap<String, Tensor<'a>>,
}

impl<'a> Tensors<'a> {
    /// Reads a whole file; nothing in it is trusted.
    pub fn parse(bytes: &'a [u8]) -> Result<Self> {
        let malformed = |reason: &str| Error::NotSafetensors(reason.to_owned());
        let (length, rest) = bytes.split_first_chunk::<8>().ok_or_else(|| malformed("shorter than 8 bytes"))?;
        let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
        let header = rest
            .get(..length)
            .ok_or_else(|| malformed(&format!("header of {length} bytes in a file of {}", bytes.len())))?;
        let header = std::str::from_utf8(header).map_err(|_| malformed("header is not UTF-8"))?;
        let header: Object = json::from_str(header).map_err(|_| malformed("header is not a JSON object"))?;
        let mut file = Tensors::default();
        let mut ranges = Vec::new();
        for (name, entry) in &header {
            match entry {
                Value::Object(strings) if name == "__metadata__" => file.metadata = metadata(strings)?,
                Value::Object(entry) => {
                    let (tensor, range) = tensor(name, entry, &rest[length..])?;
                    file.tensors.insert(name.clone(), tensor);
                    ranges.push((range, name));
                }
                _ => return Err(malformed(&format!("entry {name} is not an object"))),
            }
        }
        // Shared bytes would let a small file grow without bound in memory.
        ranges.retain(|(range, _)| range[0] < range[1]);
        // A heap, and below a map filled one by one: the sorts of slices, which `collect` uses too, would add 4 kB to
        // what a page downloads.
        let ranges = BinaryHeap::from(ranges).into_sorted_vec();
        match ranges.array_windows().find(|[first, second]| second.0[0] < first.0[1]) {
            Some([first, second]) => Err(malformed(&format!("tensors {} and {} share bytes", first.1, second.1))),
            None => Ok(file),
        }
    }

    /// The same with bytes of its own.
    pub fn into_owned(self) -> Tensors<'static> {
        let owned = |tensor: Tensor<'_>| Tensor { bytes: Cow::Owned(tensor.bytes.into_owned()), ..tensor };
        let tensors = self.tensors.into_iter().map(|(name, tensor)| (name, owned(tensor))).collect();
        Tensors { metadata: self.metadata, tensors }
    }

    /// The file's bytes: header, then tensors in the order of their names.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.to_bytes_with_last(|_| false)
    }

    /// The same with those that are `last` behind all others.
    pub fn to_bytes_with_last(&self, last: impl Fn(&str) -> bool) -> Vec<u8> {
        let (behind, mut order): (Vec<_>, Vec<_>) = self.tensors.iter().partition(|(name, _)| last(name));
        order.extend(behind);
        let mut header = Object::new();
        if !self.metadata.is_empty() {
            let strings = self.metadata.iter().map(|(key, value)| (key.clone(), Value::String(value.clone())));
            header.insert("__metadata__".to_owned(), Value::Object(strings.collect()));
        }
        let mut start = 0;
        for (name, tensor) in &order {
            let end = start + tensor.bytes.len();
            let mut entry = Object::new();
            entry.insert("dtype".to_owned(), Value::String(tensor.dtype.name().to_owned()));
            entry.insert("shape".to_owned(), numbers(&tensor.shape));
            entry.insert("data_offsets".to_owned(), numbers(&[start, end]));
            header.insert((*name).clone(), Value::Object(entry));
            start = end;
        }
        let mut header = json::to_string(&header);
        header.extend(std::iter::repeat_n(' ', header.len().next_multiple_of(8) - header.len()));
        let mut bytes = (header.len() as u64).to_le_bytes().to_vec();
        bytes.extend(header.as_bytes());
        order.iter().for_each(|(_, tensor)| bytes.extend(&*tensor.bytes));
        bytes
    }

    /// The tensor of that name.
    pub fn get(&self, name: &str) -> Result<&Tensor<'a>> {
        self.tensors.get(name).ok_or_else(|| Error::MissingTensor(name.to_owned()))
    }

    /// The tensor of that name as finite f32, checked against `shape`; a `None` in it takes any size.
    pub fn f32(&self, name: &str, shape: &[Option<usize>]) -> Result<(Vec<f32>, Vec<usize>)> {
        let tensor = self.checked(name, shape)?;
        let values = match self.whole(name, shape)? {
            Some((values, scale)) => scaled(values, &scale),
            None => tensor.to_f32().ok_or_else(|| wrong(name, "F32, F16 or I8", tensor.dtype.name()))?,
        };
        match values.iter().position(|value| !value.is_finite()) {
            Some(element) => Err(Error::NotFinite { what: name.to_owned(), element, found: values[element] }),
            None => Ok((values, tensor.shape.clone())),
        }
    }

    /// The tensor of that name as whole numbers, if it is kept so, and their scales, one for each row or one for all.
    /// The numbers are those of `NAME`, or, where `NAME.fine` is there, 256 times them plus those.
    pub fn whole(&self, name: &str, shape: &[Option<usize>]) -> Result<Option<(Vec<f32>, Vec<f32>)>> {
        let tensor = self.checked(name, shape)?;
        if tensor.dtype != Dtype::I8 {
            return Ok(None);
        }
        let [scale_name, fine_name] = ["scale", "fine"].map(|part| format!("{name}.{part}"));
        let scale = self.checked(&scale_name, &[None])?;
        let scale = scale.to_f32().ok_or_else(|| wrong(&scale_name, "F32 or F16", scale.dtype.name()))?;
        if scale.len() != 1 && Some(&scale.len()) != tensor.shape.first() {
            let wanted = format!("one scale, or one for each row of {:?}", tensor.shape);
            return Err(wrong(&scale_name, &wanted, &format!("{}", scale.len())));
        }
        let mut values: Vec<f32> = tensor.bytes.iter().map(|byte| f32::from(*byte as i8)).collect();
        if self.tensors.contains_key(&fine_name) {
            let fine = self.checked(&fine_name, &tensor.shape.iter().copied().map(Some).collect::<Vec<_>>())?;
            if fine.dtype != Dtype::I8 {
                return Err(wrong(&fine_name, "I8", fine.dtype.name()));
            }
            let add = |(value, byte): (&mut f32, &u8)| *value = 256.0 * *value + f32::from(*byte as i8);
            values.iter_mut().zip(&*fine.bytes).for_each(add);
        }
        Ok(Some((values, scale)))
    }

    /// The tensor of that name as u32 below `limit`, checked against `shape`.
    pub fn u32(&self, name: &str, shape: &[Option<usize>], limit: usize) -> Result<Vec<u32>> {
        let tensor = self.checked(name, shape)?;
        let values = tensor.to_u32().ok_or_else(|| wrong(name, "U32, U16 or U8", tensor.dtype.name()))?;
        match values.iter().position(|value| *value as usize >= limit) {
            Some(element) => Err(Error::Index { tensor: name.to_owned(), element, found: values[element], limit }),
            None => Ok(values),
        }
    }

    fn checked(&self, name: &str, shape: &[Option<usize>]) -> Result<&Tensor<'a>> {
        let tensor = self.get(name)?;
        let same = |(wanted, found): (&Option<usize>, &usize)| wanted.is_none_or(|size| size == *found);
        if tensor.shape.len() == shape.len() && shape.iter().zip(&tensor.shape).all(same) {
            return Ok(tensor);
        }
        let sizes = shape.iter().map(|size| size.map_or("*".to_owned(), |size| size.to_string()));
        let wanted = format!("shape [{}]", sizes.collect::<Vec<_>>().join(", "));
        Err(wrong(name, &wanted, &format!("{:?}", tensor.shape)))
    }
}

/// Whole numbers times the scale of their row, or of all.
pub fn scaled(mut whole: Vec<f32>, scale: &[f32]) -> Vec<f32> {
    let width = whole.len().checked_div(scale.len()).unwrap_or(0).max(1);
    for (row, scale) in whole.chunks_mut(width).zip(scale) {
        row.iter_mut().for_each(|value| *value *= scale);
    }
    whole
}

fn wrong(tensor: &str, wanted: &str, found: &str) -> Error {
    Error::Shape { tensor: tensor.to_owned(), wanted: wanted.to_owned(), found: found.to_owned() }
}

fn metadata(strings: &Object) -> Result<BTreeMap<String, String>> {
    let mut metadata = BTreeMap::new();
    for (key, value) in strings {
        let Value::String(text) = value else {
            return Err(Error::NotSafetensors(format!("__metadata__ {key} is not a string")));
        };
        metadata.insert(key.clone(), text.clone());
    }
    Ok(metadata)
}

/// One entry of the header: the tensor and the range of its bytes.
fn tensor<'a>(name: &str, entry: &Object, payload: &'a [u8]) -> Result<(Tensor<'a>, [usize; 2])> {
    let malformed = |reason: String| Error::NotSafetensors(format!("tensor {name}: {reason}"));
    let dtype = match entry.get("dtype") {
        Some(Value::String(text)) => Dtype::NAMES.iter().find(|known| known.0 == text).map(|known| known.1),
        _ => None,
    };
    let dtype = dtype.ok_or_else(|| malformed("dtype is none of F32, F16, U32, U16, U8, I8".to_owned()))?;
    let shape = sizes(entry.get("shape")).ok_or_else(|| malformed("shape is no list of sizes".to_owned()))?;
    let offsets = sizes(entry.get("data_offsets")).filter(|offsets| offsets.len() == 2 && offsets[0] <= offsets[1]);
    let offsets = offsets.ok_or_else(|| malformed("data_offsets are no range".to_owned()))?;
    let wanted = shape.iter().try_fold(dtype.size(), |bytes, size| bytes.checked_mul(*size));
    if wanted != Some(offsets[1] - offsets[0]) {
        return Err(malformed(format!("shape {shape:?} does not fill {} bytes", offsets[1] - offsets[0])));
    }
    let truncated = || Error::Truncated { tensor: name.to_owned(), wanted: offsets[1], found: payload.len() };
    let bytes = payload.get(offsets[0]..offsets[1]).ok_or_else(truncated)?;
    Ok((Tensor { dtype, shape, bytes: Cow::Borrowed(bytes) }, [offsets[0], offsets[1]]))
}

fn sizes(value: Option<&Value>) -> Option<Vec<usize>> {
    let Some(Value::Array(array)) = value else { return None };
    let size = |value: &Value| match value {
        Value::Number(Number::U64(size)) => usize::try_from(*size).ok(),
        _ => None,
    };
    array.iter().map(size).collect()
}

fn numbers(sizes: &[usize]) -> Value {
    let number = |size: &usize| Value::Number(Number::U64(*size as u64));
    Value::Array(sizes.iter().map(number).collect::<Array>())
}
