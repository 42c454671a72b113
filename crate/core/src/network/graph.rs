//! Mesh-based residual stream: graph transformer over the reference mesh, vertex MLP, `Δ_M[i] = Σ_j w_ij M_j[i]`.
//! network.md §3.

use super::{Activations, DeviceModel, Workings, skin};
use crate::device::Device;
use crate::model::{Layer, Skinning};
use crate::operation::{Activation, Attend, Blend, Features, Linear, Space, Surround};
use crate::topology::Graph;

/// Body frame and T_C + Δ_S -> Δ_M and T_C(γ).
pub(crate) fn mesh<D: Device>(device: &mut D, model: &DeviceModel<D>, a: &mut Activations<D::Buffer>) {
    let reference = &model.reference;
    let (rest, skinning) = match &model.surroundings {
        Some(_) => (&a.coarse, &model.skinning),
        None => (&reference.rest, &reference.skinning),
    };
    skin(device, rest, skinning, &a.body_frame, Space::Body, &mut a.reference);
    let features = Features {
        v: &a.reference,
        rest: &model.rest,
        mean: reference.mean,
        deviation: reference.std,
        edge_scale: reference.edge_scale,
        nodes: &mut a.nodes,
        potentials: &mut a.potentials,
    };
    device.run(features.into());
    if let (Some(around), Some(nodes)) = (&model.surroundings, &mut a.surroundings) {
        let (potentials, places, Skinning { joints, weights, .. }) = (&a.potentials, &a.nodes, &model.skinning);
        let transforms = &a.body_frame;
        device.run(Surround { potentials, places, joints, weights, transforms, around, nodes }.into());
    }
    let nodes = a.surroundings.as_ref().unwrap_or(&a.nodes);
    for (l, layer) in model.layers.iter().enumerate() {
        let (before, after) = a.layers.split_at_mut(l);
        let (h, each) = (before.last().unwrap_or(nodes), a.workings.len());
        let room = (&mut a.workings[l % each], &mut after[0]);
        graph_layer(device, (&model.graph, model.sizes.heads), layer, [h, &a.potentials], room);
    }
    for (i, layer) in model.vertex_mlp.iter().enumerate() {
        let (before, after) = a.vertex_mlp.split_at_mut(i);
        let x = before.last().or(a.layers.last()).unwrap_or(nodes);
        let (weight, bias, activation) = (&layer.weight, &layer.bias, Activation::Relu);
        device.run(Linear { x, weight, bias, activation, y: &mut after[0] }.into());
    }
    let blend = Blend {
        weights: a.vertex_mlp.last().unwrap_or(nodes),
        basis: &model.mesh_basis,
        rest: &a.coarse,
        share: &a.mesh_share,
        residual: &mut a.mesh,
        template: &mut a.template,
    };
    device.run(blend.into());
}

/// One layer over a graph with so many heads: h [n, inputs] and edge potentials [n, 6] -> the next h.
pub fn graph_layer<D: Device>(
    device: &mut D,
    (graph, heads): (&Graph<D::Indices>, usize),
    layer: &Layer<D::Buffer>,
    [h, potentials]: [&D::Buffer; 2],
    (Workings { projected, attended }, output): (&mut Workings<D::Buffer>, &mut D::Buffer),
) {
    let (weight, bias) = (&layer.project.weight, &layer.project.bias);
    device.run(Linear { x: h, weight, bias, activation: Activation::None, y: &mut *projected }.into());
    let attend = Attend {
        offsets: &graph.offsets,
        neighbours: &graph.neighbours,
        heads,
        projected,
        potentials,
        edge: &layer.edge,
        gate: &layer.gate,
        norm_weight: &layer.norm_weight,
        norm_bias: &layer.norm_bias,
        attended,
        output,
    };
    device.run(attend.into());
}
