//! The tape: a device that records the operations of one forward pass, to run them and their gradients on the CPU.
//! Recorded once per model and shared by all lanes: a [`Lane`] holds the values and gradients of one sample.

use super::gradient;
use super::operation::Operation;
use ctsn_core::cpu::Level;
use ctsn_core::device::{Activation, Device, Space};
use ctsn_core::model::{Body, Layer, Linear, Reference, Sizes, Skin};
use ctsn_core::network::Drawn;
use ctsn_core::pose::Rig;
use ctsn_core::topology::Graph;

/// A buffer of the tape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Id(usize);

/// Constant indices of the tape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexId(usize);

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
    /// Gradients: of parameters by buffer, summed over samples; of activations by slot, for this sample. Empty where none is wanted.
    gradients: Vec<Vec<f32>>,
    /// Where the gradient of a buffer is.
    slots: Vec<usize>,
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
        let (slots, lengths) = self.slots(shared);
        Lane {
            level: Level::new(),
            scratch: gradient::Scratch::default(),
            values: self.lengths.iter().enumerate().map(own).collect(),
            gradients: lengths.into_iter().map(|length| vec![0.0; length]).collect(),
            slots,
        }
    }

    /// Slot of every buffer's gradient, and the slots' lengths. On the way back, a gradient is done with after the operation that made
    /// its buffer: its slot serves the next of the same length, so that the cache holds more of what is worked on.
    fn slots(&self, shared: usize) -> (Vec<usize>, Vec<usize>) {
        let learning = |i: usize| if self.trainable[i] { self.lengths[i] } else { 0 };
        let mut slots: Vec<usize> = (0..self.lengths.len()).collect();
        let mut lengths: Vec<usize> = (0..self.lengths.len()).map(learning).collect();
        let mut read = vec![false; self.lengths.len()];
        let operations = || self.operations.iter().filter(|(_, learns)| *learns);
        operations().for_each(|(operation, _)| operation.learns_from().iter().for_each(|id| read[id.0] = true));
        let mut free: Vec<usize> = Vec::new();
        let mut placed = vec![false; self.lengths.len()];
        for (operation, _) in operations().rev() {
            for id in operation.learns_from().into_iter().filter(|id| id.0 >= shared && self.trainable[id.0]) {
                if std::mem::replace(&mut placed[id.0], true) {
                    continue;
                }
                if let Some(at) = free.iter().position(|slot| lengths[*slot] == self.lengths[id.0]) {
                    lengths[id.0] = 0;
                    slots[id.0] = free.swap_remove(at);
                }
            }
            // A loss writes its gradient before the first operation: that slot is never another's.
            if read[operation.output().0] {
                free.push(slots[operation.output().0]);
            }
        }
        (slots, lengths)
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

    /// A gradient; empty where none is wanted.
    pub fn gradient(&self, id: Id) -> &[f32] {
        &self.gradients[self.slots[id.0]]
    }

    /// A gradient, to be written; empty where none is wanted.
    pub fn gradient_mut(&mut self, id: Id) -> &mut Vec<f32> {
        &mut self.gradients[self.slots[id.0]]
    }

    /// Exchanges the gradients of `parameters` with `sums`: lanes may share the room for everything else.
    pub fn exchange(&mut self, parameters: &[Id], sums: &mut [Vec<f32>]) {
        parameters.iter().zip(sums).for_each(|(id, sum)| std::mem::swap(sum, &mut self.gradients[id.0]));
    }

    pub(super) fn take_value(&mut self, id: Id) -> Vec<f32> {
        std::mem::take(&mut self.values[id.0])
    }

    pub(super) fn take_gradient(&mut self, id: Id) -> Vec<f32> {
        std::mem::take(&mut self.gradients[self.slots[id.0]])
    }
}

impl Tape {
    /// rest + residual -> total, of any shape. No operation of the network, but of the baselines it is compared with.
    pub fn add(&mut self, rest: &Id, residual: &Id, total: &mut Id) {
        let operation = Operation::Add { rest: *rest, residual: *residual, total: *total };
        self.record(&[*residual], *total, operation);
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

    fn blend(&mut self, weights: &Id, basis: &Id, rest: &Id, _confidence: &Id, residual: &mut Id, template: &mut Id) {
        // Samples are what the range is made of, and poses mixed of them hardly leave it: their confidence is 1.
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

    fn bury(&mut self, _: &Body<Id, IndexId>, _posed: &Id, _normals: &Id, _exposed: &mut Id) {}

    fn collide(&mut self, _: &Body<Id, IndexId>, _exposed: &Id, _normals: &Id, _positions: &Id, _push: &mut Id) {
        // Nor is repair.
    }

    fn spread(&mut self, _graph: &Graph<IndexId>, _push: &Id, _before: &Id, _after: &mut Id) {}

    fn settle(&mut self, _: &Body<Id, IndexId>, _exposed: &Id, _normals: &Id, _displacement: &Id, _positions: &mut Id) {
    }

    fn surface(&mut self, _vertex: &[u32], _positions: &Id, _normals: &Id, _drawn: &mut Drawn<Id>) {
        // Nor is this.
    }
}
