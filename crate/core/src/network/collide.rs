//! Penetration repair: the prediction is moved out of the posed body. Paper, § Penetration Handling.

use super::{Activations, DeviceModel, skin};
use crate::cpu::repair::closest::GAP;
use crate::device::Device;
use crate::model::{Body, Cut};
use crate::operation::{Bury, Collide, Normals, Settle, Slide, Space, Spread};
use crate::topology::Graph;

/// Rounds in which what is pushed out takes its neighbours along.
const ROUNDS: usize = 2;
/// Pairs of rounds in which cloth that is polished slides into its lengths.
const SLIDES: usize = 2;

/// Intermediate results of the repair.
pub struct Collision<B> {
    /// The body's posed vertices [b, 3].
    pub body: B,
    /// Their unit normals [b, 3].
    pub normals: B,
    /// The positions again; vertices inside another part of the body are moved far away [b, 3].
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

/// Puts the body, which cloth is kept out of, in its pose; nothing happens where the model has none.
pub fn stand<D: Device>(device: &mut D, model: &DeviceModel<D>, a: &mut Activations<D::Buffer>) {
    let (Some(body), Some(c)) = (&model.body, &mut a.collision) else { return };
    expose(device, body, &a.body_frame, Space::World, [&mut c.body, &mut c.normals, &mut c.exposed]);
}

/// Moves the predicted positions, which have been polished or not, out of the body that [stands](stand) there. What a
/// model polishes by no step at all is not polished.
pub fn collide<D: Device>(device: &mut D, model: &DeviceModel<D>, polished: bool, a: &mut Activations<D::Buffer>) {
    let (Some(body), Some(c)) = (&model.body, &mut a.collision) else { return };
    push(device, body, GAP, [&c.exposed, &c.normals, &a.positions], &mut c.push);
    let Graph { offsets, neighbours } = &model.graph;
    let [first, second] = &mut c.displacement;
    device.run(Spread { offsets, neighbours, push: &c.push, before: &c.push, after: &mut *first }.into());
    device.run(Spread { offsets, neighbours, push: &c.push, before: first, after: &mut *second }.into());
    if let (Some(Cut { squares, steps: 1.., .. }), true) = (&model.cut, polished) {
        let (share, positions, push) = (&a.mesh_share, &a.positions, &c.push);
        for _ in 0..SLIDES {
            let (before, after) = (&*second, &mut *first);
            device.run(Slide { offsets, neighbours, squares, share, positions, push, before, after }.into());
            let (before, after) = (&*first, &mut *second);
            device.run(Slide { offsets, neighbours, squares, share, positions, push, before, after }.into());
        }
    }
    let settle = Settle {
        exposed: &c.exposed,
        normals: &c.normals,
        offsets: &body.fans.offsets,
        corners: &body.fans.corners,
        seeds: &body.seeds,
        displacement: second,
        positions: &mut a.positions,
    };
    device.run(settle.into());
}

/// Poses the body in `space` and buries what is inside another part of it: posed positions, their normals and the
/// exposed positions [b, 3].
pub fn expose<D: Device>(
    device: &mut D,
    body: &Body<D::Buffer, D::Indices>,
    transforms: &D::Buffer,
    space: Space,
    [posed, normals, exposed]: [&mut D::Buffer; 3],
) {
    skin(device, &body.rest, &body.skinning, transforms, space, posed);
    device.run(Normals { positions: &*posed, triangles: &body.triangles, normals: &mut *normals }.into());
    device.run(Bury { posed: &*posed, normals: &*normals, areas: &body.areas, exposed }.into());
}

/// What each cloth vertex lacks to `reach` above the body, metres [n, 3]: exposed positions and normals of the body
/// [b, 3], cloth [n, 3].
pub fn push<D: Device>(
    device: &mut D,
    body: &Body<D::Buffer, D::Indices>,
    reach: f32,
    [exposed, normals, positions]: [&D::Buffer; 3],
    push: &mut D::Buffer,
) {
    let (offsets, corners, seeds) = (&body.fans.offsets, &body.fans.corners, &body.seeds);
    device.run(Collide { reach, exposed, normals, offsets, corners, seeds, positions, push }.into());
}
