//! Skeleton-based residual stream: `P = Φ(γ)`, `Δ_S = Σ_j P_j B_j`. network.md §2.

use super::{Activations, DeviceModel};
use crate::device::Device;
use crate::operation::{Activation, Blend, Linear};

/// γ -> Δ_S and T_C + Δ_S.
pub(crate) fn skeleton<D: Device>(device: &mut D, model: &DeviceModel<D>, a: &mut Activations<D::Buffer>) {
    for (i, layer) in model.embedding.iter().enumerate() {
        let activation = if i + 1 == model.embedding.len() { Activation::None } else { Activation::Relu };
        let (before, after) = a.embedding.split_at_mut(i);
        let x = before.last().unwrap_or(&a.pose);
        device.run(Linear { x, weight: &layer.weight, bias: &layer.bias, activation, y: &mut after[0] }.into());
    }
    let blend = Blend {
        weights: a.embedding.last().unwrap_or(&a.pose),
        basis: &model.skeleton_basis,
        rest: &model.rest,
        share: &a.skeleton_share,
        residual: &mut a.skeleton,
        template: &mut a.coarse,
    };
    device.run(blend.into());
}
