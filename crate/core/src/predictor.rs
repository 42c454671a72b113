//! A model ready to predict on the CPU: load once, then one call per frame without any allocation.

use crate::confidence::Confidence;
use crate::cpu::{Cpu, Level};
use crate::model::{HostModel, Sizes, Surface};
use crate::network::{Activations, Streams, predict};
use crate::pose::{Rig, Transform};
use crate::{Error, Result};
use std::sync::Arc;

/// A model on the CPU device with every buffer it needs.
pub struct Predictor {
    device: Cpu,
    model: Arc<HostModel>,
    activations: Activations<Vec<f32>>,
    confidence: Option<Confidence>,
}

impl Predictor {
    /// Reads a model file (network.md §8) for the best SIMD level of this machine.
    pub fn new(bytes: &[u8]) -> Result<Self> {
        Ok(Self::from_model(HostModel::parse(bytes)?, Level::new()))
    }

    /// A model at a chosen SIMD level.
    pub fn from_model(model: HostModel, level: Level) -> Self {
        let device = Cpu::with_level(level);
        let mut activations = Activations::new(&model, |_, length| vec![0.0; length]);
        activations.confidence[0] = 1.0;
        let confidence = Confidence::new(&model);
        Self { device, model: Arc::new(model), activations, confidence }
    }

    /// The model, to be put on another device too.
    pub fn model(&self) -> &Arc<HostModel> {
        &self.model
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
        self.model.rig.read_column_major(joints, &mut self.activations.joints)?;
        self.run(streams)
    }

    /// Joint world transforms [J, 3, 4], row-major, metres -> positions and normals.
    pub fn predict_row_major(&mut self, joints: &[f32], streams: Streams) -> Result<()> {
        self.model.rig.read(joints, &mut self.activations.joints)?;
        self.run(streams)
    }

    /// Weights and poses may be finite and yet overflow together; what comes out is checked, so that NaN never leaves.
    fn run(&mut self, streams: Streams) -> Result<()> {
        let a = &mut self.activations;
        if let Some(confidence) = &mut self.confidence {
            a.confidence[0] = confidence.of(&self.model.rig, &a.joints);
        }
        predict(&mut self.device, &self.model, streams, a);
        match a.positions.iter().position(|value| !value.is_finite()) {
            Some(element) => {
                Err(Error::NotFinite { what: "positions".to_owned(), element, found: a.positions[element] })
            }
            None => Ok(()),
        }
    }

    /// What the residuals were worth in the last pose: 1 among the poses seen in training, 0 far from them, where the
    /// cloth is skinned plainly; always 1 where the model does not say what it has seen.
    pub fn confidence(&self) -> f32 {
        self.activations.confidence[0]
    }

    /// Predicted positions [n, 3], world, metres.
    pub fn positions(&self) -> &[f32] {
        &self.activations.positions
    }

    /// Unit vertex normals [n, 3] of the predicted positions.
    pub fn normals(&self) -> &[f32] {
        &self.activations.normals
    }

    /// Positions of the drawn vertices [d, 3]: of the surface where the model has one, of the cloth otherwise.
    pub fn drawn_positions(&self) -> &[f32] {
        self.activations.drawn.as_ref().map_or(self.positions(), |drawn| &drawn.positions)
    }

    /// Unit normals of the drawn vertices [d, 3].
    pub fn drawn_normals(&self) -> &[f32] {
        self.activations.drawn.as_ref().map_or(self.normals(), |drawn| &drawn.normals)
    }

    /// Every intermediate result of the last prediction.
    pub fn activations(&self) -> &Activations<Vec<f32>> {
        &self.activations
    }
}
