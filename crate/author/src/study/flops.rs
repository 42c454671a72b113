//! Arithmetic of one prediction, counted by the network itself: a device that computes nothing and adds up what the others would.
//! A multiplication and an addition count one each, and so does every exponential, division and root.

use ctsn_core::device::{Activation, Device, Space};
use ctsn_core::model::{Body, HostModel, Layer, Linear, Reference, Sizes, Skin};
use ctsn_core::network::{Activations, Drawn, Streams, forward};
use ctsn_core::pose::Rig;
use ctsn_core::topology::Graph;

/// Operations counted so far. A buffer is its length.
#[derive(Default)]
struct Count(usize);

/// Floating-point operations of one prediction by `streams` of `model`; normals and the repair of penetration are not counted.
pub fn flops(model: &HostModel, streams: Streams) -> usize {
    let mut count = Count::default();
    let lengths = model.map(Vec::len, Vec::len);
    let mut activations = Activations::new(&lengths, |_, length| length);
    forward(&mut count, &lengths, streams, Space::World, &mut activations);
    count.0
}

impl Device for Count {
    type Buffer = usize;
    type Indices = usize;

    fn buffer(&mut self, values: &[f32]) -> usize {
        values.len()
    }

    fn indices(&mut self, indices: &[u32]) -> usize {
        indices.len()
    }

    fn write(&mut self, buffer: &mut usize, values: &[f32]) {
        *buffer = values.len();
    }

    fn linear(&mut self, x: &usize, layer: &Linear<usize>, _: Activation, _: &mut usize) {
        self.0 += x / layer.inputs * layer.outputs * (2 * layer.inputs + 1);
    }

    fn body_frame(&mut self, _: &Rig, _: &usize, _: &mut usize, _: &mut usize) {}

    fn blend(&mut self, _: &usize, basis: &usize, rest: &usize, _: &usize, _: &mut usize, _: &mut usize) {
        self.0 += 2 * basis + 2 * rest;
    }

    fn skin(&mut self, rest: &usize, skin: &Skin<usize, usize>, _: &usize, space: Space, _: &mut usize) {
        // Matrices blended, then applied; once more for N⁻¹.
        let applied = if space == Space::World { 2 } else { 1 };
        self.0 += 24 * skin.weights + applied * 18 * (rest / 3);
    }

    fn features(
        &mut self,
        v: &usize,
        _: &usize,
        _: &Reference<usize, usize>,
        nodes: &mut usize,
        potentials: &mut usize,
    ) {
        debug_assert_eq!(v, nodes);
        self.0 += 2 * *nodes + *potentials;
    }

    fn attend(
        &mut self,
        graph: &Graph<usize>,
        sizes: Sizes,
        _: &mut usize,
        potentials: &usize,
        _: &Layer<usize>,
        attended: &mut usize,
        _: &mut usize,
    ) {
        // The edge term U and its two additions; per edge the logits, their softmax and the weighted sum; U taken off again.
        let vertices = potentials / 6;
        let edges = graph.neighbours;
        let features = *attended / vertices;
        self.0 += vertices * features * (2 * 6 + 2) + edges * (4 * features + 4 * sizes.heads) + vertices * features;
        // The gate: difference, three dot products, blend; LayerNorm: mean, variance, scale and shift.
        self.0 += *attended * (1 + 6 + 2 + 7);
    }

    fn normals(&mut self, _: &usize, _: &[u32], _: &mut usize) {}

    fn bury(&mut self, _: &Body<usize, usize>, _: &usize, _: &usize, _: &mut usize) {}

    fn collide(&mut self, _: &Body<usize, usize>, _: &usize, _: &usize, _: &usize, _: &mut usize) {}

    fn spread(&mut self, _: &Graph<usize>, _: &usize, _: &usize, _: &mut usize) {}

    fn settle(&mut self, _: &Body<usize, usize>, _: &usize, _: &usize, _: &usize, _: &mut usize) {}

    fn surface(&mut self, _: &[u32], _: &usize, _: &usize, _: &mut Drawn<usize>) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use crate::train::{Architecture, initial};

    fn model(architecture: Architecture) -> HostModel {
        let (setup, samples) = synthetic::dataset(200, 3, 2);
        let samples: Vec<_> = samples.iter().collect();
        initial(&setup, &samples, architecture, 1).expect("a model")
    }

    fn whole(change: impl FnOnce(&mut Architecture)) -> usize {
        let mut architecture = Architecture { embedding: 8, basis: 8, layers: 1, heads: 2, features: 16 };
        change(&mut architecture);
        flops(&model(architecture), Streams::Both)
    }

    #[test]
    fn each_size_costs_what_its_matrices_have() {
        let made = model(Architecture::default());
        let (n, edges) = (made.sizes.vertices, made.graph.neighbours.len());
        let base = whole(|_| {});
        // One more embedding: a column of Φ's last layer and a matrix B.
        let last = made.embedding.last().expect("a layer").inputs;
        assert_eq!(whole(|a| a.embedding += 1) - base, 2 * last + 1 + 2 * 3 * n);
        // One more basis matrix M: the vertex MLP's last layer has a column more, at every vertex.
        let last = made.vertex.last().expect("a layer").inputs;
        assert_eq!(whole(|a| a.basis += 1) - base, n * (2 * last + 1) + 2 * 3 * n);
        // One more layer of F = 16: four products F × F, attention over the edges, the gate.
        let layer = n * 64 * (2 * 16 + 1) + n * 16 * 15 + edges * (4 * 16 + 4 * 2) + n * 16 * 16;
        assert_eq!(whole(|a| a.layers += 1) - base, layer);
    }

    #[test]
    fn streams_left_out_cost_nothing() {
        let model = model(Architecture::default());
        let [both, skeleton, none] =
            [Streams::Both, Streams::Skeleton, Streams::None].map(|streams| flops(&model, streams));
        assert!(none < skeleton && skeleton < both);
        let n = model.sizes.vertices;
        assert_eq!(none, 24 * n * model.reference.skin.width + 36 * n);
        let silent = HostModel { mesh_stream: false, ..model };
        assert_eq!(flops(&silent, Streams::Both), skeleton);
    }
}
