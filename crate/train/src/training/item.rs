//! One pose on the tape: its body frame and targets, the losses and what flows back from them. network.md §6.

use super::recording::Recording;
use super::tape::{Lane, Shared};
use crate::dataset::Sample;
use crate::loss::{Known, Losses, Prediction};
use crate::{Error, Result};
use ctsn_core::model::HostModel;
use ctsn_core::pose::BodyFrame;
use ctsn_rig::vertices;
use glam::DVec3;

/// One pose as the tape sees it.
pub(crate) struct Item {
    pub body_frame: BodyFrame,
    pub known: Known,
    /// What each loss keeps of the truth, where it is known.
    pub targets: Vec<Vec<f32>>,
}

impl Item {
    /// A sample for `model`, to learn from by `losses`; `known`: how finely its truth was simulated.
    pub fn new(model: &HostModel, sample: &Sample, losses: &Losses, known: Known) -> Result<Self> {
        check(model, sample)?;
        Ok(Self { known, targets: losses.targets(&sample.truth, known), ..Self::posed(model, &sample.joints)? })
    }

    /// A pose without truth: world joint transforms, row-major.
    pub fn posed(model: &HostModel, joints: &[f32]) -> Result<Self> {
        let mut body_frame = BodyFrame::new(model.sizes.joints);
        model.rig.body_frame(joints, &mut body_frame)?;
        Ok(Self { body_frame, known: Known::Nothing, targets: Vec::new() })
    }

    /// Forward and backward pass; gradients are those of the mean of `batch` poses. The value of each loss, zero where
    /// it reads nothing.
    pub(super) fn learn(
        &self,
        recording: &Recording,
        shared: &Shared,
        lane: &mut Lane,
        losses: &mut Losses,
        batch: usize,
    ) -> Vec<f32> {
        self.predict(recording, shared, lane);
        losses.pose(&self.body_frame);
        let scale = 1.0 / batch as f32;
        let mut values = vec![0.0; losses.each().count()];
        for prediction in recording.predictions() {
            let mut gradient = lane.take_gradient(prediction);
            gradient.fill(0.0);
            let predicted = lane.value(shared, prediction);
            for (i, term, loss) in losses.each() {
                let here = |read: &Prediction| recording.prediction(*read) == prediction;
                let mut places = Prediction::ALL.into_iter().filter(here);
                if places.any(|read| term.reads(self.known, read)) {
                    let target = self.targets.get(i).map_or(&[][..], Vec::as_slice);
                    values[i] = loss.value(predicted, target, term.weight * scale, &mut gradient);
                }
            }
            *lane.gradient_mut(prediction) = gradient;
        }
        recording.tape.backward(shared, lane);
        values
    }

    /// The whole prediction for a sample, and the sample's truth [n].
    pub(super) fn compared(
        model: &HostModel,
        sample: &Sample,
        recording: &Recording,
        shared: &Shared,
        lane: &mut Lane,
    ) -> Result<[Vec<DVec3>; 2]> {
        check(model, sample)?;
        Self::posed(model, &sample.joints)?.predict(recording, shared, lane);
        Ok([lane.value(shared, recording.prediction(Prediction::Whole)), &sample.truth].map(vertices))
    }

    fn predict(&self, recording: &Recording, shared: &Shared, lane: &mut Lane) {
        let a = &recording.activations;
        lane.value_mut(a.pose).copy_from_slice(&self.body_frame.vector);
        lane.value_mut(a.body_frame).copy_from_slice(&self.body_frame.transforms);
        recording.tape.forward(shared, lane);
    }
}

fn check(model: &HostModel, sample: &Sample) -> Result<()> {
    let (wanted, found) = (model.sizes.vertices, sample.truth.len() / 3);
    if sample.truth.len() == 3 * wanted {
        return Ok(());
    }
    Err(Error::Training(format!("a sample has {found} vertices, the model {wanted}")))
}
