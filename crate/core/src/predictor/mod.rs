//! A model ready to predict on the CPU: load once, then one call per frame without any allocation.

mod folds;

use crate::confidence::Confidence;
use crate::cpu::{Cpu, Level, Threads};
use crate::model::{HostModel, Sizes, Surface};
use crate::network::{Activations, Streams, finish, forward, mesh, polish, pose, repair, skeleton, skin, stand};
use crate::operation::Space;
use crate::pose::{Rig, Transform};
use crate::{Error, Result};
pub use folds::Folds;
use std::sync::Arc;

/// How much of each stream a prediction shows, 0 to 1: quality is changed by fading, so that nothing jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// How much of the way from plain skinning to the skeleton stream's prediction.
    pub skeleton: f32,
    /// Of the mesh stream's residual.
    pub mesh: f32,
}

impl Shares {
    /// The whole of what the streams answer.
    pub const ALL: Self = Self { skeleton: 1.0, mesh: 1.0 };
}

/// A model on the CPU device with every buffer it needs.
pub struct Predictor {
    device: Cpu,
    model: Arc<HostModel>,
    activations: Activations<Vec<f32>>,
    trust: Option<Confidence>,
    confidence: f32,
}

impl Predictor {
    /// Reads a model file (network.md §8) for the best SIMD level of this machine.
    pub fn new(bytes: &[u8]) -> Result<Self> {
        Ok(Self::from_model(HostModel::parse(bytes)?, Level::new()))
    }

    /// A model at a chosen SIMD level.
    pub fn from_model(model: HostModel, level: Level) -> Self {
        Self::on_threads(model, level, Threads::default())
    }

    /// A model at a chosen SIMD level, on chosen threads; how many changes no number.
    pub fn on_threads(model: HostModel, level: Level, threads: Threads) -> Self {
        let device = Cpu::with_threads(level, threads);
        let mut activations = Activations::new(&model, |_, length| vec![0.0; length]);
        // Only on a GPU something is drawn from vertices that are split at seams in every frame.
        activations.drawn = None;
        let trust = Confidence::new(&model);
        Self { device, model: Arc::new(model), activations, trust, confidence: 1.0 }
    }

    /// The model, to be put on another device too.
    pub fn model(&self) -> &Arc<HostModel> {
        &self.model
    }

    /// Bytes that it holds: the model's arrays, and what a prediction computes.
    pub fn bytes(&self) -> usize {
        let mut numbers = 0;
        self.model.map(|values| numbers += values.len(), |_| ());
        self.model.map(|_| (), |indices| numbers += indices.len());
        Activations::new(&self.model, |_, length| numbers += length);
        4 * numbers
    }

    /// Sizes of the network.
    pub fn sizes(&self) -> Sizes {
        self.model.sizes
    }

    /// Joints, inverse bind transforms and body frame.
    pub fn rig(&self) -> &Rig {
        &self.model.rig
    }

    /// Joint names, in the order of a pose.
    pub fn joints(&self) -> &[String] {
        &self.model.rig.joints
    }

    /// Index of the hip.
    pub fn root(&self) -> usize {
        self.model.rig.root
    }

    /// `B_j⁻¹` per joint, row-major 3×4.
    pub fn inverse_bind(&self) -> &[Transform] {
        &self.model.rig.inverse_bind
    }

    /// Cloth triangles [t, 3].
    pub fn triangles(&self) -> &[u32] {
        &self.model.triangles
    }

    /// What is drawn, when it differs from the cloth mesh.
    pub fn surface(&self) -> Option<&Surface> {
        self.model.surface.as_ref()
    }

    /// Joint world matrices [J, 16], column-major as in three.js, metres -> positions and normals.
    pub fn predict(&mut self, joints: &[f32], streams: Streams) -> Result<()> {
        self.predict_faded(joints, streams, Shares::ALL)
    }

    /// The same with `shares` of the residuals.
    pub fn predict_faded(&mut self, joints: &[f32], streams: Streams, shares: Shares) -> Result<()> {
        self.model.rig.read_column_major(joints, &mut self.activations.joints)?;
        self.run(streams, shares)
    }

    /// The whole network for a cloth that has its mesh stream computed in some frames only: in this one if `aim`.
    /// `step`: how much of the way to the last aim the cloth goes on, 1 / k for one that aims in every k-th frame.
    pub fn predict_folds(
        &mut self,
        joints: &[f32],
        folds: &mut Folds,
        (aim, step): (bool, f32),
        shares: Shares,
    ) -> Result<()> {
        self.model.rig.read_column_major(joints, &mut self.activations.joints)?;
        self.weigh(shares);
        let (device, model, a) = (&mut self.device, &*self.model, &mut self.activations);
        pose(device, model, a);
        skeleton(device, model, a);
        if aim && model.mesh_stream {
            mesh(device, model, a);
            folds.aim(&a.mesh);
        }
        folds.show(step, &a.coarse, a.mesh_share[0], &mut a.template);
        skin(device, &a.template, &model.skinning, &a.body_frame, Space::World, &mut a.positions);
        self.end(Streams::Both, shares)
    }

    /// Joint world transforms [J, 3, 4], row-major, metres -> positions and normals.
    pub fn predict_row_major(&mut self, joints: &[f32], streams: Streams) -> Result<()> {
        self.model.rig.read(joints, &mut self.activations.joints)?;
        self.run(streams, Shares::ALL)
    }

    fn run(&mut self, streams: Streams, shares: Shares) -> Result<()> {
        self.weigh(shares);
        let (device, model, a) = (&mut self.device, &*self.model, &mut self.activations);
        pose(device, model, a);
        forward(device, model, streams, Space::World, a);
        self.end(streams, shares)
    }

    /// Predicted positions -> what is shown. Weights and poses may be finite and yet overflow together; what comes out
    /// is checked, so that NaN never leaves.
    fn end(&mut self, streams: Streams, shares: Shares) -> Result<()> {
        let (device, model, a) = (&mut self.device, &*self.model, &mut self.activations);
        if streams != Streams::None {
            stand(device, model, a);
        }
        if streams == Streams::Both {
            polish(device, model, a);
        }
        if shares.skeleton < 1.0 && streams != Streams::None {
            // The residuals alone would fade to the learned weights, which without them look ragged.
            let plain = &mut a.template;
            skin(device, &model.rest, &model.reference.skinning, &a.body_frame, Space::World, plain);
            let way = a.positions.iter_mut().zip(plain);
            way.for_each(|(shown, plain)| *shown = *plain + shares.skeleton * (*shown - *plain));
        }
        repair(device, model, streams, a);
        finish(device, model, a);
        for positions in [Some(&a.positions), a.riders.as_ref().map(|riders| &riders.positions)].into_iter().flatten() {
            if let Some(element) = positions.iter().position(|value| !value.is_finite()) {
                let found = positions[element];
                return Err(Error::NotFinite { what: "positions".to_owned(), element, found });
            }
        }
        Ok(())
    }

    /// What the residuals count in the pose that was read.
    fn weigh(&mut self, shares: Shares) {
        let a = &mut self.activations;
        self.confidence = self.trust.as_mut().map_or(1.0, |trust| trust.of(&self.model.rig, &a.joints));
        a.skeleton_share[0] = self.confidence;
        a.mesh_share[0] = self.confidence * shares.mesh;
    }

    /// What the residuals were worth in the last pose: 1 among the poses seen in training, 0 far from them, where the
    /// garment at rest is skinned with the learned weights; always 1 where the model does not say what it has seen.
    pub fn confidence(&self) -> f32 {
        self.confidence
    }

    /// Predicted positions [n, 3], world, metres.
    pub fn positions(&self) -> &[f32] {
        &self.activations.positions
    }

    /// Unit vertex normals [n, 3] of the predicted positions.
    pub fn normals(&self) -> &[f32] {
        &self.activations.normals
    }

    /// Positions of the mesh that is drawn, one vertex per place [w, 3]: of what rides on the cloth where the model has
    /// that, of the cloth otherwise.
    pub fn shown_positions(&self) -> &[f32] {
        self.activations.riders.as_ref().map_or(self.positions(), |riders| &riders.positions)
    }

    /// Its unit normals [w, 3].
    pub fn shown_normals(&self) -> &[f32] {
        self.activations.riders.as_ref().map_or(self.normals(), |riders| &riders.normals)
    }

    /// Its triangles [t, 3].
    pub fn shown_triangles(&self) -> &[u32] {
        self.model.ride.as_ref().map_or(self.triangles(), |ride| &ride.triangles)
    }

    /// Every intermediate result of the last prediction.
    pub fn activations(&self) -> &Activations<Vec<f32>> {
        &self.activations
    }
}
