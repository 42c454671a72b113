//! Predicted positions -> positions whose edges have about the lengths that the garment was cut to. network.md §5.

use super::{Activations, DeviceModel};
use crate::device::Device;
use crate::operation::Polish;
use crate::topology::Graph;

/// Nothing happens where the model does not know how the garment was cut. Steps go to and fro between two buffers, so
/// their number is even.
pub(crate) fn polish<D: Device>(device: &mut D, model: &DeviceModel<D>, a: &mut Activations<D::Buffer>) {
    let (Some(cut), Some(polished)) = (&model.cut, &mut a.polished) else { return };
    let Graph { offsets, neighbours } = &model.graph;
    let (squares, share) = (&cut.squares, &a.mesh_share);
    for pair in 0..cut.steps.div_ceil(2) {
        let (current, other) = (&a.positions, &mut *polished);
        device.run(Polish { offsets, neighbours, squares, share, first: pair == 0, current, other }.into());
        let (current, other) = (&*polished, &mut a.positions);
        device.run(Polish { offsets, neighbours, squares, share, first: false, current, other }.into());
    }
}
