//! Arithmetic of one prediction, counted by the network itself: a device that computes nothing and adds up what the
//! others would.

use ctsn_core::Streams;
use ctsn_core::device::Device;
use ctsn_core::model::HostModel;
use ctsn_core::network::{Activations, forward};
use ctsn_core::operation::{Operation, Space};

/// Operations counted so far. A buffer is its length.
#[derive(Default)]
struct Count(usize);

/// Floating-point operations of one prediction by `streams` of `model`; normals and the repair of penetration are not
/// counted.
pub fn flops(model: &HostModel, streams: Streams) -> usize {
    let mut count = Count::default();
    let lengths = model.map(Vec::len, Vec::len);
    let mut activations = Activations::new(model, |_, length| length);
    forward(&mut count, &lengths, streams, Space::World, &mut activations);
    count.0
}

impl Device for Count {
    type Buffer = usize;
    type Indices = usize;

    fn run(&mut self, operation: Operation<&usize, &mut usize, &usize>) {
        self.0 += operation.map(|length| *length, |length| *length, |length| *length).flops();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use crate::training::{Architecture, initial};

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
        let last = made.vertex_mlp.last().expect("a layer").inputs;
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
        assert_eq!(none, 24 * n * model.reference.skinning.width + 36 * n);
        let silent = HostModel { mesh_stream: false, ..model };
        assert_eq!(flops(&silent, Streams::Both), skeleton);
    }
}
