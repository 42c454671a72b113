//! Mesh-based residual stream: graph transformer over the reference mesh, vertex MLP, `Δ_M[i] = Σ_j w_ij M_j[i]`. network.md §3.

use super::{Activations, DeviceModel, LayerActivations};
use crate::device::{Activation, Device, Space};

/// Body frame and T_C + Δ_S -> Δ_M and T_C(γ).
pub(super) fn mesh<D: Device>(device: &mut D, model: &DeviceModel<D>, a: &mut Activations<D::Buffer>) {
    let reference = &model.reference;
    device.skin(&reference.rest, &reference.skin, &a.body_frame, Space::Body, &mut a.reference);
    device.features(&a.reference, &model.rest, reference, &mut a.nodes, &mut a.potentials);
    for (l, layer) in model.layers.iter().enumerate() {
        let (before, after) = a.layers.split_at_mut(l);
        let h = before.last().map_or(&a.nodes, |layer| &layer.output);
        let LayerActivations { projected, attended, output } = &mut after[0];
        device.linear(h, &layer.project, Activation::None, projected);
        device.attend(&model.graph, model.sizes, projected, &a.potentials, layer, attended, output);
    }
    for (i, layer) in model.vertex.iter().enumerate() {
        let (before, after) = a.vertex.split_at_mut(i);
        let h = before.last().or(a.layers.last().map(|layer| &layer.output)).unwrap_or(&a.nodes);
        device.linear(h, layer, Activation::Relu, &mut after[0]);
    }
    let weights = a.vertex.last().unwrap_or(&a.nodes);
    device.blend(weights, &model.mesh, &a.coarse, &a.confidence, &mut a.mesh, &mut a.template);
}
