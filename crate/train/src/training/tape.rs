//! The tape: a device that keeps the operations of one forward pass, to run them and their gradients on the CPU.
//! Recorded once per model and shared by all lanes: a [`Lane`] holds the values and gradients of one sample.

use super::gradient::{self, Flow, polishing};
use crate::{Error, Result};
use ctsn_core::cpu::{Cpu, Level};
use ctsn_core::device::Device;
use ctsn_core::operation::Operation;

/// A buffer of the tape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Id(usize);

/// Constant indices of the tape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexId(usize);

/// An operation as the tape keeps it.
pub(super) enum Step {
    Operation(Operation<Id, Id, IndexId>),
    /// rest + residual -> total: no operation of the network, but of the baselines it is compared with.
    Add {
        rest: Id,
        residual: Id,
        total: Id,
    },
    /// The steps of the polish at once, for each of them starts from the two before.
    Polish {
        cut: polishing::Recorded,
        from: Id,
        trail: Id,
        polished: Id,
    },
}

/// What is known of a buffer's gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Gradient {
    /// Nothing before it learns: none is wanted.
    Constant,
    /// Something before it learns, and all gradients on the way are known.
    Known,
    /// Between the parts of an operation of this name, which alone may write it.
    Inner(&'static str),
    /// Something before it learns, behind an operation of this name that has no gradient towards it.
    Unknown(&'static str),
}

/// The recorded forward pass.
#[derive(Default)]
pub struct Tape {
    lengths: Vec<usize>,
    initial: Vec<Vec<f32>>,
    indices: Vec<Vec<u32>>,
    steps: Vec<Kept>,
    gradients: Vec<Gradient>,
    sealed: bool,
}

/// A step, what it writes, and the way of its gradient where anything before it learns.
struct Kept {
    step: Step,
    writes: Vec<Id>,
    flow: Option<Flow>,
}

/// Values and gradients of one sample on its way through a [`Tape`], reused from sample to sample.
pub struct Lane {
    pub(super) level: Level,
    pub(super) scratch: gradient::Scratch,
    cpu: Cpu,
    /// Activations; buffers of the model stay empty here, they are shared.
    values: Vec<Vec<f32>>,
    /// Gradients: of parameters by buffer, summed over samples; of activations by slot, for this sample. Empty where
    /// none is wanted.
    gradients: Vec<Vec<f32>>,
    /// Where the gradient of a buffer is.
    slots: Vec<usize>,
    /// What losses stand behind.
    pub(super) losses: Vec<Id>,
}

/// Weights and constants of the model by buffer, shared by all lanes.
pub struct Shared(Vec<Vec<f32>>);

impl Tape {
    /// A new buffer: of the model until [`Self::seal`], an activation afterwards, which holds zeros until an operation
    /// or a sample fills it.
    pub fn buffer(&mut self, values: &[f32]) -> Id {
        self.lengths.push(values.len());
        self.gradients.push(Gradient::Constant);
        if !self.sealed {
            self.initial.push(values.to_vec());
        }
        Id(self.lengths.len() - 1)
    }

    /// New constant indices.
    pub fn indices(&mut self, indices: &[u32]) -> IndexId {
        self.indices.push(indices.to_vec());
        IndexId(self.indices.len() - 1)
    }

    /// Ends the upload of the model: hands over its buffers and marks `parameters` as trainable.
    /// Buffers made afterwards are activations.
    pub fn seal(&mut self, parameters: &[&Id]) -> Shared {
        self.sealed = true;
        parameters.iter().for_each(|id| self.gradients[id.0] = Gradient::Known);
        Shared(std::mem::take(&mut self.initial))
    }

    /// A lane for this tape, with losses behind the buffers `losses`.
    ///
    /// # Errors
    /// A loss behind an operation that has no gradient towards what learns before it: it would teach nothing. A loss on
    /// what an operation reads that learns: but for the polish, a gradient has one source.
    pub fn lane(&self, shared: &Shared, losses: &[Id]) -> Result<Lane> {
        for loss in losses {
            if let Gradient::Unknown(operation) | Gradient::Inner(operation) = self.gradients[loss.0] {
                return Err(Error::Training(format!("a loss behind {operation}, which has no gradient on the tape")));
            }
            if self.steps.iter().filter_map(|kept| kept.flow.as_ref()).any(|flow| !flow.adds && flow.to.contains(loss))
            {
                return Err(Error::Training("a loss on what an operation reads that learns itself".to_owned()));
            }
        }
        let shared = shared.0.len();
        let own = |(i, length): (usize, &usize)| vec![0.0; if i < shared { 0 } else { *length }];
        let (slots, lengths) = self.slots(shared, losses);
        Ok(Lane {
            level: Level::new(),
            scratch: gradient::Scratch::default(),
            cpu: Cpu::new(),
            values: self.lengths.iter().enumerate().map(own).collect(),
            gradients: lengths.into_iter().map(|length| vec![0.0; length]).collect(),
            slots,
            losses: losses.to_vec(),
        })
    }

    /// Slot of every buffer's gradient, and the slots' lengths. On the way back, a gradient is done with after the
    /// operation that made its buffer: its slot serves the next of the same length, so that the cache holds more of
    /// what is worked on.
    fn slots(&self, shared: usize, losses: &[Id]) -> (Vec<usize>, Vec<usize>) {
        let learns = |id: Id| matches!(self.gradients[id.0], Gradient::Known | Gradient::Inner(_));
        let mut slots: Vec<usize> = (0..self.lengths.len()).collect();
        let mut lengths: Vec<usize> =
            self.lengths.iter().enumerate().map(|(i, length)| if learns(Id(i)) { *length } else { 0 }).collect();
        let mut read = vec![false; self.lengths.len()];
        let flows = || self.steps.iter().filter_map(|kept| kept.flow.as_ref());
        flows().for_each(|flow| flow.to.iter().chain(&flow.through).for_each(|id| read[id.0] = true));
        let mut free: Vec<usize> = Vec::new();
        // A loss writes its gradient before the first operation: that slot is never another's.
        let mut placed: Vec<bool> = (0..self.lengths.len()).map(|i| losses.contains(&Id(i))).collect();
        for flow in flows().rev() {
            for id in flow.through.iter().chain(&flow.to).filter(|id| id.0 >= shared && learns(**id)) {
                if std::mem::replace(&mut placed[id.0], true) {
                    continue;
                }
                if let Some(at) = free.iter().position(|slot| lengths[*slot] == self.lengths[id.0]) {
                    lengths[id.0] = 0;
                    slots[id.0] = free.swap_remove(at);
                }
            }
            let done = std::iter::once(&flow.from).chain(&flow.through);
            free.extend(done.filter(|id| read[id.0] && !losses.contains(id)).map(|id| slots[id.0]));
        }
        (slots, lengths)
    }

    /// Runs the recorded operations.
    pub fn forward(&self, shared: &Shared, lane: &mut Lane) {
        for Kept { step, writes, .. } in &self.steps {
            // What is written is lent while the rest can be read.
            let mut lent: Vec<Vec<f32>> = writes.iter().map(|id| std::mem::take(&mut lane.values[id.0])).collect();
            let Lane { cpu, values, .. } = lane;
            let read = |id: Id| shared.0.get(id.0).unwrap_or(&values[id.0]).as_slice();
            match step {
                Step::Operation(operation) => {
                    let mut written = lent.iter_mut().map(Vec::as_mut_slice);
                    let write = |_| written.next().unwrap_or_default();
                    cpu.compute(operation.clone().map(read, write, |id: IndexId| self.indices_of(id)));
                }
                Step::Add { rest, residual, .. } => {
                    let terms = read(*rest).iter().zip(read(*residual));
                    lent[0].iter_mut().zip(terms).for_each(|(total, (rest, by))| *total = rest + by);
                }
                Step::Polish { cut, from, .. } => {
                    let [trail, polished] = &mut lent[..] else { unreachable!("two are written") };
                    polishing::forward(cpu, &cut.of(self, shared), read(*from), trail, polished);
                }
            }
            writes.iter().zip(lent).for_each(|(id, value)| lane.values[id.0] = value);
        }
    }

    /// Runs the gradients backwards, from those already stored in activations. Parameters' gradients are added to.
    pub fn backward(&self, shared: &Shared, lane: &mut Lane) {
        let learning = self.steps.iter().rev().filter(|kept| kept.flow.is_some());
        learning.for_each(|kept| gradient::backward(self, &kept.step, shared, lane));
    }

    pub(super) fn indices_of(&self, id: IndexId) -> &[u32] {
        &self.indices[id.0]
    }

    /// Whether towards this buffer a gradient is wanted.
    pub(super) fn learns(&self, id: Id) -> bool {
        self.gradients[id.0] != Gradient::Constant
    }

    /// rest + residual -> total, of any shape.
    pub fn add(&mut self, rest: &Id, residual: &Id, total: &mut Id) {
        let step = Step::Add { rest: *rest, residual: *residual, total: *total };
        self.keep("add", step, vec![*rest, *residual], vec![*total]);
    }

    /// Keeps a step, and finds the way of its gradient: to every operand that learns, or it is unknown what lies behind
    /// it.
    pub(super) fn keep(&mut self, name: &'static str, step: Step, reads: Vec<Id>, writes: Vec<Id>) {
        // What is written may be read first, too.
        let before: Vec<Id> = reads.iter().chain(&writes).copied().filter(|id| self.learns(*id)).collect();
        let flow = gradient::flow(&step);
        let reaches = |flow: &Flow| before.iter().all(|id| flow.to.contains(id) || flow.ends.contains(id));
        let earlier = before.iter().find_map(|id| match self.gradients[id.0] {
            Gradient::Unknown(operation) | Gradient::Inner(operation) => Some(operation),
            _ => None,
        });
        let unknown = earlier.or((!before.is_empty() && !flow.as_ref().is_some_and(reaches)).then_some(name));
        let flow = flow.filter(|flow| unknown.is_none() && before.iter().any(|id| flow.to.contains(id)));
        for id in writes.iter().filter(|id| !flow.as_ref().is_some_and(|flow| flow.to.contains(id))) {
            self.gradients[id.0] = match (unknown, &flow) {
                (Some(operation), _) => Gradient::Unknown(operation),
                (None, Some(flow)) if flow.from == *id => Gradient::Known,
                (None, Some(flow)) if flow.through == Some(*id) => Gradient::Inner(name),
                (None, Some(_)) => Gradient::Unknown(name),
                (None, None) => Gradient::Constant,
            };
        }
        self.steps.push(Kept { step, writes, flow });
    }
}

impl Device for Tape {
    type Buffer = Id;
    type Indices = IndexId;

    fn run(&mut self, operation: Operation<&Id, &mut Id, &IndexId>) {
        let (mut reads, mut writes) = (Vec::new(), Vec::new());
        let note = |list: &mut Vec<Id>, id: Id| {
            list.push(id);
            id
        };
        let operation = operation.map(|id| note(&mut reads, *id), |id| note(&mut writes, *id), |id| *id);
        self.keep(operation.name(), Step::Operation(operation), reads, writes);
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

    pub(super) fn take_gradient(&mut self, id: Id) -> Vec<f32> {
        std::mem::take(&mut self.gradients[self.slots[id.0]])
    }
}
