//! Skeleton-based residual stream: `P = Φ(γ)`, `Δ_S = Σ_j P_j B_j`. network.md §2.

use super::{Activations, DeviceModel};
use crate::device::{Activation, Device};

/// γ -> Δ_S and T_C + Δ_S.
pub(super) fn skeleton<D: Device>(device: &mut D, model: &DeviceModel<D>, a: &mut Activations<D::Buffer>) {
    for (i, layer) in model.embedding.iter().enumerate() {
        let last = i + 1 == model.embedding.len();
        let (before, after) = a.embedding.split_at_mut(i);
        let x = before.last().unwrap_or(&a.pose);
        device.linear(x, layer, if last { Activation::None } else { Activation::Relu }, &mut after[0]);
    }
    let embedding = a.embedding.last().unwrap_or(&a.pose);
    device.blend(embedding, &model.skeleton, &model.rest, &a.confidence, &mut a.skeleton, &mut a.coarse);
}
