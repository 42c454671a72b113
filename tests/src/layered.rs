//! A tube of cloth, and a drawn mesh of two layers with pockets that rides on it.

use crate::random::{self, Shape};
use ctsn_core::model::{Cut, HostModel, Ride, Skinning, Surface};
use ctsn_core::suite::numbers;
use ctsn_core::topology::Graph;
use fastrand::Rng;
use std::f32::consts::TAU;

/// Cloth vertices around and along the tube: 4,000.
const CLOTH: [u32; 2] = [80, 50];
/// Drawn vertices around and along a layer.
const LAYER: [u32; 2] = [150, 70];
/// Drawn vertices along a side of a pocket.
const POCKET: u32 = 13;

/// Riders in the making.
#[derive(Default)]
struct Riders {
    corners: Vec<u32>,
    coordinates: Vec<f32>,
    triangles: Vec<u32>,
}

impl Riders {
    /// A grid of riders at these shares of the way around and along, so far outside the cloth, metres.
    fn grid(&mut self, [columns, rows]: [u32; 2], place: impl Fn(f32, f32) -> [f32; 2], offset: f32) {
        let first = self.corners.len() as u32 / 3;
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let [around, along] = place(column as f32 / columns as f32, row as f32 / (rows - 1) as f32);
            let (x, y) = (around.fract() * CLOTH[0] as f32, along * (CLOTH[1] - 1) as f32);
            let (i, j) = (x as u32 % CLOTH[0], (y as u32).min(CLOTH[1] - 2));
            let (u, v) = (x - x.floor(), y - j as f32);
            let at = |i: u32, j: u32| j * CLOTH[0] + i % CLOTH[0];
            let (corners, shares) = if u + v <= 1.0 {
                ([at(i, j), at(i + 1, j), at(i, j + 1)], [1.0 - u - v, u, v])
            } else {
                ([at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)], [u + v - 1.0, 1.0 - u, 1.0 - v])
            };
            self.corners.extend(corners);
            self.coordinates.extend(shares);
            self.coordinates.push(offset);
        }
        for (row, column) in (0..rows - 1).flat_map(|row| (0..columns - 1).map(move |column| (row, column))) {
            let a = first + row * columns + column;
            self.triangles.extend([a, a + columns, a + 1, a + 1, a + columns, a + columns + 1]);
        }
    }
}

/// A model of 4,000 cloth vertices with random weights, on which 21,338 drawn ones ride, some of them split at a seam.
pub fn model(rng: &mut Rng) -> HostModel {
    let n = (CLOTH[0] * CLOTH[1]) as usize;
    let shape = Shape { vertices: n, joints: 2, embedding: 3, basis: 2, heads: 1, per_head: 4, layers: 1 };
    let mut model = random::model(rng, shape);
    let place = |v: u32| {
        let (turn, height) = (TAU * (v % CLOTH[0]) as f32 / CLOTH[0] as f32, (v / CLOTH[0]) as f32 / 62.0);
        [0.3 * turn.sin(), -height, 0.3 * turn.cos()]
    };
    model.rest = (0..n as u32).flat_map(place).collect();
    let at = |i: u32, j: u32| j * CLOTH[0] + i % CLOTH[0];
    let square = |v: u32| {
        let (i, j) = (v % CLOTH[0], v / CLOTH[0]);
        [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]
    };
    model.triangles = (0..CLOTH[0] * (CLOTH[1] - 1)).flat_map(square).collect();
    model.graph = Graph::new(n, &model.triangles);
    model.cut = Some(Cut::new(model.rest.clone(), &model.graph, 4).expect("edges"));
    let share = |v: usize| (v / CLOTH[0] as usize) as f32 / CLOTH[1] as f32;
    let weights = (0..n).flat_map(|v| [share(v), 1.0 - share(v)]).collect();
    model.skinning = Skinning { joints: [0, 1].repeat(n), weights, width: 2 };
    model.skeleton_basis = numbers(rng, n * 3 * shape.embedding, 1e-3);
    model.mesh_basis = numbers(rng, n * 3 * shape.basis, 1e-3);
    let mut riders = Riders::default();
    riders.grid(LAYER, |x, y| [x, y], 0.001);
    // Its lining, and pockets.
    riders.grid(LAYER, |x, y| [x, y], -0.002);
    for side in [0.1, 0.6] {
        riders.grid([POCKET; 2], |x, y| [side + 0.1 * x, 0.2 + 0.2 * y], 0.004);
    }
    let count = riders.corners.len() as u32 / 3;
    let vertex: Vec<u32> = (0..count).chain((0..LAYER[1]).map(|row| row * LAYER[0])).collect();
    let surface = Surface { uv: vec![0.5; 2 * vertex.len()], vertex, triangles: riders.triangles };
    model.ride = Some(Ride::new(riders.corners, riders.coordinates, &surface));
    model.surface = Some(surface);
    model
}

/// The model's cloth as what rides on it: every vertex on its own place.
pub fn itself(model: &HostModel) -> HostModel {
    let n = model.sizes.vertices as u32;
    let corners = (0..n).flat_map(|v| [v, (v + 1) % n, (v + 2) % n]).collect();
    let coordinates = (0..n).flat_map(|_| [1.0, 0.0, 0.0, 0.0]).collect();
    let triangles = model.triangles.clone();
    let surface = Surface { vertex: (0..n).collect(), uv: vec![0.0; 2 * n as usize], triangles };
    let ride = Some(Ride::new(corners, coordinates, &surface));
    HostModel { surface: Some(surface), ride, ..model.clone() }
}
