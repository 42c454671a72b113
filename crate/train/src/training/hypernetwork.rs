//! A network that makes arrays of the model, instead of their being learned themselves (Ha, Dai and Le 2017,
//! HyperNetworks). It does not see the pose, so it runs once a step.

use super::parameters::Parameters;
use super::tape::{Id, Lane, Tape};
use crate::Result;

/// The network, and what it makes.
pub(crate) struct Hypernetwork {
    tape: Tape,
    lane: Lane,
    /// What is learned.
    pub parameters: Parameters,
    /// Its outputs, and the names of the model's arrays that they become.
    outputs: Vec<(Id, String)>,
}

impl Hypernetwork {
    /// A recorded network.
    pub fn new(tape: Tape, parameters: Parameters, outputs: Vec<(Id, String)>) -> Result<Self> {
        let lane = tape.lane(&parameters.shared, &outputs.iter().map(|(id, _)| *id).collect::<Vec<_>>())?;
        Ok(Self { tape, lane, parameters, outputs })
    }

    /// Whether it makes the model's array of that name.
    pub fn makes(&self, array: &str) -> bool {
        self.outputs.iter().any(|(_, name)| name == array)
    }

    /// Makes the arrays anew, in the `model` that trains.
    pub fn make(&mut self, model: &mut Parameters) {
        self.tape.forward(&self.parameters.shared, &mut self.lane);
        for (id, name) in &self.outputs {
            let array = model.get_mut(name);
            array.into_iter().for_each(|array| array.copy_from_slice(self.lane.value(&self.parameters.shared, *id)));
        }
    }

    /// Step number `step` (from 1) against the gradients of what it made: the parts of each array's gradient, by name.
    pub fn step<'a>(&mut self, step: usize, rate: f32, gradients: impl Fn(&str) -> Vec<&'a [f32]>) {
        let Self { tape, lane, parameters, outputs } = self;
        let ids = parameters.ids();
        ids.iter().for_each(|id| lane.gradient_mut(*id).fill(0.0));
        for (id, name) in outputs {
            let sum = lane.gradient_mut(*id);
            sum.fill(0.0);
            gradients(name).iter().for_each(|part| sum.iter_mut().zip(*part).for_each(|(sum, g)| *sum += g));
        }
        tape.backward(&parameters.shared, lane);
        parameters.step(step, rate, |i, _| Some(vec![lane.gradient(ids[i])]));
    }
}
