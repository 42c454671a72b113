//! Every operation's gradients against central differences, towards each operand, by the suite in the core; the others
//! are refused.

use super::*;
use crate::training::tape::Shared;
use ctsn_core::suite::{Held, cases};
use std::cell::RefCell;
use std::collections::BTreeSet;

/// An operation on a tape, and which of its operands, of those read and written, learn.
struct Trial {
    tape: Tape,
    shared: Shared,
    parameters: Vec<Id>,
    written: Vec<Id>,
}

impl Trial {
    fn new(operation: &Held, learning: &[usize]) -> Self {
        let tape = RefCell::new(Tape::default());
        let buffers = RefCell::new(Vec::new());
        let buffer = |values: Vec<f32>| {
            buffers.borrow_mut().push(tape.borrow_mut().buffer(&values));
            buffers.borrow().len() - 1
        };
        let uploaded = operation.clone().map(buffer, buffer, |values| tape.borrow_mut().indices(&values));
        let (mut tape, buffers) = (tape.into_inner(), buffers.into_inner());
        let (weight, bias) = (&tape.buffer(&[1.0]), &tape.buffer(&[0.0]));
        let parameters: Vec<Id> = learning.iter().map(|operand| buffers[*operand]).collect();
        // The copies below are linear operations, which tell the gradients of all their operands.
        let shared = tape.seal(&parameters.iter().chain([weight, bias]).collect::<Vec<_>>());
        let mut written = Vec::new();
        // What is written may be read first, and what learns is never written: it begins as a copy.
        let write = |number: usize| {
            let (x, mut y) = (&buffers[number], tape.buffer(&vec![0.0; shared.get(buffers[number]).len()]));
            if learning.contains(&number) {
                tape.run(Linear { x, weight, bias, activation: Activation::None, y: &mut y }.into());
            }
            written.push(y);
            y
        };
        let mut recorded = uploaded.map(|number| buffers[number], write, |indices| indices);
        tape.run(recorded.lend());
        Self { tape, shared, parameters, written }
    }

    /// Whether a loss behind result `output` is taken, and has something to teach.
    fn teaches(&self, output: Id) -> bool {
        self.tape.lane(&self.shared, &[output]).is_ok_and(|lane| !lane.gradient(output).is_empty())
    }

    /// The gradient of a random sum of result `output` towards each parameter agrees with differences; the gradients'
    /// lengths.
    fn check(&mut self, name: &str, output: Id) -> Vec<f64> {
        let Self { tape, shared, parameters, .. } = self;
        let mut lane = tape.lane(shared, &[output]).expect("a loss that is taken");
        let mut rng = fastrand::Rng::with_seed(7);
        tape.forward(shared, &mut lane);
        let probe = random(&mut rng, lane.value(shared, output).len());
        lane.gradient_mut(output).copy_from_slice(&probe);
        tape.backward(shared, &mut lane);
        let mut lengths = Vec::new();
        for (i, parameter) in parameters.iter().enumerate() {
            let gradient = lane.gradient(*parameter).to_vec();
            let (start, noise) = (shared.get(*parameter).to_vec(), random(&mut rng, gradient.len()));
            let [length, other] = [&gradient, &noise].map(|values| product(values, values).sqrt().max(1e-9));
            let mix = |(g, noise): (&f32, &f32)| g / length as f32 + noise / other as f32;
            let direction: Vec<f32> = gradient.iter().zip(&noise).map(mix).collect();
            let mut at = |step: f32| {
                let moved = start.iter().zip(&direction).map(|(x, d)| x + step * d);
                shared.get_mut(*parameter).iter_mut().zip(moved).for_each(|(x, moved)| *x = moved);
                tape.forward(shared, &mut lane);
                product(lane.value(shared, output), &probe)
            };
            // Rounding spoils short steps, ReLU kinks long ones.
            let differences = [4.0 * STEP, STEP].map(|step| (at(step) - at(-step)) / f64::from(2.0 * step));
            at(0.0);
            let analytic = product(&gradient, &direction);
            // Both shares of the direction are of length one; what is zero is found to be zero but for rounding.
            let allowed = (TOLERANCE * analytic.abs()).max(1e-4);
            let close = differences.iter().any(|difference| (difference - analytic).abs() <= allowed);
            assert!(close, "{name}, parameter {i}: {differences:?} against {analytic}, allowed {allowed}");
            lengths.push(if length > 1e-9 { length } else { 0.0 });
        }
        lengths
    }
}

#[test]
fn gradients_agree_with_differences_and_all_others_are_refused() {
    let mut told = BTreeSet::new();
    for case in cases() {
        let (mut operands, mut results) = (0, 0);
        let _ = case.operation.clone().map(|_| operands += 1, |_| results += 1, drop);
        // Towards which operands a loss behind each result is taken, one by one; then all of them at once.
        for result in 0..results {
            let teaches = |operand: &usize| {
                let trial = Trial::new(&case.operation, &[*operand]);
                trial.teaches(trial.written[result])
            };
            let learning: Vec<usize> = (0..operands + results).filter(teaches).collect();
            let mut trial = Trial::new(&case.operation, &learning);
            if learning.is_empty() {
                continue;
            }
            let lengths = trial.check(&case.name, trial.written[result]);
            let moved = learning.into_iter().zip(lengths).filter(|(_, length)| *length > 0.0);
            told.extend(moved.map(|(operand, _)| (case.operation.name(), operand)));
        }
    }
    // At least towards x, weight, bias; weights, basis; rest, weights; projected, edge, gate, LayerNorm's two.
    let wanted = [("Linear", &[0, 1, 2][..]), ("Blend", &[0, 1]), ("Skin", &[0, 1]), ("Attend", &[0, 2, 3, 4, 5])];
    for (name, operands) in wanted {
        operands.iter().for_each(|operand| assert!(told.contains(&(name, *operand)), "{name}: none to {operand}"));
    }
}
