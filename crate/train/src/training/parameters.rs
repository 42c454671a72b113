//! The arrays that Adam steps, by name, with its moments.

use super::adam::Moments;
use super::blur::{blur, is_blurred};
use super::tape::{Id, Shared};
use crate::{Error, Result};
use ctsn_core::file::{Tensor, Tensors};
use ctsn_core::model::is_embedding_weight;
use ctsn_core::topology::Graph;

/// One array.
struct Parameter {
    name: String,
    id: Id,
    /// Entries that stay zero: between the parts of Φ, [`super::limbs`].
    silent: Vec<usize>,
    moments: Moments,
}

/// The arrays of one network; its constants are here, too, shared by all lanes.
pub(crate) struct Parameters {
    pub shared: Shared,
    list: Vec<Parameter>,
    /// The cloth over which steps of its bases are averaged.
    cloth: Option<Graph<Vec<u32>>>,
}

impl Parameters {
    /// Arrays at their first values, moments at rest.
    pub fn new(shared: Shared, arrays: Vec<(String, Id)>) -> Self {
        let parameter = |(name, id): (String, Id)| {
            let values = shared.get(id);
            let silent =
                (0..values.len()).filter(|entry| is_embedding_weight(&name) && values[*entry] == 0.0).collect();
            Parameter { silent, moments: Moments::new(values.len()), name, id }
        };
        Self { list: arrays.into_iter().map(parameter).collect(), shared, cloth: None }
    }

    /// The same, with steps of the bases averaged over a cloth.
    pub fn over(self, cloth: Graph<Vec<u32>>) -> Self {
        Self { cloth: Some(cloth), ..self }
    }

    /// Their buffers.
    pub fn ids(&self) -> Vec<Id> {
        self.list.iter().map(|parameter| parameter.id).collect()
    }

    /// Their names and values, in order.
    pub fn each(&self) -> impl Iterator<Item = (&str, &[f32])> {
        self.list.iter().map(|Parameter { name, id, .. }| (name.as_str(), self.shared.get(*id)))
    }

    /// How many numbers they are.
    pub fn count(&self) -> usize {
        self.each().map(|(_, values)| values.len()).sum()
    }

    /// The values of one, to be changed.
    pub fn get_mut(&mut self, name: &str) -> Option<&mut Vec<f32>> {
        let id = self.list.iter().find(|parameter| parameter.name == name)?.id;
        Some(self.shared.get_mut(id))
    }

    /// Step number `step` (from 1) of Adam; `gradients` gives the parts of an array's gradient, by number and name,
    /// `None` where it is not to be stepped.
    pub fn step<'a>(&mut self, step: usize, rate: f32, gradients: impl Fn(usize, &str) -> Option<Vec<&'a [f32]>>) {
        for (i, Parameter { name, id, silent, moments }) in self.list.iter_mut().enumerate() {
            let Some(gradients) = gradients(i, name) else { continue };
            let values = self.shared.get_mut(*id);
            if let Some(cloth) = self.cloth.as_ref().filter(|_| is_blurred(name)) {
                let mut change = vec![0.0; values.len()];
                moments.step(step, rate, &gradients, &mut change);
                blur(cloth, &mut change);
                values.iter_mut().zip(&change).for_each(|(value, change)| *value += change);
                continue;
            }
            moments.step(step, rate, &gradients, values);
            silent.iter().for_each(|entry| values[*entry] = 0.0);
        }
    }

    /// Adds values and moments to a checkpoint.
    pub fn save(&self, file: &mut Tensors) {
        for Parameter { name, id, moments, .. } in &self.list {
            let parts = [("value", self.shared.get(*id)), ("mean", &moments.mean), ("square", &moments.square)];
            for (part, values) in parts {
                file.tensors.insert(format!("{name}.{part}"), Tensor::f32(&[values.len()], values));
            }
        }
    }

    /// Takes them from a checkpoint.
    pub fn load(&mut self, file: &Tensors) -> Result<()> {
        for Parameter { name, id, moments, .. } in &mut self.list {
            let parts =
                [("value", self.shared.get_mut(*id)), ("mean", &mut moments.mean), ("square", &mut moments.square)];
            for (part, values) in parts {
                let stored = file.f32(&format!("{name}.{part}"), &[Some(values.len())]);
                *values = stored.map_err(|error| Error::Training(error.to_string()))?.0;
            }
        }
        Ok(())
    }
}
