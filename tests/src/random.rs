//! Models of awkward sizes with random weights, and random poses for them.

use ctsn_core::model::{HostModel, Layer, Linear, Reference, Sizes, Skin, Surface};
use ctsn_core::pose::{Frame, Range, Rig};
use ctsn_core::topology::Graph;
use fastrand::Rng;

/// Free sizes of a random model.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// `n`.
    pub vertices: usize,
    /// `J`.
    pub joints: usize,
    /// `m`.
    pub embedding: usize,
    /// `k`.
    pub basis: usize,
    /// `C`.
    pub heads: usize,
    /// `d`.
    pub per_head: usize,
    /// `L`.
    pub layers: usize,
}

/// Numbers uniform in ±scale.
fn numbers(rng: &mut Rng, count: usize, scale: f32) -> Vec<f32> {
    (0..count).map(|_| (rng.f32() * 2.0 - 1.0) * scale).collect()
}

fn linear(rng: &mut Rng, inputs: usize, outputs: usize) -> Linear<Vec<f32>> {
    let weight = numbers(rng, inputs * outputs, (3.0 / inputs as f32).sqrt());
    Linear { weight, bias: numbers(rng, outputs, 0.1), inputs, outputs }
}

/// The last vertex has no neighbour, the one before it one, the first up to 40, the others two or more.
fn triangles(rng: &mut Rng, n: usize) -> Vec<u32> {
    let inner = n.saturating_sub(2) as u32;
    let mut triangles: Vec<u32> = (1..inner.min(40)).flat_map(|i| [0, i, i + 1]).filter(|i| *i < inner).collect();
    triangles.truncate(triangles.len() / 3 * 3);
    (40..inner).for_each(|i| triangles.extend([i, 1 + rng.u32(..i - 1), 1 + rng.u32(..i - 1)]));
    if inner > 1 {
        triangles.extend([inner, 1, 1]);
    }
    triangles
}

fn skin(rng: &mut Rng, n: usize, joints: usize, width: usize) -> Skin<Vec<f32>, Vec<u32>> {
    let joints = (0..n * width).map(|_| rng.u32(..joints as u32)).collect();
    let weights = numbers(rng, n * width, 0.5).iter().map(|weight| 1.0 / width as f32 + 0.2 * weight).collect();
    Skin { joints, weights, width }
}

/// A rotation about a random axis and a place within a metre: a row-major 3×4 transform.
fn transform(rng: &mut Rng) -> [f32; 12] {
    let [w, x, y, z]: [f32; 4] = std::array::from_fn(|_| rng.f32() * 2.0 - 1.0 + 1e-3);
    let length = (w * w + x * x + y * y + z * z).sqrt();
    let [w, x, y, z] = [w, x, y, z].map(|c| c / length);
    let [a, b, c]: [f32; 3] = std::array::from_fn(|_| rng.f32() * 2.0 - 1.0);
    [
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - z * w),
        2.0 * (x * z + y * w),
        a,
        2.0 * (x * y + z * w),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - x * w),
        b,
        2.0 * (x * z - y * w),
        2.0 * (y * z + x * w),
        1.0 - 2.0 * (x * x + y * y),
        c,
    ]
}

/// A pose [J, 3, 4], row-major.
pub fn pose(rng: &mut Rng, joints: usize) -> Vec<f32> {
    (0..joints).flat_map(|_| transform(rng)).collect()
}

/// A rig whose range leaves some numbers of a random pose outside.
fn rig(rng: &mut Rng, joints: usize) -> Rig {
    let min = numbers(rng, 12 * joints, 0.5).iter().map(|value| value - 1.5).collect();
    let max = numbers(rng, 12 * joints, 0.5).iter().map(|value| value + 1.5).collect();
    let inverse_bind: Vec<_> = (0..joints).map(|_| transform(rng)).collect();
    Rig {
        frame: if joints.is_multiple_of(2) { Frame::Hip } else { Frame::HipYaw },
        root: joints / 2,
        joints: (0..joints).map(|j| format!("joint {j}")).collect(),
        range: Some(Range::new(&inverse_bind, min, max)),
        inverse_bind,
        mean: numbers(rng, 12 * joints, 0.1),
        std: numbers(rng, 12 * joints, 0.2).iter().map(|value| value + 1.0).collect(),
    }
}

/// A model of that shape.
pub fn model(rng: &mut Rng, shape: Shape) -> HostModel {
    let Shape { vertices: n, joints, embedding, basis, heads, per_head, layers } = shape;
    let features = heads * per_head;
    let layer = |rng: &mut Rng, inputs: usize| Layer {
        project: linear(rng, inputs, 4 * features),
        edge: numbers(rng, 6 * features, 0.3),
        gate: numbers(rng, 3 * features, 0.3),
        norm_weight: numbers(rng, features, 0.5).iter().map(|weight| 1.0 + weight).collect(),
        norm_bias: numbers(rng, features, 0.3),
    };
    let triangles = triangles(rng, n);
    let drawn: Vec<u32> = (0..n + n / 3).map(|_| rng.u32(..n as u32)).collect();
    HostModel {
        sizes: Sizes { vertices: n, joints, embedding, basis, features, heads },
        rig: rig(rng, joints),
        graph: Graph::new(n, &triangles),
        triangles,
        rest: numbers(rng, n * 3, 1.0),
        skin: skin(rng, n, joints, 3),
        reference: Reference {
            rest: numbers(rng, n * 3, 1.0),
            skin: skin(rng, n, joints, 2),
            mean: [0.1, 0.9, 0.0],
            std: [0.3, 0.5, 0.2],
            edge_scale: 0.5,
        },
        embedding: vec![linear(rng, 12 * joints, 9), linear(rng, 9, embedding)],
        skeleton: numbers(rng, n * 3 * embedding, 0.1),
        layers: (0..layers).map(|l| layer(rng, if l == 0 { 3 } else { features })).collect(),
        vertex: vec![linear(rng, features, 11), linear(rng, 11, basis)],
        mesh: numbers(rng, n * 3 * basis, 0.1),
        mesh_stream: true,
        surface: Some(Surface { uv: vec![0.0; 2 * drawn.len()], vertex: drawn, triangles: Vec::new() }),
        body: None,
        training: None,
    }
}
