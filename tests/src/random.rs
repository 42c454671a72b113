//! Models of awkward sizes with random weights, and random poses for them.

use ctsn_core::cpu::network::body_frame::rig;
use ctsn_core::model::surroundings::{DIRECTIONS, INPUTS, surroundings};
use ctsn_core::model::{Cut, HostModel, Layer, Linear, Reference, Sizes, Skinning, Surface};
use ctsn_core::suite::{numbers, transform, triangles};
use ctsn_core::topology::Graph;
use fastrand::Rng;
use std::sync::Arc;

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

fn linear(rng: &mut Rng, inputs: usize, outputs: usize) -> Linear<Vec<f32>> {
    let weight = numbers(rng, inputs * outputs, (3.0 / inputs as f32).sqrt());
    Linear { weight, bias: numbers(rng, outputs, 0.1), inputs, outputs }
}

fn skinning(rng: &mut Rng, n: usize, joints: usize, width: usize) -> Skinning<Vec<f32>, Vec<u32>> {
    let joints = (0..n * width).map(|_| rng.u32(..joints as u32)).collect();
    let weights = numbers(rng, n * width, 0.5).iter().map(|weight| 1.0 / width as f32 + 0.2 * weight).collect();
    Skinning { joints, weights, width }
}

/// A pose [J, 3, 4], row-major.
pub fn pose(rng: &mut Rng, joints: usize) -> Vec<f32> {
    (0..joints).flat_map(|_| transform(rng)).collect()
}

/// A pose [J, 3, 4], row-major -> [J, 16], column-major.
pub fn column_major(pose: &[f32]) -> Vec<f32> {
    let column =
        |transform: &[f32], e: usize| if e % 4 == 3 { [0.0, 1.0][e / 15] } else { transform[e % 4 * 4 + e / 4] };
    pose.chunks_exact(12).flat_map(|transform| (0..16).map(move |e| column(transform, e))).collect()
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
    let graph = Graph::new(n, &triangles);
    let drawn: Vec<u32> = (0..n + n / 3).map(|_| rng.u32(..n as u32)).collect();
    HostModel {
        sizes: Sizes { vertices: n, joints, embedding, basis, features, heads },
        rig: Arc::new(rig(rng, joints, true)),
        graph: graph.clone(),
        triangles,
        rest: numbers(rng, n * 3, 1.0),
        skinning: skinning(rng, n, joints, 3),
        reference: Reference {
            rest: numbers(rng, n * 3, 1.0),
            skinning: skinning(rng, n, joints, 2),
            mean: [0.1, 0.9, 0.0],
            std: [0.3, 0.5, 0.2],
            edge_scale: 0.5,
        },
        surroundings: None,
        embedding: vec![linear(rng, 12 * joints, 9), linear(rng, 9, embedding)],
        skeleton_basis: numbers(rng, n * 3 * embedding, 0.1),
        layers: (0..layers).map(|l| layer(rng, if l == 0 { 3 } else { features })).collect(),
        vertex_mlp: vec![linear(rng, features, 11), linear(rng, 11, basis)],
        mesh_basis: numbers(rng, n * 3 * basis, 0.1),
        mesh_stream: true,
        surface: Some(Surface { uv: vec![0.0; 2 * drawn.len()], vertex: drawn, triangles: Vec::new() }),
        ride: None,
        cut: Some(Cut::new(numbers(rng, n * 3, 1.0), &graph, 4).expect("no two vertices at one place")),
        body: None,
        training: None,
    }
}

/// The same model, but that its mesh stream sees what is around each vertex of the coarse cloth.
pub fn surrounded(rng: &mut Rng, mut model: HostModel) -> HostModel {
    let n = model.sizes.vertices;
    let compass: Vec<u32> = (0..n * DIRECTIONS).map(|_| rng.u32(..n as u32)).collect();
    model.surroundings = Some(surroundings(&compass));
    model.layers[0].project = linear(rng, INPUTS, 4 * model.sizes.features);
    model
}
