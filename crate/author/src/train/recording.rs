//! A forward pass as training records it: operations, activations, and the predictions that learn.

use super::tape::{Id, Shared, Tape};
use super::{Variant, upload};
use ctsn_core::device::{Device, Space};
use ctsn_core::model::HostModel;
use ctsn_core::network::{Activations, Streams, forward};

/// The recorded pass. All recordings of one model number its arrays alike.
pub(crate) struct Recording {
    pub tape: Tape,
    pub activations: Activations<Id>,
    /// The coarse prediction where both streams learn: what is left of the network otherwise learns the truth itself.
    pub coarse: Option<Id>,
}

impl Recording {
    /// Records `streams`; with the model's values, and the arrays that learn: their places among the model's parameters.
    pub fn new(model: &HostModel, variant: Variant, streams: Streams) -> (Self, Shared, Vec<(usize, Id)>) {
        let mut tape = Tape::default();
        let recorded = upload(model, &mut tape);
        let all = recorded.parameters().into_iter().copied().enumerate();
        let learning: Vec<(usize, Id)> = all.filter(|(i, _)| variant.learns(*i)).collect();
        let shared = tape.seal(&learning.iter().map(|(_, id)| id).collect::<Vec<_>>());
        let mut activations = Activations::new(model, |_, length| tape.buffer(&vec![0.0; length]));
        forward(&mut tape, &recorded, streams, Space::Body, &mut activations);
        let coarse = (variant.skeleton && streams == Streams::Both).then(|| {
            let mut coarse = tape.buffer(&vec![0.0; model.sizes.vertices * 3]);
            tape.skin(&activations.coarse, &recorded.skin, &activations.body_frame, Space::Body, &mut coarse);
            coarse
        });
        (Self { tape, activations, coarse }, shared, learning)
    }
}
