//! Penetration repair: the prediction is moved out of the posed body. Paper, § Penetration Handling.

use super::{Activations, DeviceModel};
use crate::device::{Device, Space};

/// Rounds in which what is pushed out takes its neighbours along.
const ROUNDS: usize = 2;

/// Intermediate results of the repair.
pub struct Collision<B> {
    /// The body's posed vertices [b, 3].
    pub body: B,
    /// Their unit normals [b, 3].
    pub normals: B,
    /// The positions again, without those inside another part of the body [b, 3].
    pub exposed: B,
    /// What each cloth vertex lacks to its gap [n, 3].
    pub push: B,
    /// Displacement of the cloth, one buffer per round [n, 3].
    pub displacement: [B; ROUNDS],
}

impl<B> Collision<B> {
    pub(super) fn new(body: usize, n: usize, buffer: &mut impl FnMut(&str, usize) -> B) -> Self {
        let mut room = |vertices: usize| buffer("collide", vertices * 3);
        Self {
            body: room(body),
            normals: room(body),
            exposed: room(body),
            push: room(n),
            displacement: [room(n), room(n)],
        }
    }
}

/// Moves the predicted positions; nothing happens where the model has no body.
pub fn collide<D: Device>(device: &mut D, model: &DeviceModel<D>, a: &mut Activations<D::Buffer>) {
    let (Some(body), Some(c)) = (&model.body, &mut a.collision) else { return };
    device.skin(&body.rest, &body.skin, &a.body_frame, Space::World, &mut c.body);
    device.normals(&c.body, &body.triangles, &mut c.normals);
    device.bury(body, &c.body, &c.normals, &mut c.exposed);
    device.collide(body, &c.exposed, &c.normals, &a.positions, &mut c.push);
    let [first, second] = &mut c.displacement;
    device.spread(&model.graph, &c.push, &c.push, first);
    device.spread(&model.graph, &c.push, first, second);
    device.settle(body, &c.exposed, &c.normals, second, &mut a.positions);
}
