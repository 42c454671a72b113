//! The tape: a device that records the operations of one forward pass, to run them and their gradients on the CPU.
//! Recorded once per model and shared by all lanes: a [`Lane`] holds the values and gradients of one sample.

use super::gradient;
use ctsn_core::cpu::Level;
use ctsn_core::device::{Activation, Device, Space};
use ctsn_core::model::{Layer, Linear, Reference, Sizes, Skin};
use ctsn_core::network::Drawn;
use ctsn_core::pose::Rig;
use ctsn_core::topology::Graph;

/// A buffer of the tape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Id(usize);

/// Constant indices of the tape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexId(usize);

/// One recorded operation with its operands.
pub(super) enum Operation {
    Linear { x: Id, layer: Linear<Id>, activation: Activation, y: Id },
    Blend { weights: Id, basis: Id, rest: Id, residual: Id, template: Id },
    Skin { rest: Id, skin: Skin<Id, IndexId>, transforms: Id, positions: Id },
    Features { v: Id, rest: Id, reference: Reference<Id, IndexId>, nodes: Id, potentials: Id },
    Attend { graph: usize, heads: usize, projected: Id, potentials: Id, edge: Id, attended: Id },
    Gate { attended: Id, projected: Id, layer: Layer<Id>, output: Id },
}

/// The recorded forward pass.
#[derive(Default)]
pub struct Tape {
    lengths: Vec<usize>,
    initial: Vec<Vec<f32>>,
    indices: Vec<Vec<u32>>,
    graphs: Vec<Graph<Vec<u32>>>,
    /// Operations in order, each with whether anything before it learns.
    operations: Vec<(Operation, bool)>,
    trainable: Vec<bool>,
}

/// Values and gradients of one sample on its way through a [`Tape`], reused from sample to sample.
pub struct Lane {
    pub(super) level: Level,
    pub(super) scratch: gradient::Scratch,
    /// Activations; buffers of the model stay empty here, they are shared.
    values: Vec<Vec<f32>>,
    /// Gradients: of activations for this sample, of parameters summed over samples. Empty where none is wanted.
    gradients: Vec<Vec<f32>>,
}

/// Weights and constants of the model by buffer, shared by all lanes.
pub struct Shared(Vec<Vec<f32>>);

impl Tape {
    /// Ends the upload of the model: hands over its buffers and marks `parameters` as trainable.
    /// Buffers made afterwards are activations.
    pub fn seal(&mut self, parameters: &[&Id]) -> Shared {
        self.trainable = vec![false; self.lengths.len()];
        parameters.iter().for_each(|id| self.trainable[id.0] = true);
        Shared(std::mem::take(&mut self.initial))
    }

    /// A lane for this tape.
    pub fn lane(&self, shared: &Shared) -> Lane {
        let shared = shared.0.len();
        let own = |(i, length): (usize, &usize)| vec![0.0; if i < shared { 0 } else { *length }];
        let gradient = |(length, trainable): (&usize, &bool)| vec![0.0; if *trainable { *length } else { 0 }];
        Lane {
            level: Level::new(),
            scratch: gradient::Scratch::default(),
            values: self.lengths.iter().enumerate().map(own).collect(),
            gradients: self.lengths.iter().zip(&self.trainable).map(gradient).collect(),
        }
    }

    /// Runs the recorded operations.
    pub fn run(&self, shared: &Shared, lane: &mut Lane) {
        self.operations.iter().for_each(|(operation, _)| gradient::run(self, operation, shared, lane));
    }

    /// Runs the gradients backwards, from those already stored in activations. Parameters' gradients are added to.
    pub fn backward(&self, shared: &Shared, lane: &mut Lane) {
        let learning = self.operations.iter().rev().filter(|(_, learns)| *learns);
        learning.for_each(|(operation, _)| gradient::backward(self, operation, shared, lane));
    }

    pub(super) fn indices_of(&self, id: IndexId) -> &[u32] {
        &self.indices[id.0]
    }

    pub(super) fn graph(&self, graph: usize) -> &Graph<Vec<u32>> {
        &self.graphs[graph]
    }

    fn record(&mut self, inputs: &[Id], output: Id, operation: Operation) {
        let learns = inputs.iter().any(|id| self.trainable[id.0]);
        self.trainable[output.0] = learns;
        self.operations.push((operation, learns));
    }
}

impl Shared {
    /// The values of a parameter, to be changed between steps.
    pub fn get_mut(&mut self, id: Id) -> &mut Vec<f32> {
        &mut self.0[id.0]
    }

    /// The values of a buffer of the model.
    pub fn get(&self, id: Id) -> &[f32] {
        &self.0[id.0]
    }
}

impl Lane {
    /// Value of a buffer: the model's or this lane's.
    pub fn value<'a>(&'a self, shared: &'a Shared, id: Id) -> &'a [f32] {
        shared.0.get(id.0).unwrap_or(&self.values[id.0])
    }

    /// An activation, to be written.
    pub fn value_mut(&mut self, id: Id) -> &mut Vec<f32> {
        &mut self.values[id.0]
    }

    /// A gradient.
    pub fn gradient(&self, id: Id) -> &[f32] {
        &self.gradients[id.0]
    }

    /// A gradient, to be written; empty where none is wanted.
    pub fn gradient_mut(&mut self, id: Id) -> &mut Vec<f32> {
        &mut self.gradients[id.0]
    }

    /// Clears the gradients of the activations, and those of the parameters as well with `all`.
    pub fn clear(&mut self, shared: &Shared, all: bool) {
        let first = if all { 0 } else { shared.0.len() };
        self.gradients[first..].iter_mut().for_each(|gradient| gradient.fill(0.0));
    }

    pub(super) fn take_value(&mut self, id: Id) -> Vec<f32> {
        std::mem::take(&mut self.values[id.0])
    }

    pub(super) fn take_gradient(&mut self, id: Id) -> Vec<f32> {
        std::mem::take(&mut self.gradients[id.0])
    }
}

impl Device for Tape {
    type Buffer = Id;
    type Indices = IndexId;

    fn buffer(&mut self, values: &[f32]) -> Id {
        self.lengths.push(values.len());
        if self.trainable.is_empty() {
            self.initial.push(values.to_vec());
        } else {
            self.trainable.push(false);
        }
        Id(self.lengths.len() - 1)
    }

    fn indices(&mut self, indices: &[u32]) -> IndexId {
        self.indices.push(indices.to_vec());
        IndexId(self.indices.len() - 1)
    }

    fn write(&mut self, buffer: &mut Id, values: &[f32]) {
        self.initial[buffer.0].copy_from_slice(values);
    }

    fn linear(&mut self, x: &Id, layer: &Linear<Id>, activation: Activation, y: &mut Id) {
        let operation = Operation::Linear { x: *x, layer: layer.clone(), activation, y: *y };
        self.record(&[*x, layer.weight, layer.bias], *y, operation);
    }

    fn body_frame(&mut self, _rig: &Rig, _joints: &Id, _transforms: &mut Id, _vector: &mut Id) {
        // Samples come in the body frame, so there is nothing to remember.
    }

    fn blend(&mut self, weights: &Id, basis: &Id, rest: &Id, residual: &mut Id, template: &mut Id) {
        let (rest, residual, template) = (*rest, *residual, *template);
        let operation = Operation::Blend { weights: *weights, basis: *basis, rest, residual, template };
        self.record(&[*weights, *basis], template, operation);
    }

    fn skin(&mut self, rest: &Id, skin: &Skin<Id, IndexId>, transforms: &Id, _space: Space, positions: &mut Id) {
        // Losses live in the body frame, whatever space is asked for: network.md §6.
        let operation =
            Operation::Skin { rest: *rest, skin: skin.clone(), transforms: *transforms, positions: *positions };
        self.record(&[*rest, skin.weights], *positions, operation);
    }

    fn features(&mut self, v: &Id, rest: &Id, reference: &Reference<Id, IndexId>, nodes: &mut Id, potentials: &mut Id) {
        let (reference, potentials) = (reference.clone(), *potentials);
        let operation = Operation::Features { v: *v, rest: *rest, reference, nodes: *nodes, potentials };
        self.record(&[*v, *rest], *nodes, operation);
    }

    fn attend(
        &mut self,
        graph: &Graph<IndexId>,
        sizes: Sizes,
        projected: &mut Id,
        potentials: &Id,
        layer: &Layer<Id>,
        attended: &mut Id,
        output: &mut Id,
    ) {
        let [offsets, neighbours] = [graph.offsets, graph.neighbours].map(|id| self.indices[id.0].clone());
        self.graphs.push(Graph { offsets, neighbours });
        let operation = Operation::Attend {
            graph: self.graphs.len() - 1,
            heads: sizes.heads,
            projected: *projected,
            potentials: *potentials,
            edge: layer.edge,
            attended: *attended,
        };
        self.record(&[*projected, layer.edge], *attended, operation);
        let operation =
            Operation::Gate { attended: *attended, projected: *projected, layer: layer.clone(), output: *output };
        self.record(&[*attended, *projected], *output, operation);
    }

    fn normals(&mut self, _positions: &Id, _triangles: &[u32], _normals: &mut Id) {
        // Not part of the loss (network.md §6), so there is nothing to remember.
    }

    fn surface(&mut self, _vertex: &[u32], _positions: &Id, _normals: &Id, _drawn: &mut Drawn<Id>) {
        // Nor is this.
    }
}
