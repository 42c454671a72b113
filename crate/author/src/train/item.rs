//! One sample on the tape: its body frame and targets, the losses and what flows back from them. network.md §6.

use super::Loss;
use super::gradient::distance::distance;
use super::smooth::Smoother;
use super::tape::{Id, Lane, Shared, Tape};
use crate::dataset::Sample;
use crate::evaluate::differences;
use crate::rig::vertices;
use crate::{Error, Result};
use ctsn_core::model::HostModel;
use ctsn_core::network::Activations;
use ctsn_core::pose::BodyFrame;

/// One sample as the tape sees it.
pub(crate) struct Item {
    pub frame: BodyFrame,
    pub truth: Vec<f32>,
    /// What the skeleton stream learns.
    pub smooth: Vec<f32>,
}

impl Item {
    /// A sample for `model`, its coarse target smoothed where a smoother is given.
    pub fn new(model: &HostModel, sample: &Sample, smoother: Option<&Smoother>) -> Result<Self> {
        if sample.truth.len() != model.sizes.vertices * 3 {
            let (wanted, found) = (model.sizes.vertices, sample.truth.len() / 3);
            return Err(Error::Training(format!("a sample has {found} vertices, the model {wanted}")));
        }
        let mut frame = BodyFrame::new(model.sizes.joints);
        model.rig.body_frame(&sample.joints, &mut frame)?;
        let smooth = smoother.map_or_else(|| sample.truth.clone(), |smoother| smoother.smooth(&sample.truth));
        Ok(Self { frame, truth: sample.truth.clone(), smooth })
    }

    /// Forward and backward pass; gradients are those of the mean loss of `batch` samples. `coarse` is the coarse prediction where both
    /// streams learn: what is left of the network otherwise learns the truth itself.
    pub fn learn(
        &self,
        tape: &Tape,
        shared: &Shared,
        lane: &mut Lane,
        a: &Activations<Id>,
        coarse: Option<Id>,
        batch: usize,
    ) -> Loss {
        self.predict(tape, shared, lane, a);
        let mut against = |predicted: Id, truth: &[f32]| {
            let mut g = lane.take_gradient(predicted);
            let loss = distance(lane.value(shared, predicted), truth, 1.0 / batch as f32, &mut g);
            *lane.gradient_mut(predicted) = g;
            loss
        };
        let fine = against(a.positions, &self.truth);
        let loss = Loss { fine, coarse: coarse.map_or(fine, |coarse| against(coarse, &self.smooth)) };
        tape.backward(shared, lane);
        loss
    }

    /// Distance of the prediction from the truth (metres) and angle between their normals (degrees).
    pub fn compare(
        &self,
        model: &HostModel,
        tape: &Tape,
        shared: &Shared,
        lane: &mut Lane,
        a: &Activations<Id>,
    ) -> (f64, f64) {
        self.predict(tape, shared, lane, a);
        differences(&vertices(lane.value(shared, a.positions)), &vertices(&self.truth), &model.triangles)
    }

    fn predict(&self, tape: &Tape, shared: &Shared, lane: &mut Lane, a: &Activations<Id>) {
        lane.value_mut(a.pose).copy_from_slice(&self.frame.vector);
        lane.value_mut(a.body_frame).copy_from_slice(&self.frame.transforms);
        tape.run(shared, lane);
    }
}
