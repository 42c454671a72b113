//! A model's file made small: real tensors as whole numbers of one or two bytes times scales, indices as narrow as they
//! may be. `Tensors::f32` and `Tensors::u32` read both, so that no device sees a stored type. docs/format.md.

use super::read::{Description, describe, finite};
use super::ride::COORDINATES;
use super::{MESH_BASIS, SKELETON_BASIS};
use crate::Result;
use crate::file::{Dtype, Tensor, Tensors, scaled};
use crate::topology::Graph;
use miniserde::json;

/// Most levels on either side of zero: what two bytes hold.
pub const MOST_LEVELS: u32 = 127 * 256 + 127;
/// The version of files that keep both bases as differences.
pub(super) const DIFFERENCES: u32 = 2;
/// A tensor of fewer numbers stays as it is: it weighs nothing.
const FEW: usize = 512;

/// Names of the real tensors of `file` that are worth being kept as whole numbers.
pub fn packable(file: &Tensors) -> Vec<String> {
    let real = |tensor: &Tensor| matches!(tensor.dtype, Dtype::F32 | Dtype::F16) || tensor.dtype == Dtype::I8;
    let large = |tensor: &Tensor| tensor.shape.len() > 1 && tensor.shape.iter().product::<usize>() >= FEW;
    let whole = |name: &str| name.ends_with(".fine") || name == COORDINATES;
    let wanted = |name: &str, tensor: &Tensor| real(tensor) && large(tensor) && !whole(name);
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
    let is_basis = [SKELETON_BASIS, MESH_BASIS].contains(&name);
    let graph = if is_basis { Some(cloth(file, shape[1])?) } else { None };
    let any = vec![None; shape.len()];
    let values = match &graph {
        Some(graph) => basis(file, name, graph, name == SKELETON_BASIS || describe(file)?.version >= DIFFERENCES)?.0,
        None => file.f32(name, &any)?.0,
    };
    let rows = if by_rows(name) { shape[0] } else { 1 };
    let width = (values.len() / rows.max(1)).max(1);
    let greatest: Vec<f32> =
        values.chunks(width).map(|row| row.iter().fold(0.0, |most: f32, value| most.max(value.abs()))).collect();
    let counts = |row: usize| importance.map_or(1.0 / greatest[row], |importance| importance[row]);
    let most = (0..greatest.len()).filter(|row| greatest[*row] > 0.0).map(|row| counts(row) * greatest[row]);
    let step =
        most.fold(0.0, f32::max) / levels.min(if graph.is_some() { MOST_LEVELS / 2 } else { MOST_LEVELS }) as f32;
    let scale: Vec<f32> = (0..greatest.len())
        .map(|row| if greatest[row] > 0.0 && counts(row) > 0.0 { step / counts(row) } else { 0.0 })
        .collect();
    let whole =
        |(at, value): (usize, &f32)| if scale[at / width] > 0.0 { (value / scale[at / width]).round() } else { 0.0 };
    let mut numbers: Vec<f32> = values.iter().enumerate().map(whole).collect();
    if let Some(graph) = &graph {
        subtract_expected(graph, &mut numbers);
    }
    if name == MESH_BASIS {
        let description = Description { version: DIFFERENCES, ..describe(file)? };
        file.metadata.insert("ctsn".to_owned(), json::to_string(&description));
    }
    // The low byte is signed, too: so the high ones of small numbers are all zero, which packs to nothing.
    let fine: Vec<i8> = numbers.iter().map(|number| *number as i32 as i8).collect();
    let high: Vec<i8> =
        numbers.iter().zip(&fine).map(|(number, fine)| ((number - f32::from(*fine)) / 256.0) as i8).collect();
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

/// The cloth's edges, of a file for `n` vertices.
fn cloth(file: &Tensors, n: usize) -> Result<Graph<Vec<u32>>> {
    Ok(Graph::new(n, &file.u32("cloth.triangles", &[None, Some(3)], n)?))
}

/// A basis [count, n, 3], and how many matrices it has. Its whole numbers, if it has `differences`, are kept less what
/// their neighbours let expect. Bases are learned smoothly, so that takes fewer bytes: a fifth to a quarter fewer of
/// the mesh stream's. (It took more of those that were learned roughly: files of version 1 have it as it is.)
pub(super) fn basis(
    file: &Tensors,
    name: &str,
    graph: &Graph<Vec<u32>>,
    differences: bool,
) -> Result<(Vec<f32>, usize)> {
    let shape = [None, Some(graph.offsets.len() - 1), Some(3)];
    let Some((mut whole, scale)) = file.whole(name, &shape)? else {
        let (values, shape) = file.f32(name, &shape)?;
        return Ok((values, shape[0]));
    };
    if differences {
        add_expected(graph, &mut whole);
    }
    let values = scaled(whole, &scale);
    finite(name, &values)?;
    Ok((values, file.get(name)?.shape[0]))
}

/// The neighbours of each vertex that come before it.
fn before(graph: &Graph<Vec<u32>>) -> Vec<&[u32]> {
    let vertices = graph.offsets.len() - 1;
    let row = |vertex: usize| {
        let all = graph.of(vertex);
        &all[..all.partition_point(|other| (*other as usize) < vertex)]
    };
    (0..vertices).map(row).collect()
}

/// What the three numbers of a vertex in a smooth matrix [n, 3] should be: the mean of those of its neighbours before
/// it, rounded.
fn expected(before: &[u32], matrix: &[[f32; 3]]) -> [f32; 3] {
    if before.is_empty() {
        return [0.0; 3];
    }
    let mut sum = [0.0; 3];
    for other in before {
        let numbers = matrix[*other as usize];
        (0..3).for_each(|axis| sum[axis] += numbers[axis]);
    }
    sum.map(|sum: f32| (sum / before.len() as f32 + 0.5).floor())
}

fn add_expected(graph: &Graph<Vec<u32>>, matrices: &mut [f32]) {
    let before = before(graph);
    for matrix in matrices.as_chunks_mut::<3>().0.chunks_exact_mut(before.len()) {
        for (vertex, before) in before.iter().enumerate() {
            let expected = expected(before, matrix);
            (0..3).for_each(|axis| matrix[vertex][axis] += expected[axis]);
        }
    }
}

/// The inverse of [`add_expected`]: backwards, while those before are still there.
fn subtract_expected(graph: &Graph<Vec<u32>>, matrices: &mut [f32]) {
    let before = before(graph);
    for matrix in matrices.as_chunks_mut::<3>().0.chunks_exact_mut(before.len()) {
        for (vertex, before) in before.iter().enumerate().rev() {
            let expected = expected(before, matrix);
            (0..3).for_each(|axis| matrix[vertex][axis] -= expected[axis]);
        }
    }
}

/// Keeps every tensor of indices in the narrowest type that holds them.
pub fn narrow(file: &mut Tensors) {
    for tensor in file.tensors.values_mut() {
        if let Some(values) = tensor.to_u32() {
            *tensor = Tensor::narrow(&tensor.shape, &values);
        }
    }
}
