//! Predicted positions -> positions whose edges have about the lengths that the garment was cut to. network.md §5.

use super::{Activations, DeviceModel, Polishing, push};
use crate::cpu::network::polish::REACH;
use crate::device::Device;
use crate::operation::{Diffuse, Normals, Polish, Pull};
use crate::topology::Graph;

/// Nothing happens where the model does not know how the garment was cut. The body stands in its pose already.
pub fn polish<D: Device>(device: &mut D, model: &DeviceModel<D>, a: &mut Activations<D::Buffer>) {
    let (Some(cut), Some(Polishing { pulls, diffused, moves, near })) = (&model.cut, &mut a.polish) else { return };
    if let (Some(body), Some(c), 1..) = (&model.body, &a.collision, cut.steps) {
        push(device, body, REACH, [&c.body, &c.normals, &a.positions], near);
        device.run(Normals { positions: &a.positions, triangles: &model.triangles, normals: &mut a.normals }.into());
    }
    let Graph { offsets, neighbours } = &model.graph;
    let (squares, share, facing, positions) = (&cut.squares, &a.mesh_share, &a.normals, &mut a.positions);
    for step in 0..cut.steps {
        let pull = Pull { offsets, neighbours, squares, positions: &*positions, near: &*near, pulls: &mut *pulls };
        device.run(pull.into());
        device.run(Diffuse { offsets, neighbours, pulls: &*pulls, diffused: &mut *diffused }.into());
        let (pulls, moves, near, positions) = (&*diffused, &mut *moves, &mut *near, &mut *positions);
        let first = step == 0;
        device.run(Polish { offsets, neighbours, share, first, facing, pulls, moves, near, positions }.into());
    }
}
