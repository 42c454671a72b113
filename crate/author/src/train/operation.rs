//! What the tape records of each operation: its operands.

use super::tape::{Id, IndexId};
use ctsn_core::device::Activation;
use ctsn_core::model::{Layer, Linear, Reference, Skin};

/// One recorded operation with its operands.
pub(super) enum Operation {
    Linear { x: Id, layer: Linear<Id>, activation: Activation, y: Id },
    Blend { weights: Id, basis: Id, rest: Id, residual: Id, template: Id },
    Add { rest: Id, residual: Id, total: Id },
    Skin { rest: Id, skin: Skin<Id, IndexId>, transforms: Id, positions: Id },
    Features { v: Id, rest: Id, reference: Reference<Id, IndexId>, nodes: Id, potentials: Id },
    Attend { graph: usize, heads: usize, projected: Id, potentials: Id, edge: Id, attended: Id },
    Gate { attended: Id, projected: Id, layer: Layer<Id>, output: Id },
}

impl Operation {
    /// What the operation computes.
    pub fn output(&self) -> Id {
        match self {
            Self::Linear { y, .. } => *y,
            Self::Blend { template, .. } => *template,
            Self::Add { total, .. } => *total,
            Self::Skin { positions, .. } => *positions,
            Self::Features { nodes, .. } => *nodes,
            Self::Attend { attended, .. } => *attended,
            Self::Gate { output, .. } => *output,
        }
    }

    /// The inputs that the operation's gradient writes to.
    pub fn learns_from(&self) -> Vec<Id> {
        match self {
            Self::Linear { x, .. } => vec![*x],
            Self::Blend { weights, .. } => vec![*weights],
            Self::Add { residual, .. } => vec![*residual],
            Self::Skin { rest, .. } => vec![*rest],
            Self::Features { .. } => Vec::new(),
            Self::Attend { projected, .. } => vec![*projected],
            Self::Gate { attended, projected, .. } => vec![*attended, *projected],
        }
    }
}
