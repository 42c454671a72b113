//! Spheres for bodies.

use crate::random::{self, Shape};
use ctsn_core::model::{Body, HostModel, Skinning};
use ctsn_core::suite;
use ctsn_core::topology::Graph;
use fastrand::Rng;
use std::sync::Arc;

/// Radius of [`sphere`], metres.
pub const RADIUS: f32 = 0.05;
/// Its vertices around.
pub const AROUND: u32 = 24;
/// Its rings from pole to pole.
pub const RINGS: u32 = 13;

/// A sphere as a closed mesh: positions [b, 3], triangles.
pub fn sphere() -> (Vec<f32>, Vec<u32>) {
    suite::sphere(RADIUS, AROUND, RINGS)
}

/// A sphere that follows the first joint, for `n` cloth vertices.
pub fn body(n: usize) -> Body<Vec<f32>, Vec<u32>> {
    let (positions, triangles) = sphere();
    let count = positions.len() / 3;
    Body::new(positions, follow(count), triangles, (0..4 * n).map(|i| (i % count) as u32).collect())
}

/// A cloth of loose points, `places` [n, 3], that follows one joint with a body of these positions and triangles.
pub fn model(rng: &mut Rng, places: Vec<f32>, positions: Vec<f32>, triangles: Vec<u32>) -> HostModel {
    let n = places.len() / 3;
    let shape = Shape { vertices: n, joints: 1, embedding: 1, basis: 1, heads: 1, per_head: 2, layers: 1 };
    let mut model = random::model(rng, shape);
    (model.rest, model.skinning, model.triangles) = (places, follow(n), Vec::new());
    (model.skeleton_basis, model.mesh_basis, model.surface) = (vec![0.0; 3 * n], vec![0.0; 3 * n], None);
    (model.graph, model.cut) = (Graph::new(n, &[]), None);
    Arc::make_mut(&mut model.rig).inverse_bind = vec![[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]];
    let vertices = positions.len() / 3;
    let seeds = (0..4 * n).map(|_| rng.u32(..vertices as u32)).collect();
    model.body = Some(Body::new(positions, follow(vertices), triangles, seeds));
    model
}

/// `count` vertices that follow the first joint.
fn follow(count: usize) -> Skinning<Vec<f32>, Vec<u32>> {
    Skinning { joints: vec![0; count], weights: vec![1.0; count], width: 1 }
}

/// Length of a vector.
pub fn length(point: &[f32]) -> f32 {
    point.iter().map(|c| c * c).sum::<f32>().sqrt()
}
