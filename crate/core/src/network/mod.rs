//! The network, written once: the paper's figure as a function over any device. network.md §2–4.

mod collide;
mod embedding;
mod graph;
mod polish;

use crate::device::Device;
use crate::model::{HostModel, Model, Skinning, surroundings};
use crate::operation::{self, BodyFrame, Normals, Space};
pub use collide::{Collision, collide, pose_body, push, stand};
pub(crate) use embedding::skeleton;
pub use graph::graph_layer;
pub(crate) use graph::mesh;
pub use polish::polish;
use std::sync::Arc;

/// Which part of the network runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Streams {
    /// Both residual streams: the whole network.
    Both,
    /// The skeleton stream only: the coarse prediction.
    Skeleton,
    /// Plain skinning, the baseline of comparisons: the template skinned with `W_C^I`.
    None,
}

/// A model on the storage of device `D`.
pub type DeviceModel<D> = Model<<D as Device>::Buffer, <D as Device>::Indices>;

/// Every intermediate result, named as the golden files name it. Allocated once.
pub struct Activations<B> {
    /// World joint transforms `G_j` [J, 3, 4].
    pub joints: B,
    /// What Δ_S counts in this pose, 0 to 1 [1].
    pub skeleton_share: B,
    /// What Δ_M counts in this prediction, 0 to 1 [1].
    pub mesh_share: B,
    /// Pose vector γ [12J].
    pub pose: B,
    /// `N·A_j`, then `N⁻¹` [J + 1, 3, 4].
    pub body_frame: B,
    /// Outputs of Φ's layers; the last is P [m].
    pub embedding: Vec<B>,
    /// Δ_S [n, 3].
    pub skeleton: B,
    /// V, or X where the model has surroundings [n, 3].
    pub reference: B,
    /// The same, standardised [n, 3]: h⁰ of a model without surroundings.
    pub nodes: B,
    /// h⁰ of one with them [n, 54].
    pub surroundings: Option<B>,
    /// [V ; T_C] / edge_scale [n, 6].
    pub potentials: B,
    /// h of each graph layer [n, F].
    pub layers: Vec<B>,
    /// What graph layers compute on their way: one for all of them, which write it in turn, or one for each.
    pub workings: Vec<Workings<B>>,
    /// Outputs of the vertex-level MLP's layers; the last is w [n, k].
    pub vertex_mlp: Vec<B>,
    /// Δ_M [n, 3].
    pub mesh: B,
    /// T_C + Δ_S [n, 3].
    pub coarse: B,
    /// T_C(γ) [n, 3].
    pub template: B,
    /// Predicted positions [n, 3].
    pub positions: B,
    /// What the polish computes on its way, where the model has one.
    pub polish: Option<Polishing<B>>,
    /// What the repair of penetration computes, where the model has a body.
    pub collision: Option<Collision<B>>,
    /// Unit normals of the predicted positions [n, 3].
    pub normals: B,
    /// Another mesh than the cloth's, which rides on it [w, 3], where the model has one.
    pub riders: Option<Drawn<B>>,
    /// The same of the drawn vertices, where the model tells them apart from the cloth's.
    pub drawn: Option<Drawn<B>>,
}

/// What is drawn: a mesh that rides on the cloth, or vertices split at seams.
pub struct Drawn<B> {
    /// Positions [w or d, 3].
    pub positions: B,
    /// Unit normals [w or d, 3].
    pub normals: B,
}

/// What the polish computes on its way.
pub struct Polishing<B> {
    /// Pulls of the edges [n, 3].
    pub pulls: B,
    /// The same, shared with the neighbours [n, 3].
    pub diffused: B,
    /// How far the last step went [n, 3].
    pub moves: B,
    /// What each vertex lacks to `REACH` above the body; zero, too, where the model has none [n, 3].
    pub near: B,
}

impl<B> Polishing<B> {
    fn new(mut room: impl FnMut() -> B) -> Self {
        Self { pulls: room(), diffused: room(), moves: room(), near: room() }
    }
}

/// What a graph layer computes on its way.
pub struct Workings<B> {
    /// q | k | v | r [n, 4F].
    pub projected: B,
    /// ĥ [n, F].
    pub attended: B,
}

impl<B> Activations<B> {
    /// Room for every result of `model`; `buffer(stage, length)` makes one, for the stage that computes it.
    pub fn new(model: &HostModel, buffer: impl FnMut(&str, usize) -> B) -> Self {
        Self::with_workings(1, model, buffer)
    }

    /// The same with room for what every graph layer computes on its way, for a device that must tell them apart.
    pub fn keeping(model: &HostModel, buffer: impl FnMut(&str, usize) -> B) -> Self {
        Self::with_workings(model.layers.len(), model, buffer)
    }

    fn with_workings(workings: usize, model: &HostModel, mut buffer: impl FnMut(&str, usize) -> B) -> Self {
        let (n, joints, features) = (model.sizes.vertices, model.sizes.joints, model.sizes.features);
        let working = |stage: &str, buffer: &mut dyn FnMut(&str, usize) -> B| Workings {
            projected: buffer(stage, n * 4 * features),
            attended: buffer(stage, n * features),
        };
        Self {
            joints: buffer("body_frame", 12 * joints),
            skeleton_share: buffer("body_frame", 1),
            mesh_share: buffer("body_frame", 1),
            pose: buffer("body_frame", 12 * joints),
            body_frame: buffer("body_frame", 12 * (joints + 1)),
            embedding: model.embedding.iter().map(|layer| buffer("embedding", layer.outputs)).collect(),
            skeleton: buffer("skeleton", n * 3),
            reference: buffer("reference", n * 3),
            nodes: buffer("reference", n * 3),
            surroundings: model.surroundings.as_ref().map(|_| buffer("reference", n * surroundings::INPUTS)),
            potentials: buffer("reference", n * 6),
            layers: (0..model.layers.len()).map(|l| buffer(&format!("layer.{l}"), n * features)).collect(),
            workings: (0..workings).map(|l| working(&format!("layer.{l}"), &mut buffer)).collect(),
            vertex_mlp: model.vertex_mlp.iter().map(|layer| buffer("mesh", n * layer.outputs)).collect(),
            mesh: buffer("mesh", n * 3),
            coarse: buffer("skeleton", n * 3),
            template: buffer("template", n * 3),
            positions: buffer("positions", n * 3),
            polish: model.cut.as_ref().map(|_| Polishing::new(|| buffer("polish", n * 3))),
            collision: model.body.as_ref().map(|body| Collision::new(body.vertices, n, &mut buffer)),
            normals: buffer("normals", n * 3),
            riders: model.ride.as_ref().map(|ride| Drawn {
                positions: buffer("ride", ride.corners.len()),
                normals: buffer("ride", ride.corners.len()),
            }),
            drawn: model.surface.as_ref().filter(|surface| !surface.vertex.is_empty()).map(|surface| Drawn {
                positions: buffer("surface", surface.vertex.len() * 3),
                normals: buffer("surface", surface.vertex.len() * 3),
            }),
        }
    }

    /// What each stage hands on, under the stage's name.
    pub fn stages(&self) -> Vec<(String, &B)> {
        let layers = self.layers.iter().enumerate().map(|(l, layer)| (format!("layer.{l}"), layer));
        let mut stages = vec![("body_frame".to_owned(), &self.body_frame)];
        stages.extend(self.embedding.last().map(|embedding| ("embedding".to_owned(), embedding)));
        stages.extend([("skeleton".to_owned(), &self.skeleton), ("reference".to_owned(), &self.reference)]);
        stages.extend(layers);
        let last = [("mesh", &self.mesh), ("template", &self.template), ("positions", &self.positions)];
        stages.extend(last.map(|(name, buffer)| (name.to_owned(), buffer)));
        stages
    }
}

/// A whole prediction: joints and shares (written before) -> positions in the world, their normals, and what is drawn.
pub fn predict<D: Device>(device: &mut D, model: &DeviceModel<D>, streams: Streams, a: &mut Activations<D::Buffer>) {
    pose(device, model, a);
    forward(device, model, streams, Space::World, a);
    if streams != Streams::None {
        stand(device, model, a);
    }
    if streams == Streams::Both {
        polish(device, model, a);
    }
    repair(device, model, streams, a);
    finish(device, model, a);
}

/// Moves predicted cloth out of the body; plainly skinned cloth is shown as it is.
pub(crate) fn repair<D: Device>(
    device: &mut D,
    model: &DeviceModel<D>,
    streams: Streams,
    a: &mut Activations<D::Buffer>,
) {
    if streams != Streams::None {
        collide(device, model, streams == Streams::Both, a);
    }
}

/// Joints -> body frame and pose vector.
pub fn pose<D: Device>(device: &mut D, model: &DeviceModel<D>, a: &mut Activations<D::Buffer>) {
    let (rig, joints) = (Arc::clone(&model.rig), &a.joints);
    device.run(BodyFrame { rig, joints, transforms: &mut a.body_frame, vector: &mut a.pose }.into());
}

/// Positions in the world -> normals, and what is drawn.
pub(crate) fn finish<D: Device>(device: &mut D, model: &DeviceModel<D>, a: &mut Activations<D::Buffer>) {
    device.run(Normals { positions: &a.positions, triangles: &model.triangles, normals: &mut a.normals }.into());
    if let (Some(ride), Some(riders)) = (&model.ride, &mut a.riders) {
        let (positions, normals) = (&a.positions, &a.normals);
        let (corners, coordinates) = (&ride.corners, &ride.coordinates);
        device.run(operation::Ride { corners, coordinates, positions, normals, riders: &mut riders.positions }.into());
        let (positions, triangles) = (&riders.positions, &ride.triangles);
        device.run(Normals { positions, triangles, normals: &mut riders.normals }.into());
    }
    if let (Some(surface), Some(drawn)) = (&model.surface, &mut a.drawn) {
        let riders = a.riders.as_ref();
        let surface = operation::Surface {
            vertex: &surface.vertex,
            positions: riders.map_or(&a.positions, |riders| &riders.positions),
            normals: riders.map_or(&a.normals, |riders| &riders.normals),
            drawn_positions: &mut drawn.positions,
            drawn_normals: &mut drawn.normals,
        };
        device.run(surface.into());
    }
}

/// Shares, pose and body frame (written before) -> template and positions in `space`.
pub fn forward<D: Device>(
    device: &mut D,
    model: &DeviceModel<D>,
    streams: Streams,
    space: Space,
    a: &mut Activations<D::Buffer>,
) {
    if streams == Streams::None {
        return skin(device, &model.rest, &model.reference.skinning, &a.body_frame, space, &mut a.positions);
    }
    skeleton(device, model, a);
    if streams == Streams::Skeleton || !model.mesh_stream {
        return skin(device, &a.coarse, &model.skinning, &a.body_frame, space, &mut a.positions);
    }
    mesh(device, model, a);
    skin(device, &a.template, &model.skinning, &a.body_frame, space, &mut a.positions);
}

/// Skins `rest` [n, 3] -> positions [n, 3] in `space`. network.md §4.
pub fn skin<D: Device>(
    device: &mut D,
    rest: &D::Buffer,
    skinning: &Skinning<D::Buffer, D::Indices>,
    transforms: &D::Buffer,
    space: Space,
    positions: &mut D::Buffer,
) {
    let Skinning { joints, weights, .. } = skinning;
    device.run(operation::Skin { rest, joints, weights, transforms, space, positions }.into());
}
