//! Model file -> model, checking every name, shape and index. network.md §8.

use super::{
    Body, Cut, HostModel, Layer, Linear, Model, Reference, Ride, Sizes, Skinning, Surface, pack, surroundings,
};
use super::{CLOTH_WEIGHTS, MESH_BASIS, MOST_STEPS, SKELETON_BASIS, STEPS};
use crate::error::{Decimal, Error, Result};
use crate::file::Tensors;
use crate::pose::{Frame, Range, Rig, Transform};
use crate::topology::Graph;
use miniserde::{Deserialize, Serialize, json};
use std::sync::Arc;

/// The JSON object under `__metadata__["ctsn"]`.
#[derive(Deserialize, Serialize)]
pub(super) struct Description {
    pub version: u32,
    pub frame: String,
    pub root: usize,
    pub joints: Vec<String>,
    pub inverse_bind: Vec<Vec<f32>>,
    pub heads: usize,
    pub edge_scale: f32,
    /// Steps of the polish; older files lack it.
    pub polish: Option<u32>,
}

/// Most numbers that the intermediate results of one prediction may hold: a gigabyte. A few rows of weights could ask
/// for more than there is.
const MOST_NUMBERS: usize = 1 << 28;

impl HostModel {
    /// Reads a model file; nothing in it is trusted.
    pub fn parse(bytes: &[u8]) -> Result<Self> {
        Self::read(&Tensors::parse(bytes)?)
    }

    /// The same of a file's tensors.
    pub fn read(file: &Tensors) -> Result<Self> {
        let description = describe(file)?;
        let (rest, shape) = file.f32("cloth.rest", &[None, Some(3)])?;
        let (n, joints) = sizes(shape[0], description.joints.len())?;
        let triangles = file.u32("cloth.triangles", &[None, Some(3)], n)?;
        let dense = file.f32(CLOTH_WEIGHTS, &[Some(n), Some(joints)])?.0;
        let graph = Graph::new(n, &triangles);
        let (skeleton_basis, m) = basis(file, SKELETON_BASIS, &graph, true)?;
        let (mesh_basis, k) = basis(file, MESH_BASIS, &graph, description.version >= pack::DIFFERENCES)?;
        let embedding = mlp(file, "embedding", 12 * joints, Some(m))?;
        let surroundings = surroundings::read(file, n)?;
        let layers = layers(file, surroundings.is_some())?;
        let features = features(&layers, description.heads)?;
        let vertex_mlp = mlp(file, "vertex", features, Some(k))?;
        let width = vertex_mlp
            .iter()
            .map(|layer| layer.outputs)
            .fold((4 + 1 + layers.len()).saturating_mul(features), usize::saturating_add);
        if n.saturating_mul(width) > MOST_NUMBERS {
            let wanted = format!("wanted at most {MOST_NUMBERS} numbers between the layers");
            return Err(Error::NotModel(format!("{wanted}, found {width} for each of {n} vertices")));
        }
        let surface = surface(file, Ride::count(file)?.unwrap_or(n))?;
        let steps = description.polish.map_or(STEPS, |steps| steps as usize);
        if steps > MOST_STEPS {
            return Err(Error::NotModel(format!("polish: wanted at most {MOST_STEPS} steps, found {steps}")));
        }
        Ok(Model {
            sizes: Sizes { vertices: n, joints, embedding: m, basis: k, features, heads: description.heads },
            cut: Cut::read(file, n, &graph, steps)?,
            graph,
            triangles,
            rest,
            skinning: Skinning::from_dense(&dense, joints),
            reference: reference(file, n, joints, description.edge_scale)?,
            surroundings,
            embedding,
            skeleton_basis,
            layers,
            vertex_mlp,
            mesh_stream: mesh_basis.iter().any(|value| *value != 0.0),
            mesh_basis,
            ride: Ride::read(file, n, surface.as_ref())?,
            surface,
            body: Body::read(file, n, joints)?,
            training: file.metadata.get("training").cloned(),
            rig: Arc::new(rig(file, description)?),
        })
    }
}

/// Of a model that has some of both.
fn sizes(vertices: usize, joints: usize) -> Result<(usize, usize)> {
    if vertices == 0 || joints == 0 {
        return Err(Error::NotModel(format!("wanted vertices and joints, found {vertices} and {joints}")));
    }
    Ok((vertices, joints))
}

pub(super) fn describe(file: &Tensors) -> Result<Description> {
    let text = file.metadata.get("ctsn").ok_or_else(|| Error::NotModel("__metadata__ has no key ctsn".to_owned()))?;
    let description: Description = json::from_str(text).map_err(|_| {
        Error::NotModel(
            "__metadata__.ctsn lacks version, frame, root, joints, inverse_bind, heads or edge_scale".to_owned(),
        )
    })?;
    if !(1..=pack::DIFFERENCES).contains(&description.version) {
        return Err(Error::NotModel(format!("wanted version 1 or 2, found {}", description.version)));
    }
    Ok(description)
}

fn rig(file: &Tensors, description: Description) -> Result<Rig> {
    let joints = description.joints.len();
    let frame = match description.frame.as_str() {
        "hip_yaw" => Frame::HipYaw,
        "hip" => Frame::Hip,
        other => return Err(Error::NotModel(format!("wanted frame hip_yaw or hip, found {other}"))),
    };
    if description.root >= joints {
        return Err(Error::NotModel(format!("root {} is not below {joints} joints", description.root)));
    }
    let transform = |numbers: &Vec<f32>| <[f32; 12]>::try_from(numbers.as_slice()).ok();
    let inverse_bind: Option<Vec<_>> = description.inverse_bind.iter().map(transform).collect();
    let inverse_bind = inverse_bind.filter(|list| list.len() == joints).ok_or_else(|| {
        let lengths: Vec<usize> = description.inverse_bind.iter().map(Vec::len).collect();
        Error::NotModel(format!("inverse_bind: wanted {joints} lists of 12 numbers, found lengths {lengths:?}"))
    })?;
    finite("inverse_bind", inverse_bind.as_flattened())?;
    let mean = file.f32("pose.mean", &[Some(12 * joints)])?.0;
    let std = file.f32("pose.std", &[Some(12 * joints)])?.0;
    positive("pose.std", &std)?;
    let range = range(file, &inverse_bind)?;
    Ok(Rig { frame, root: description.root, joints: description.joints, inverse_bind, mean, std, range })
}

/// The poses seen in training; `None` where the file does not tell.
fn range(file: &Tensors, inverse_bind: &[Transform]) -> Result<Option<Range>> {
    if !["pose.min", "pose.max"].iter().any(|name| file.tensors.contains_key(*name)) {
        return Ok(None);
    }
    let read = |name| Ok(file.f32(name, &[Some(12 * inverse_bind.len())])?.0);
    let (min, max) = (read("pose.min")?, read("pose.max")?);
    match min.iter().zip(&max).position(|(min, max)| min > max) {
        Some(element) => Err(Error::NotModel(format!(
            "pose.min is above pose.max at element {element}: {} and {}",
            Decimal(min[element]),
            Decimal(max[element])
        ))),
        None => Ok(Some(Range::new(inverse_bind, min, max))),
    }
}

fn reference(file: &Tensors, n: usize, joints: usize, edge_scale: f32) -> Result<Reference<Vec<f32>, Vec<u32>>> {
    let (rest, shape) = file.f32("reference.rest", &[None, Some(3)])?;
    let weights = file.f32("reference.weights", &[Some(shape[0]), Some(joints)])?.0;
    let index = file.u32("reference.index", &[Some(n)], shape[0])?;
    let gather = |rows: &[f32], width: usize| -> Vec<f32> {
        index.iter().flat_map(|i| rows[*i as usize * width..][..width].iter().copied()).collect()
    };
    let three = |name: &str| -> Result<[f32; 3]> {
        let values = file.f32(name, &[Some(3)])?.0;
        Ok([values[0], values[1], values[2]])
    };
    let (mean, std) = (three("reference.mean")?, three("reference.std")?);
    positive("reference.std", &std)?;
    positive("edge_scale", &[edge_scale])?;
    let skinning = Skinning::from_dense(&gather(&weights, joints), joints);
    Ok(Reference { rest: gather(&rest, 3), skinning, mean, std, edge_scale })
}

/// `[count, n, 3]` in the file -> vertex-major `[n, 3, count]`, so that one vertex's numbers lie together.
fn basis(file: &Tensors, name: &str, graph: &Graph<Vec<u32>>, differences: bool) -> Result<(Vec<f32>, usize)> {
    let n = graph.offsets.len() - 1;
    let (values, count) = pack::basis(file, name, graph, differences)?;
    if count == 0 {
        return Err(Error::NotModel(format!("{name} holds no matrix")));
    }
    Ok((transpose(&values, count, n * 3), count))
}

/// [rows, columns] -> [columns, rows].
pub(super) fn transpose(values: &[f32], rows: usize, columns: usize) -> Vec<f32> {
    let mut transposed = Vec::with_capacity(rows * columns);
    for column in 0..columns {
        transposed.extend((0..rows).map(|row| values[row * columns + column]));
    }
    transposed
}

fn linear(file: &Tensors, name: &str, inputs: Option<usize>, outputs: Option<usize>) -> Result<Linear<Vec<f32>>> {
    let (weight, shape) = file.f32(&format!("{name}.weight"), &[outputs, inputs])?;
    if shape.contains(&0) {
        let (tensor, found) = (format!("{name}.weight"), format!("{shape:?}"));
        return Err(Error::Shape { tensor, wanted: "at least one row and column".to_owned(), found });
    }
    let bias = file.f32(&format!("{name}.bias"), &[Some(shape[0])])?.0;
    Ok(Linear { weight: transpose(&weight, shape[0], shape[1]), bias, inputs: shape[1], outputs: shape[0] })
}

/// How many layers `{name}.0`, `{name}.1`, … there are; a layer is there if any part of it is.
fn count(file: &Tensors, name: &str) -> usize {
    let any = |i: &usize| {
        let prefix = format!("{name}.{i}.");
        file.tensors.range(prefix.clone()..).next().is_some_and(|(key, _)| key.starts_with(&prefix))
    };
    (0..).take_while(any).count()
}

/// Layers `{name}.0`, `{name}.1`, … as many as there are; the last one has `outputs`.
fn mlp(file: &Tensors, name: &str, inputs: usize, outputs: Option<usize>) -> Result<Vec<Linear<Vec<f32>>>> {
    let count = count(file, name);
    let (mut layers, mut inputs) = (Vec::new(), inputs);
    for i in 0..count.max(1) {
        let last = if i + 1 == count { outputs } else { None };
        let layer = linear(file, &format!("{name}.{i}"), Some(inputs), last)?;
        inputs = layer.outputs;
        layers.push(layer);
    }
    Ok(layers)
}

fn layers(file: &Tensors, surrounded: bool) -> Result<Vec<Layer<Vec<f32>>>> {
    let (mut layers, mut inputs) = (Vec::new(), if surrounded { surroundings::INPUTS } else { 3 });
    for l in 0..count(file, "graph") {
        let layer = layer(file, l, inputs)?;
        inputs = layer.project.outputs / 4;
        layers.push(layer);
    }
    Ok(layers)
}

/// Features of every graph layer, which the heads share.
fn features(layers: &[Layer<Vec<f32>>], heads: usize) -> Result<usize> {
    let features = layers.first().map_or(0, |layer| layer.project.outputs / 4);
    if features == 0 || layers.iter().any(|layer| layer.project.outputs != 4 * features) {
        return Err(Error::NotModel("graph: wanted one layer or more, all of one width".to_owned()));
    }
    if heads == 0 || !features.is_multiple_of(heads) {
        return Err(Error::NotModel(format!("{heads} heads do not divide {features} features")));
    }
    Ok(features)
}

fn layer(file: &Tensors, l: usize, inputs: usize) -> Result<Layer<Vec<f32>>> {
    let name = |part: &str| format!("graph.{l}.{part}");
    let query = linear(file, &name("query"), Some(inputs), None)?;
    let features = query.outputs;
    let other = |part: &str| linear(file, &name(part), Some(inputs), Some(features));
    let parts = [query, other("key")?, other("value")?, other("skip")?];
    let rows = |input: usize| parts.iter().flat_map(move |part| &part.weight[input * features..][..features]);
    let vector = |part: &str, size: usize| Ok(file.f32(&name(part), &[Some(size)])?.0);
    Ok(Layer {
        project: Linear {
            weight: (0..inputs).flat_map(rows).copied().collect(),
            bias: parts.iter().flat_map(|part| &part.bias).copied().collect(),
            inputs,
            outputs: 4 * features,
        },
        edge: transpose(&file.f32(&name("edge.weight"), &[Some(features), Some(6)])?.0, features, 6),
        gate: vector("gate.weight", 3 * features)?,
        norm_weight: vector("norm.weight", features)?,
        norm_bias: vector("norm.bias", features)?,
    })
}

/// What draws a mesh of `n` vertices: the cloth, or what rides on it.
fn surface(file: &Tensors, n: usize) -> Result<Option<Surface>> {
    if !["draw.vertex", "draw.uv", "draw.triangles"].iter().any(|name| file.tensors.contains_key(*name)) {
        return Ok(None);
    }
    let vertex = file.u32("draw.vertex", &[None], n)?;
    let uv = file.f32("draw.uv", &[Some(vertex.len()), Some(2)])?.0;
    let triangles = file.u32("draw.triangles", &[None, Some(3)], vertex.len())?;
    Ok(Some(Surface { vertex, uv, triangles }))
}

pub(super) fn finite(what: &str, values: &[f32]) -> Result<()> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(element) => Err(Error::NotFinite { what: what.to_owned(), element, found: values[element] }),
        None => Ok(()),
    }
}

fn positive(what: &str, values: &[f32]) -> Result<()> {
    match values.iter().position(|value| !(value.is_finite() && *value > 0.0)) {
        Some(element) => Err(Error::NotPositive { what: what.to_owned(), element, found: values[element] }),
        None => Ok(()),
    }
}
