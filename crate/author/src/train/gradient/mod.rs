//! Gradients, one file per operation, named as the operation. `run` and `backward` hand a recorded operation its operands.
//! Convention: every activation is read by one operation that learns, so its gradient is overwritten; a parameter's is added to, over
//! the samples of a lane.

pub mod attend;
pub mod blend;
pub mod distance;
pub mod gate;
pub mod linear;
pub mod skin;

use super::operation::Operation;
use super::tape::{Id, Lane, Shared, Tape};
use ctsn_core::cpu;
use ctsn_core::device::{Activation, Space};
use ctsn_core::model::Reference;

/// Room the operations need, forwards and backwards.
#[derive(Default)]
pub struct Scratch {
    forward: cpu::attend::Scratch,
    attend: attend::Scratch,
}

/// Runs one operation: the CPU device's own kernels.
pub(super) fn run(tape: &Tape, operation: &Operation, shared: &Shared, lane: &mut Lane) {
    let level = lane.level;
    match operation {
        Operation::Linear { x, layer, activation, y } => lane.write(*y, |lane, y| {
            let value = |id| lane.value(shared, id);
            cpu::linear::linear(level, value(*x), value(layer.weight), value(layer.bias), *activation, y);
        }),
        Operation::Blend { weights, basis, rest, residual, template } => lane.write(*residual, |lane, residual| {
            lane.write(*template, |lane, template| {
                let value = |id| lane.value(shared, id);
                cpu::blend::blend(level, value(*weights), value(*basis), value(*rest), 1.0, residual, template);
            });
        }),
        Operation::Add { rest, residual, total } => lane.write(*total, |lane, total| {
            total.copy_from_slice(lane.value(shared, *rest));
            total.iter_mut().zip(lane.value(shared, *residual)).for_each(|(total, by)| *total += by);
        }),
        Operation::Skin { rest, skin, transforms, positions } => lane.write(*positions, |lane, positions| {
            let value = |id| lane.value(shared, id);
            let joints = tape.indices_of(skin.joints);
            cpu::skin::skin(
                level,
                value(*rest),
                joints,
                value(skin.weights),
                value(*transforms),
                Space::Body,
                positions,
            );
        }),
        Operation::Features { v, rest, reference, nodes, potentials } => lane.write(*nodes, |lane, nodes| {
            lane.write(*potentials, |lane, potentials| {
                let (v, rest) = (lane.value(shared, *v), lane.value(shared, *rest));
                let Reference { mean, std, edge_scale, .. } = reference;
                cpu::features::features(v, rest, mean, std, *edge_scale, nodes, potentials);
            });
        }),
        Operation::Attend { graph, heads, projected, potentials, edge, attended } => {
            let mut scratch = std::mem::take(&mut lane.scratch.forward);
            lane.write(*projected, |lane, projected| {
                lane.write(*attended, |lane, attended| {
                    let (graph, potentials, edge) =
                        (tape.graph(*graph), lane.value(shared, *potentials), lane.value(shared, *edge));
                    cpu::attend::attend(level, graph, *heads, projected, potentials, edge, &mut scratch, attended);
                });
            });
            lane.scratch.forward = scratch;
        }
        Operation::Gate { attended, projected, layer, output } => lane.write(*output, |lane, output| {
            let value = |id| lane.value(shared, id);
            let norm = (value(layer.norm_weight), value(layer.norm_bias));
            cpu::gate::gate(level, value(*attended), value(*projected), value(layer.gate), norm.0, norm.1, output);
        }),
    }
}

/// Adds the gradients of one operation's inputs from that of its output.
pub(super) fn backward(tape: &Tape, operation: &Operation, shared: &Shared, lane: &mut Lane) {
    match operation {
        Operation::Linear { x, layer, activation, y } => {
            let targets = [*x, layer.weight, layer.bias];
            lane.add_to(*y, targets, |lane, dy, [dx, dweight, dbias]| {
                if *activation == Activation::Relu {
                    linear::mask(lane.value(shared, *y), dy);
                }
                linear::linear(lane.value(shared, *x), lane.value(shared, layer.weight), dy, dx, dweight, dbias);
            });
        }
        // The rest learns elsewhere or not at all: network.md §6.
        Operation::Blend { weights, basis, template, .. } => {
            lane.add_to(*template, [*weights, *basis], |lane, g, [dweights, dbasis]| {
                let (weights, basis) = (lane.value(shared, *weights), lane.value(shared, *basis));
                blend::blend(lane.level, weights, basis, g, dweights, dbasis);
            });
        }
        Operation::Add { residual, total, .. } => {
            lane.add_to(*total, [*residual], |_, g, [dresidual]| dresidual.copy_from_slice(g));
        }
        Operation::Skin { rest, skin, transforms, positions } => {
            lane.add_to(*positions, [*rest, skin.weights], |lane, g, [drest, dweights]| {
                let value = |id| lane.value(shared, id);
                let joints = tape.indices_of(skin.joints);
                skin::skin(value(*rest), joints, value(skin.weights), value(*transforms), g, drest, dweights);
            });
        }
        Operation::Features { .. } => {}
        Operation::Attend { graph, heads, projected, potentials, edge, attended } => {
            let mut scratch = std::mem::take(&mut lane.scratch.attend);
            lane.add_to(*attended, [*projected, *edge], |lane, g, [dprojected, dedge]| {
                let value = |id| lane.value(shared, id);
                let inputs = attend::Inputs {
                    graph: tape.graph(*graph),
                    heads: *heads,
                    projected: value(*projected),
                    potentials: value(*potentials),
                };
                attend::attend(lane.level, &inputs, g, &mut scratch, dprojected, dedge);
            });
            lane.scratch.attend = scratch;
        }
        Operation::Gate { attended, projected, layer, output } => {
            let targets = [*attended, *projected, layer.gate, layer.norm_weight, layer.norm_bias];
            lane.add_to(*output, targets, |lane, g, targets| {
                let value = |id| lane.value(shared, id);
                let inputs = gate::Inputs {
                    attended: value(*attended),
                    projected: value(*projected),
                    gate: value(layer.gate),
                    norm_weight: value(layer.norm_weight),
                    output: value(*output),
                };
                gate::gate(lane.level, &inputs, g, targets);
            });
        }
    }
}

impl Lane {
    /// Lends an activation for writing while the others can be read.
    fn write(&mut self, id: Id, fill: impl FnOnce(&mut Self, &mut [f32])) {
        let mut value = self.take_value(id);
        fill(self, &mut value);
        *self.value_mut(id) = value;
    }

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
