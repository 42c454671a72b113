//! A model's file made small: real tensors as whole numbers of one or two bytes times scales, indices as narrow as they
//! may be. `Tensors::f32` and `Tensors::u32` read both, so that no device sees a stored type. docs/format.md.

use crate::Result;
use crate::file::{Dtype, Tensor, Tensors};

/// Most levels on either side of zero: what two bytes hold.
pub const MOST_LEVELS: u32 = 127 * 256 + 127;
/// A tensor of fewer numbers stays as it is: it weighs nothing.
const FEW: usize = 512;

/// Names of the real tensors of `file` that are worth being kept as whole numbers.
pub fn packable(file: &Tensors) -> Vec<String> {
    let real = |tensor: &Tensor| matches!(tensor.dtype, Dtype::F32 | Dtype::F16) || tensor.dtype == Dtype::I8;
    let large = |tensor: &Tensor| tensor.shape.len() > 1 && tensor.shape.iter().product::<usize>() >= FEW;
    let wanted = |name: &str, tensor: &Tensor| real(tensor) && large(tensor) && !name.ends_with(".fine");
    file.tensors.iter().filter(|(name, tensor)| wanted(name, tensor)).map(|(name, _)| name.clone()).collect()
}

/// Whether each row of a tensor has a scale of its own: those of learned matrices. Places and skin weights have one
/// scale for all.
fn by_rows(name: &str) -> bool {
    name.ends_with(".weight") || name.ends_with(".basis")
}

/// Keeps the tensor `name` as whole numbers: `levels` of them on either side of zero for the row that needs most.
/// `importance`: what an error in each row counts, where that is known; a row's largest number by default.
///
/// # Errors
/// There is no such tensor, or it is not one of finite real numbers.
pub fn quantise(file: &mut Tensors, name: &str, levels: u32, importance: Option<&[f32]>) -> Result<()> {
    let shape = file.get(name)?.shape.clone();
    let any = vec![None; shape.len()];
    let values = file.f32(name, &any)?.0;
    let rows = if by_rows(name) { shape[0] } else { 1 };
    let width = (values.len() / rows.max(1)).max(1);
    let greatest: Vec<f32> =
        values.chunks(width).map(|row| row.iter().fold(0.0, |most: f32, value| most.max(value.abs()))).collect();
    let counts = |row: usize| importance.map_or(1.0 / greatest[row], |importance| importance[row]);
    let most = (0..greatest.len()).filter(|row| greatest[*row] > 0.0).map(|row| counts(row) * greatest[row]);
    let step = most.fold(0.0, f32::max) / levels.min(MOST_LEVELS) as f32;
    let scale: Vec<f32> = (0..greatest.len())
        .map(|row| if greatest[row] > 0.0 && counts(row) > 0.0 { step / counts(row) } else { 0.0 })
        .collect();
    let whole = |(row, value): (usize, &f32)| if scale[row] > 0.0 { (value / scale[row]).round() as i32 } else { 0 };
    let numbers: Vec<i32> =
        values.chunks(width).enumerate().flat_map(|(row, values)| values.iter().map(move |v| (row, v))).map(whole).collect();
    // The low byte is signed, too: so the high ones of small numbers are all zero, which packs to nothing.
    let fine: Vec<i8> = numbers.iter().map(|number| *number as i8).collect();
    let high: Vec<i8> = numbers.iter().zip(&fine).map(|(number, fine)| ((number - i32::from(*fine)) / 256) as i8).collect();
    file.tensors.insert(format!("{name}.scale"), Tensor::f32(&[scale.len()], &scale));
    if high.iter().any(|high| *high != 0) {
        file.tensors.insert(name.to_owned(), Tensor::i8(&shape, &high));
        file.tensors.insert(format!("{name}.fine"), Tensor::i8(&shape, &fine));
    } else {
        file.tensors.insert(name.to_owned(), Tensor::i8(&shape, &fine));
        file.tensors.remove(&format!("{name}.fine"));
    }
    Ok(())
}

/// Keeps every tensor of indices in the narrowest type that holds them.
pub fn narrow(file: &mut Tensors) {
    for tensor in file.tensors.values_mut() {
        if let Some(values) = tensor.to_u32() {
            *tensor = Tensor::narrow(&tensor.shape, &values);
        }
    }
}
