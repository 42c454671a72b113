//! Penetration repair: the prediction is moved out of the posed body. Paper, § Penetration Handling.

use super::{Activations, DeviceModel, skin};
use crate::cpu::repair::closest::GAP;
use crate::device::Device;
use crate::model::{Body, Cut};
use crate::operation::{Collide, Normals, Settle, Slide, Space, Spread};
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
    /// What each cloth vertex lacks to its gap [n, 3].
    pub push: B,
    /// Displacement of the cloth, one buffer per round [n, 3].
    pub displacement: [B; ROUNDS],
}

impl<B> Collision<B> {
    pub(super) fn new(body: usize, n: usize, buffer: &mut impl FnMut(&str, usize) -> B) -> Self {
        let mut room = |vertices: usize| buffer("collide", vertices * 3);
        Self { body: room(body), normals: room(body), push: room(n), displacement: [room(n), room(n)] }
    }
}

/// Puts the body, which cloth is kept out of, in its pose; nothing happens where the model has none.
pub fn stand<D: Device>(device: &mut D, model: &DeviceModel<D>, a: &mut Activations<D::Buffer>) {
    let (Some(body), Some(c)) = (&model.body, &mut a.collision) else { return };
    pose_body(device, body, &a.body_frame, Space::World, [&mut c.body, &mut c.normals]);
}

/// Moves the predicted positions, which have been polished or not, out of the body that [stands](stand) there. What a
/// model polishes by no step at all is not polished.
pub fn collide<D: Device>(device: &mut D, model: &DeviceModel<D>, polished: bool, a: &mut Activations<D::Buffer>) {
    let (Some(body), Some(c)) = (&model.body, &mut a.collision) else { return };
    push(device, body, GAP, [&c.body, &c.normals, &a.positions], &mut c.push);
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
        posed: &c.body,
        normals: &c.normals,
        offsets: &body.fans.offsets,
        corners: &body.fans.corners,
        seeds: &body.seeds,
        displacement: second,
        positions: &mut a.positions,
    };
    device.run(settle.into());
}

/// Poses the body in `space`: positions and their normals [b, 3].
pub fn pose_body<D: Device>(
    device: &mut D,
    body: &Body<D::Buffer, D::Indices>,
    transforms: &D::Buffer,
    space: Space,
    [posed, normals]: [&mut D::Buffer; 2],
) {
    skin(device, &body.rest, &body.skinning, transforms, space, posed);
    device.run(Normals { positions: &*posed, triangles: &body.triangles, normals: &mut *normals }.into());
}

/// What each cloth vertex lacks to `reach` above the body, metres [n, 3]: posed positions and normals of the body
/// [b, 3], cloth [n, 3].
pub fn push<D: Device>(
    device: &mut D,
    body: &Body<D::Buffer, D::Indices>,
    reach: f32,
    [posed, normals, positions]: [&D::Buffer; 3],
    push: &mut D::Buffer,
) {
    let (offsets, corners, seeds) = (&body.fans.offsets, &body.fans.corners, &body.seeds);
    device.run(Collide { reach, posed, normals, offsets, corners, seeds, positions, push }.into());
}
