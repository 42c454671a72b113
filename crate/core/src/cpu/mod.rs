//! The CPU device: one file per operation, kernels generic over the SIMD level, dispatched once per call.
//! The same source serves AVX2, NEON, wasm simd128 and the scalar level, which is the reference.

pub mod attend;
pub mod blend;
pub mod body_frame;
pub mod bury;
pub mod closest;
pub mod collide;
pub mod eight;
pub mod exp;
pub mod features;
pub mod gate;
pub mod linear;
pub mod normals;
pub mod settle;
pub mod skin;
pub mod spread;
pub mod surface;
pub mod vector;

use crate::device::{Activation, Device, Space};
use crate::model::{Body, Layer, Linear, Reference, Sizes, Skin};
use crate::network::Drawn;
use crate::pose::Rig;
use crate::topology::Graph;
pub use fearless_simd::Level;

/// The CPU: level of SIMD and scratch space that grows to its final size in the first frame.
pub struct Cpu {
    level: Level,
    scratch: attend::Scratch,
    rings: closest::Rings,
    dipoles: bury::Dipoles,
}

impl Cpu {
    /// The best level this machine has.
    pub fn new() -> Self {
        Self::with_level(Level::new())
    }

    /// A chosen level.
    pub fn with_level(level: Level) -> Self {
        let (scratch, rings, dipoles) = Default::default();
        Self { level, scratch, rings, dipoles }
    }
}

impl Default for Cpu {
    fn default() -> Self {
        Self::new()
    }
}

impl Device for Cpu {
    type Buffer = Vec<f32>;
    type Indices = Vec<u32>;

    fn buffer(&mut self, values: &[f32]) -> Vec<f32> {
        values.to_vec()
    }

    fn indices(&mut self, indices: &[u32]) -> Vec<u32> {
        indices.to_vec()
    }

    fn write(&mut self, buffer: &mut Vec<f32>, values: &[f32]) {
        buffer.copy_from_slice(values);
    }

    fn body_frame(&mut self, rig: &Rig, joints: &Vec<f32>, transforms: &mut Vec<f32>, vector: &mut Vec<f32>) {
        body_frame::body_frame(rig, joints, transforms, vector);
    }

    fn linear(&mut self, x: &Vec<f32>, layer: &Linear<Vec<f32>>, activation: Activation, y: &mut Vec<f32>) {
        linear::linear(self.level, x, &layer.weight, &layer.bias, activation, y);
    }

    fn blend(
        &mut self,
        weights: &Vec<f32>,
        basis: &Vec<f32>,
        rest: &Vec<f32>,
        confidence: &Vec<f32>,
        residual: &mut Vec<f32>,
        template: &mut Vec<f32>,
    ) {
        blend::blend(self.level, weights, basis, rest, confidence[0], residual, template);
    }

    fn skin(
        &mut self,
        rest: &Vec<f32>,
        skin: &Skin<Vec<f32>, Vec<u32>>,
        transforms: &Vec<f32>,
        space: Space,
        positions: &mut Vec<f32>,
    ) {
        skin::skin(self.level, rest, &skin.joints, &skin.weights, transforms, space, positions);
    }

    fn features(
        &mut self,
        v: &Vec<f32>,
        rest: &Vec<f32>,
        reference: &Reference<Vec<f32>, Vec<u32>>,
        nodes: &mut Vec<f32>,
        potentials: &mut Vec<f32>,
    ) {
        features::features(v, rest, &reference.mean, &reference.std, reference.edge_scale, nodes, potentials);
    }

    fn attend(
        &mut self,
        graph: &Graph<Vec<u32>>,
        sizes: Sizes,
        projected: &mut Vec<f32>,
        potentials: &Vec<f32>,
        layer: &Layer<Vec<f32>>,
        attended: &mut Vec<f32>,
        output: &mut Vec<f32>,
    ) {
        attend::attend(self.level, graph, sizes.heads, projected, potentials, &layer.edge, &mut self.scratch, attended);
        gate::gate(self.level, attended, projected, &layer.gate, &layer.norm_weight, &layer.norm_bias, output);
    }

    fn normals(&mut self, positions: &Vec<f32>, triangles: &[u32], normals: &mut Vec<f32>) {
        normals::normals(positions, triangles, normals);
    }

    fn bury(&mut self, body: &Body<Vec<f32>, Vec<u32>>, posed: &Vec<f32>, normals: &Vec<f32>, exposed: &mut Vec<f32>) {
        let range = bury::buriable(body.vertices);
        bury::bury(self.level, posed, normals, &body.areas, range, &mut self.dipoles, exposed);
    }

    fn collide(
        &mut self,
        body: &Body<Vec<f32>, Vec<u32>>,
        exposed: &Vec<f32>,
        normals: &Vec<f32>,
        positions: &Vec<f32>,
        push: &mut Vec<f32>,
    ) {
        collide::collide(self.level, positions, &at(body, exposed, normals, &mut self.rings), &body.seeds, push);
    }

    fn spread(&mut self, graph: &Graph<Vec<u32>>, push: &Vec<f32>, before: &Vec<f32>, after: &mut Vec<f32>) {
        spread::spread(graph, push, before, after);
    }

    fn settle(
        &mut self,
        body: &Body<Vec<f32>, Vec<u32>>,
        exposed: &Vec<f32>,
        normals: &Vec<f32>,
        displacement: &Vec<f32>,
        positions: &mut Vec<f32>,
    ) {
        settle::settle(self.level, displacement, &at(body, exposed, normals, &mut self.rings), &body.seeds, positions);
    }

    fn surface(&mut self, vertex: &[u32], positions: &Vec<f32>, normals: &Vec<f32>, drawn: &mut Drawn<Vec<f32>>) {
        surface::surface(vertex, positions, &mut drawn.positions);
        surface::surface(vertex, normals, &mut drawn.normals);
    }
}

/// The body where it is posed. (`settle` gathers the rings again, 0.02 ms: what `collide` saw is not taken for granted.)
fn at<'a>(
    body: &'a Body<Vec<f32>, Vec<u32>>,
    positions: &'a [f32],
    normals: &'a [f32],
    rings: &'a mut closest::Rings,
) -> closest::Posed<'a> {
    let (positions, offsets, fans) = (positions.as_chunks().0, &body.fans.offsets, body.fans.corners.as_chunks().0);
    rings.pose(positions, offsets, fans);
    closest::Posed { positions, normals: normals.as_chunks().0, offsets, fans, rings }
}
