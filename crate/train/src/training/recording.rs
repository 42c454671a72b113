//! A forward pass as training records it: operations, activations, and the predictions that learn.

use super::gradient::polishing::Recorded;
use super::tape::{Id, Lane, Shared, Tape};
use super::{Variant, upload};
use crate::Result;
use crate::loss::Prediction;
use ctsn_core::model::HostModel;
use ctsn_core::network::{Activations, Streams, forward, skin};
use ctsn_core::operation::Space;
use ctsn_core::topology::Graph;

/// The recorded pass. All recordings of one model number its arrays alike.
pub(crate) struct Recording {
    pub tape: Tape,
    pub activations: Activations<Id>,
    /// The coarse prediction where both streams run.
    coarse: Option<Id>,
    /// Whether anything is taught by it: what is left of the network otherwise learns the truth itself.
    teaches_coarse: bool,
    /// What the polish starts from, where there is one.
    start: Option<Id>,
}

impl Recording {
    /// Records `streams`; with the model's values, and the arrays that learn, by name.
    pub fn new(model: &HostModel, variant: Variant, streams: Streams) -> (Self, Shared, Vec<(String, Id)>) {
        let mut tape = Tape::default();
        let recorded = upload(model, &mut tape);
        let all = recorded.parameters().into_iter().map(|(name, id)| (name, *id));
        let learning: Vec<(String, Id)> = all.filter(|(name, _)| variant.learns(name)).collect();
        // Samples are what the range is made of, and poses mixed of them hardly leave it.
        let [skeleton_share, mesh_share] = [0; 2].map(|_| tape.buffer(&[1.0]));
        let shared = tape.seal(&learning.iter().map(|(_, id)| id).collect::<Vec<_>>());
        let mut activations = Activations::keeping(model, |_, length| tape.buffer(&vec![0.0; length]));
        (activations.skeleton_share, activations.mesh_share) = (skeleton_share, mesh_share);
        forward(&mut tape, &recorded, streams, Space::Body, &mut activations);
        let coarse = (streams == Streams::Both).then(|| match &recorded.surroundings {
            // The mesh stream sees it.
            Some(_) => activations.reference,
            None => {
                let mut coarse = tape.buffer(&vec![0.0; model.sizes.vertices * 3]);
                let (rest, transforms) = (&activations.coarse, &activations.body_frame);
                skin(&mut tape, rest, &recorded.skinning, transforms, Space::Body, &mut coarse);
                coarse
            }
        });
        let mut start = None;
        if let (Some(cut), Streams::Both) = (&recorded.cut, streams) {
            start = Some(activations.positions);
            let Graph { offsets, neighbours } = recorded.graph;
            let at = Recorded { offsets, neighbours, squares: cut.squares };
            activations.positions = tape.polish(at, &activations.positions, 3 * model.sizes.vertices, cut.steps);
        }
        (Self { tape, activations, coarse, teaches_coarse: variant.skeleton, start }, shared, learning)
    }

    /// A lane with losses behind the predictions.
    pub fn lane(&self, shared: &Shared) -> Result<Lane> {
        self.tape.lane(shared, &self.predictions().collect::<Vec<_>>())
    }

    /// Where the prediction is [n, 3].
    pub fn prediction(&self, prediction: Prediction) -> Id {
        match prediction {
            Prediction::Coarse => self.coarse.filter(|_| self.teaches_coarse).unwrap_or(self.activations.positions),
            Prediction::Start => self.start.unwrap_or(self.activations.positions),
            Prediction::Whole => self.activations.positions,
        }
    }

    /// Every prediction once, coarse before whole, whether or not anything is taught by it.
    pub fn predictions(&self) -> impl Iterator<Item = Id> {
        self.coarse.into_iter().chain(self.start).chain([self.activations.positions])
    }
}
