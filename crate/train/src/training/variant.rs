//! What of the network an ablation leaves out. Paper § Ablation Experiments.

use super::Architecture;
use crate::Result;
use crate::dataset::Sample;
use ctsn_core::cpu::Level;
use ctsn_core::model::{CLOTH_WEIGHTS, HostModel, MESH_BASIS, SKELETON_BASIS};
use ctsn_core::{Predictor, Streams};

/// A part of the network that an ablation leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Part {
    /// The skeleton-based residual stream: Δ_S = 0
    Skeleton,
    /// The mesh-based residual stream: Δ_M = 0, and the skeleton stream learns the truth itself
    Mesh,
    /// What is learned of the skin weights: ΔW_C = 0
    Weights,
}

/// The parts that learn. What does not learn keeps its shape in the file: a residual stream's basis is zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    /// Δ_S.
    pub skeleton: bool,
    /// Δ_M.
    pub mesh: bool,
    /// ΔW_C.
    pub weights: bool,
}

impl Variant {
    /// The whole network.
    pub const FULL: Self = Self { skeleton: true, mesh: true, weights: true };

    /// The network without `parts`; (b) of the paper's figure is without all of them, (c) without mesh, (e) without
    /// weights.
    pub fn without(parts: &[Part]) -> Self {
        let learns = |part| !parts.contains(&part);
        Self { skeleton: learns(Part::Skeleton), mesh: learns(Part::Mesh), weights: learns(Part::Weights) }
    }

    /// Whether the array of that name learns, of [`Model::parameters`](ctsn_core::model::Model::parameters).
    /// With its basis at zero for good, a stream passes no gradient on, and all of it stays as it is.
    pub(super) fn learns(self, array: &str) -> bool {
        match array {
            CLOTH_WEIGHTS => self.weights,
            SKELETON_BASIS => self.skeleton,
            MESH_BASIS => self.mesh,
            _ => true,
        }
    }

    /// The streams that run.
    pub(super) fn streams(self) -> Streams {
        if self.mesh { Streams::Both } else { Streams::Skeleton }
    }

    /// Silences the streams that are left out.
    pub(crate) fn silence(self, model: &mut HostModel) {
        for (basis, learns) in [(&mut model.skeleton_basis, self.skeleton), (&mut model.mesh_basis, self.mesh)] {
            if !learns {
                basis.fill(0.0);
            }
        }
        model.mesh_stream &= self.mesh;
    }

    /// `architecture` with the least sizes for a stream that is left out, which the file names none the less.
    pub fn sizes(self, mut architecture: Architecture) -> Architecture {
        if !self.skeleton {
            architecture.embedding = 1;
        }
        if !self.mesh {
            architecture = Architecture { basis: 1, layers: 1, heads: 1, features: 4, ..architecture };
        }
        architecture
    }
}

/// Whether the mesh stream of a trained model says nothing in all of these poses: once its last ReLUs are dead, no
/// gradient wakes it again. (It happened with a cape, both seeds tried: the smoothed target left it too little to do.)
pub fn is_mesh_silent(model: &HostModel, samples: &[&Sample]) -> Result<bool> {
    let mut predictor = Predictor::from_model(HostModel { body: None, cut: None, ..model.clone() }, Level::new());
    for sample in samples {
        predictor.predict_row_major(&sample.joints, Streams::Both)?;
        if predictor.activations().mesh.iter().any(|number| *number != 0.0) {
            return Ok(false);
        }
    }
    Ok(model.mesh_stream)
}
