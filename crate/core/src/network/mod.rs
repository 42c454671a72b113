//! The network, written once: the paper's figure as a function over any device. network.md §2–4.

mod embedding;
mod graph;

use crate::device::{Device, Space};
use crate::model::Model;

/// Which part of the network runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Streams {
    /// Both residual streams: the whole network.
    Both,
    /// The skeleton stream only: the coarse prediction.
    Skeleton,
    /// No stream: the template skinned with `W_C^I`.
    None,
}

/// A model on the storage of device `D`.
pub type DeviceModel<D> = Model<<D as Device>::Buffer, <D as Device>::Indices>;

/// Every intermediate result, named as the golden files name it. Allocated once.
pub struct Activations<B> {
    /// Pose vector γ [12J].
    pub pose: B,
    /// `N·A_j`, then `N⁻¹` [J + 1, 3, 4].
    pub body_frame: B,
    /// Outputs of Φ's layers; the last is P [m].
    pub embedding: Vec<B>,
    /// Δ_S [n, 3].
    pub skeleton: B,
    /// V [n, 3].
    pub reference: B,
    /// h⁰ [n, 3].
    pub nodes: B,
    /// [V ; T_C] / edge_scale [n, 6].
    pub potentials: B,
    /// Graph layers.
    pub layers: Vec<LayerActivations<B>>,
    /// Outputs of the vertex-level MLP's layers; the last is w [n, k].
    pub vertex: Vec<B>,
    /// Δ_M [n, 3].
    pub mesh: B,
    /// T_C + Δ_S [n, 3].
    pub coarse: B,
    /// T_C(γ) [n, 3].
    pub template: B,
    /// Predicted positions [n, 3].
    pub positions: B,
}

/// Intermediate results of one graph layer.
pub struct LayerActivations<B> {
    /// q | k | v | r [n, 4F].
    pub projected: B,
    /// ĥ [n, F].
    pub attended: B,
    /// h [n, F].
    pub output: B,
}

impl<B> Activations<B> {
    /// Room for every result of `model`; `buffer(length)` makes one.
    pub fn new<C, I>(model: &Model<C, I>, mut buffer: impl FnMut(usize) -> B) -> Self {
        let (n, joints) = (model.sizes.vertices, model.sizes.joints);
        let layer = |buffer: &mut dyn FnMut(usize) -> B, features: usize| LayerActivations {
            projected: buffer(n * 4 * features),
            attended: buffer(n * features),
            output: buffer(n * features),
        };
        Self {
            pose: buffer(12 * joints),
            body_frame: buffer(12 * (joints + 1)),
            embedding: model.embedding.iter().map(|layer| buffer(layer.outputs)).collect(),
            skeleton: buffer(n * 3),
            reference: buffer(n * 3),
            nodes: buffer(n * 3),
            potentials: buffer(n * 6),
            layers: model.layers.iter().map(|_| layer(&mut buffer, model.sizes.features)).collect(),
            vertex: model.vertex.iter().map(|layer| buffer(n * layer.outputs)).collect(),
            mesh: buffer(n * 3),
            coarse: buffer(n * 3),
            template: buffer(n * 3),
            positions: buffer(n * 3),
        }
    }
}

/// Pose and body frame (written before) -> template and positions in `space`.
pub fn forward<D: Device>(
    device: &mut D,
    model: &DeviceModel<D>,
    streams: Streams,
    space: Space,
    a: &mut Activations<D::Buffer>,
) {
    if streams == Streams::None {
        return device.skin(&model.rest, &model.reference.skin, &a.body_frame, space, &mut a.positions);
    }
    embedding::skeleton(device, model, a);
    if streams == Streams::Skeleton {
        return device.skin(&a.coarse, &model.skin, &a.body_frame, space, &mut a.positions);
    }
    graph::mesh(device, model, a);
    device.add(&a.coarse, &a.mesh, &mut a.template);
    device.skin(&a.template, &model.skin, &a.body_frame, space, &mut a.positions);
}
