//! Where the gradient ends by design: what the mesh stream sees of the coarse cloth. It learns what the skeleton stream
//! leaves, and the skeleton stream nothing from that. network.md §6.

use super::Flow;
use crate::training::tape::{Id, IndexId};
use ctsn_core::operation::{Features, Operation, Surround};

/// The way of a gradient through an operation that passes none on.
pub fn flow(operation: &Operation<Id, Id, IndexId>) -> Option<Flow> {
    let (result, ends) = match operation {
        Operation::Features(Features { v, nodes, .. }) => (*nodes, vec![*v]),
        Operation::Surround(Surround { weights, nodes, .. }) => (*nodes, vec![*weights]),
        _ => return None,
    };
    Some(Flow { ends, ..Flow::new(result, []) })
}
