//! One pose on the tape: its body frame and targets, the losses and what flows back from them. network.md §6.

use super::Loss;
use super::gradient::distance::distance;
use super::penetration::Penetration;
use super::recording::Recording;
use super::smooth::Smoother;
use super::tape::{Id, Lane, Shared};
use crate::dataset::Sample;
use crate::evaluate::differences;
use crate::rig::vertices;
use crate::{Error, Result};
use ctsn_core::model::HostModel;
use ctsn_core::pose::BodyFrame;

/// One pose as the tape sees it.
pub(crate) struct Item {
    pub frame: BodyFrame,
    /// Empty where nothing was simulated: such a pose teaches only to stay outside the body.
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
        let smooth = smoother.map_or_else(|| sample.truth.clone(), |smoother| smoother.smooth(&sample.truth));
        Ok(Self { truth: sample.truth.clone(), smooth, ..Self::posed(model, &sample.joints)? })
    }

    /// A pose without truth: world joint transforms, row-major.
    pub fn posed(model: &HostModel, joints: &[f32]) -> Result<Self> {
        let mut frame = BodyFrame::new(model.sizes.joints);
        model.rig.body_frame(joints, &mut frame)?;
        Ok(Self { frame, truth: Vec::new(), smooth: Vec::new() })
    }

    /// Forward and backward pass; gradients are those of the mean loss of `batch` poses. `penetration` takes part where there is one.
    pub(super) fn learn(
        &self,
        recording: &Recording,
        shared: &Shared,
        lane: &mut Lane,
        mut penetration: Option<&mut Penetration>,
        batch: usize,
    ) -> Loss {
        self.predict(recording, shared, lane);
        let scale = 1.0 / batch as f32;
        if let Some(penetration) = &mut penetration {
            penetration.pose(&self.frame);
        }
        let mut against = |predicted: Id, truth: &[f32]| {
            let mut g = lane.take_gradient(predicted);
            let value = lane.value(shared, predicted);
            let distance = if truth.is_empty() {
                g.fill(0.0);
                0.0
            } else {
                distance(value, truth, scale, &mut g)
            };
            let depth = penetration.as_mut().map_or(0.0, |penetration| penetration.loss(value, scale, &mut g));
            *lane.gradient_mut(predicted) = g;
            (distance, depth)
        };
        let (fine, penetration) = against(recording.activations.positions, &self.truth);
        let coarse = recording.coarse.map_or(fine, |coarse| against(coarse, &self.smooth).0);
        recording.tape.backward(shared, lane);
        Loss { coarse, fine, penetration }
    }

    /// Distance of the prediction from the truth (metres) and angle between their normals (degrees).
    pub(super) fn compare(
        &self,
        triangles: &[u32],
        recording: &Recording,
        shared: &Shared,
        lane: &mut Lane,
    ) -> (f64, f64) {
        self.predict(recording, shared, lane);
        let predicted = lane.value(shared, recording.activations.positions);
        differences(&vertices(predicted), &vertices(&self.truth), triangles)
    }

    fn predict(&self, recording: &Recording, shared: &Shared, lane: &mut Lane) {
        let a = &recording.activations;
        lane.value_mut(a.pose).copy_from_slice(&self.frame.vector);
        lane.value_mut(a.body_frame).copy_from_slice(&self.frame.transforms);
        recording.tape.run(shared, lane);
    }
}
