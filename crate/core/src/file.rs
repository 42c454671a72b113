//! Bytes <-> named tensors in the safetensors format. Knows no model.
//! The `safetensors` crate brings serde_json and 39 kB of brotli to the browser (measured); the header is small, so it
//! is read here.

mod tensor;

use crate::{Error, Result};
use miniserde::json::{self, Array, Number, Object, Value};
use std::borrow::Cow;
use std::collections::{BTreeMap, BinaryHeap};
pub use tensor::{Dtype, Tensor};

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
    #[inline(never)]
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
        let fine = match self.tensors.get(&fine_name) {
            Some(fine) if fine.dtype != Dtype::I8 || fine.shape != tensor.shape => {
                let wanted = format!("I8 {:?}", tensor.shape);
                return Err(wrong(&fine_name, &wanted, &format!("{} {:?}", fine.dtype.name(), fine.shape)));
            }
            fine => fine,
        };
        let low = |at: usize| fine.map_or(0.0, |fine| f32::from(fine.bytes[at] as i8));
        let high = if fine.is_some() { 256.0 } else { 1.0 };
        let whole = tensor.bytes.iter().enumerate().map(|(at, byte)| high * f32::from(*byte as i8) + low(at));
        Ok(Some((whole.collect(), scale)))
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
    let text = match entry.get("dtype") {
        Some(Value::String(text)) => text,
        _ => "none",
    };
    let dtype = Dtype::NAMES.iter().find(|known| known.0 == text).map(|known| known.1);
    let dtype =
        dtype.ok_or_else(|| malformed(format!("dtype: wanted one of F32, F16, U32, U16, U8, I8, found {text}")))?;
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
