//! Predicted positions -> positions whose edges have about the lengths that the garment was cut to. network.md §5.

use super::{Activations, DeviceModel, Polishing};
use crate::device::Device;
use crate::operation::{Polish, Pull};
use crate::topology::Graph;

/// Nothing happens where the model does not know how the garment was cut.
pub(crate) fn polish<D: Device>(device: &mut D, model: &DeviceModel<D>, a: &mut Activations<D::Buffer>) {
    let (Some(cut), Some(Polishing { pulls, moves })) = (&model.cut, &mut a.polish) else { return };
    let Graph { offsets, neighbours } = &model.graph;
    let (squares, share, positions) = (&cut.squares, &a.mesh_share, &mut a.positions);
    for step in 0..cut.steps {
        device.run(Pull { offsets, neighbours, squares, positions: &*positions, pulls: &mut *pulls }.into());
        let (pulls, moves, positions) = (&*pulls, &mut *moves, &mut *positions);
        device.run(Polish { offsets, neighbours, share, first: step == 0, pulls, moves, positions }.into());
    }
}
