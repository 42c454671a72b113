//! Gradients, one file per operation, named as the operation. [`flow`] says which operands one reaches, [`backward`]
//! hands it them. Convention: every activation is read by one operation that learns, so its gradient is overwritten; a
//! parameter's is added to, over the samples of a lane.

pub mod attend;
pub mod blend;
mod ends;
pub mod gate;
pub mod linear;
pub mod polishing;
pub mod skin;

use super::tape::{Id, IndexId, Lane, Shared, Step, Tape};
use ctsn_core::operation::{Activation, Attend, Operation, Space};
use ctsn_core::topology::Graph;

/// Room the operations need backwards.
#[derive(Default)]
pub struct Scratch {
    attend: attend::Scratch,
}

/// The way of a gradient through an operation.
pub(super) struct Flow {
    /// The result that it comes from.
    pub from: Id,
    /// A result between, that only the operation itself reads.
    pub through: Option<Id>,
    /// The operands that it goes to.
    pub to: Vec<Id>,
    /// Operands where it ends by design.
    pub ends: Vec<Id>,
    /// Whether what a loss left at the operands stays, and this comes to it.
    pub adds: bool,
}

impl Flow {
    fn new<const N: usize>(from: Id, to: [Id; N]) -> Self {
        Self { from, through: None, to: to.to_vec(), ends: Vec::new(), adds: false }
    }
}

/// The way of a step's gradient; `None` of one without.
pub(super) fn flow(step: &Step) -> Option<Flow> {
    let operation = match step {
        Step::Operation(operation) => operation,
        Step::Add { residual, total, .. } => return Some(Flow::new(*total, [*residual])),
        Step::Polish { from, polished, .. } => return Some(Flow { adds: true, ..Flow::new(*polished, [*from]) }),
    };
    match operation {
        Operation::Linear(it) => Some(Flow::new(it.y, [it.x, it.weight, it.bias])),
        // The rest learns elsewhere or not at all: network.md §6.
        Operation::Blend(it) => Some(Flow { ends: vec![it.rest], ..Flow::new(it.template, [it.weights, it.basis]) }),
        Operation::Skin(it) if it.space == Space::Body => Some(Flow::new(it.positions, [it.rest, it.weights])),
        Operation::Attend(it) => {
            let to = [it.projected, it.edge, it.gate, it.norm_weight, it.norm_bias];
            Some(Flow { through: Some(it.attended), ..Flow::new(it.output, to) })
        }
        other => ends::flow(other),
    }
}

/// Adds the gradients of one step's operands from that of its result.
pub(super) fn backward(tape: &Tape, step: &Step, shared: &Shared, lane: &mut Lane) {
    let operation = match step {
        Step::Operation(operation) => operation,
        Step::Add { residual, total, .. } => {
            return lane.add_to(*total, [*residual], |_, g, [dresidual]| dresidual.copy_from_slice(g));
        }
        Step::Polish { cut, from, trail, polished } => {
            return lane.add_to(*polished, [*from], |lane, g, [dfrom]| {
                if !lane.losses.contains(from) {
                    dfrom.fill(0.0);
                }
                polishing::backward(&cut.of(tape, shared), lane.value(shared, *trail), g, dfrom);
            });
        }
    };
    match operation {
        Operation::Linear(it) => {
            lane.add_to(it.y, [it.x, it.weight, it.bias], |lane, dy, [dx, dweight, dbias]| {
                if it.activation == Activation::Relu {
                    linear::mask(lane.value(shared, it.y), dy);
                }
                linear::linear(lane.value(shared, it.x), lane.value(shared, it.weight), dy, dx, dweight, dbias);
            });
        }
        Operation::Blend(it) => {
            lane.add_to(it.template, [it.weights, it.basis], |lane, g, [dweights, dbasis]| {
                let [weights, basis, share] = [it.weights, it.basis, it.share].map(|id| lane.value(shared, id));
                blend::blend(lane.level, weights, basis, share[0], g, dweights, dbasis);
            });
        }
        Operation::Skin(it) => {
            lane.add_to(it.positions, [it.rest, it.weights], |lane, g, [drest, dweights]| {
                let [rest, weights, transforms] = [it.rest, it.weights, it.transforms].map(|id| lane.value(shared, id));
                skin::skin(rest, tape.indices_of(it.joints), weights, transforms, g, drest, dweights);
            });
        }
        Operation::Attend(it) => attend_and_gate(tape, it, shared, lane),
        _ => unreachable!("the tape runs only what has a flow backwards"),
    }
}

/// First the gate, which tells what falls on ĥ, then attention.
fn attend_and_gate(tape: &Tape, it: &Attend<Id, Id, IndexId>, shared: &Shared, lane: &mut Lane) {
    let targets = [it.attended, it.projected, it.gate, it.norm_weight, it.norm_bias];
    lane.add_to(it.output, targets, |lane, g, targets| {
        let value = |id| lane.value(shared, id);
        let inputs = gate::Inputs {
            attended: value(it.attended),
            projected: value(it.projected),
            gate: value(it.gate),
            norm_weight: value(it.norm_weight),
            output: value(it.output),
        };
        gate::gate(lane.level, &inputs, g, targets);
    });
    let mut scratch = std::mem::take(&mut lane.scratch.attend);
    lane.add_to(it.attended, [it.projected, it.edge], |lane, g, [dprojected, dedge]| {
        let inputs = attend::Inputs {
            graph: Graph { offsets: tape.indices_of(it.offsets), neighbours: tape.indices_of(it.neighbours) },
            heads: it.heads,
            projected: lane.value(shared, it.projected),
            potentials: lane.value(shared, it.potentials),
        };
        attend::attend(lane.level, &inputs, g, &mut scratch, dprojected, dedge);
    });
    lane.scratch.attend = scratch;
}

impl Lane {
    /// Lends the output's gradient and the targets' gradients while the values can be read.
    fn add_to<const N: usize>(
        &mut self,
        output: Id,
        targets: [Id; N],
        add: impl FnOnce(&Self, &mut [f32], [&mut [f32]; N]),
    ) {
        let mut gradient = self.take_gradient(output);
        let mut taken = targets.map(|id| self.take_gradient(id));
        add(self, &mut gradient, taken.each_mut().map(|target| target.as_mut_slice()));
        for (id, target) in targets.into_iter().zip(taken) {
            *self.gradient_mut(id) = target;
        }
        *self.gradient_mut(output) = gradient;
    }
}
