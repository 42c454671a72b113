//! The device that records: every operation of the forward pass becomes one dispatch. Runs once, at load.

mod network;
mod repair;

use crate::cost::Cost;
use crate::pack;
use crate::recording::{Dispatch, Operand, Room};
use crate::{Error, Gpu, Result};
use bytemuck::Pod;
use ctsn_core::device::Device;
use ctsn_core::each;
use ctsn_core::operation::Operation;
use ctsn_shaders::Shader;
use std::borrow::Cow;
use std::collections::HashMap;

/// A buffer of the recorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Id(usize);

/// Constant indices of the recorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct IndexId(usize);

/// What is known of a buffer.
enum Slot<'m> {
    Constant(Cow<'m, [f32]>),
    Activation { stage: String, length: usize, room: Option<usize> },
}

/// What tells constants apart: how they are packed, and from which arrays.
type Key = (&'static str, usize);

/// The recorder. What goes wrong is kept for [`Recorder::take`]: operations return nothing.
pub(crate) struct Recorder<'m> {
    gpu: &'m Gpu,
    slots: Vec<Slot<'m>>,
    indices: Vec<Cow<'m, [u32]>>,
    packed: HashMap<Key, usize>,
    pub constants: Vec<wgpu::Buffer>,
    pub rooms: Vec<Room>,
    dispatches: Vec<Dispatch>,
    /// Arithmetic of the operation that is being recorded.
    flops: usize,
    failure: Option<Error>,
}

/// An operation as the recorder notes it.
trait Record {
    fn record(self, recorder: &mut Recorder);
}

impl Device for Recorder<'_> {
    type Buffer = Id;
    type Indices = IndexId;

    fn run(&mut self, operation: Operation<&Id, &mut Id, &IndexId>) {
        let operation = operation.map(|id| *id, |id| *id, |id| *id);
        let lengths = operation.clone().map(|id| self.length(id), |id| self.length(id), |id| self.indices(id).len());
        self.flops = lengths.flops();
        each!(operation, operation => operation.record(self));
    }
}

impl Drop for Recorder<'_> {
    /// What no model took: in a browser dropping alone frees nothing.
    fn drop(&mut self) {
        self.constants.iter().for_each(wgpu::Buffer::destroy);
        self.dispatches.iter().for_each(|dispatch| dispatch.params.destroy());
    }
}

impl<'m> Recorder<'m> {
    pub fn new(gpu: &'m Gpu) -> Self {
        let (slots, indices, packed) = (Vec::new(), Vec::new(), HashMap::new());
        Self {
            gpu,
            slots,
            indices,
            packed,
            constants: vec![],
            rooms: vec![],
            dispatches: vec![],
            flops: 0,
            failure: None,
        }
    }

    /// A constant of the model, borrowed until the recording ends.
    pub fn constant(&mut self, values: &'m [f32]) -> Id {
        self.slots.push(Slot::Constant(Cow::Borrowed(values)));
        Id(self.slots.len() - 1)
    }

    /// Constant indices of the model.
    pub fn index(&mut self, indices: &'m [u32]) -> IndexId {
        self.indices.push(Cow::Borrowed(indices));
        IndexId(self.indices.len() - 1)
    }

    /// An intermediate result of `stage`; the operation that writes it lays it out.
    pub fn activation(&mut self, stage: &str, length: usize) -> Id {
        self.slots.push(Slot::Activation { stage: stage.to_owned(), length, room: None });
        Id(self.slots.len() - 1)
    }

    /// Room of an intermediate result, where any operation wrote it.
    pub fn room(&self, id: Id) -> Option<usize> {
        match &self.slots[id.0] {
            Slot::Activation { room, .. } => *room,
            Slot::Constant(_) => None,
        }
    }

    /// Ends a recording: what was recorded since the last one, or what went wrong.
    pub fn take(&mut self) -> Result<Vec<Dispatch>> {
        match self.failure.take() {
            Some(failure) => Err(failure),
            None => Ok(std::mem::take(&mut self.dispatches)),
        }
    }

    fn values(&self, id: Id) -> &[f32] {
        match &self.slots[id.0] {
            Slot::Constant(values) => values,
            Slot::Activation { .. } => &[],
        }
    }

    /// Constant indices.
    fn indices(&self, id: IndexId) -> &[u32] {
        &self.indices[id.0]
    }

    fn length(&self, id: Id) -> usize {
        match &self.slots[id.0] {
            Slot::Constant(values) => values.len(),
            Slot::Activation { length, .. } => *length,
        }
    }

    /// A constant as `pack` lays it out, uploaded once per key.
    fn pack<T: Pod>(&mut self, key: Key, pack: impl FnOnce(&Self) -> Vec<T>) -> Operand {
        if let Some(found) = self.packed.get(&key) {
            return Operand::Constant(*found);
        }
        let values = pack(self);
        let buffer = self.store(key.0, bytemuck::cast_slice(&values), wgpu::BufferUsages::STORAGE);
        self.constants.push(buffer);
        self.packed.insert(key, self.constants.len() - 1);
        Operand::Constant(self.constants.len() - 1)
    }

    /// A buffer that holds `bytes`; an empty one is 16 bytes long, since none may have none.
    fn store(&mut self, what: &'static str, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let size = self.allowed(what, bytes.len().next_multiple_of(16).max(16) as u64);
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        let descriptor = wgpu::BufferDescriptor { label: Some(what), size, usage, mapped_at_creation: false };
        let buffer = self.gpu.device().create_buffer(&descriptor);
        if size >= bytes.len() as u64 {
            self.gpu.queue().write_buffer(&buffer, 0, bytes);
        }
        buffer
    }

    /// `size` where the device allows it; 16 otherwise, and a failure.
    fn allowed(&mut self, what: &str, size: u64) -> u64 {
        let limits = self.gpu.device().limits();
        let allowed = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
        if size <= allowed {
            return size;
        }
        self.fail(format!("bytes of {what}"), size, allowed);
        16
    }

    fn fail(&mut self, what: String, wanted: u64, allowed: u64) {
        self.failure.get_or_insert(Error::Limit { what, wanted, allowed });
    }

    /// An operand as rows of `columns` numbers, `stride` numbers apart: a constant, or an intermediate result, which
    /// all operations that name it lay out alike.
    fn rows(&mut self, id: Id, columns: usize, stride: usize) -> Operand {
        let rows = self.length(id) / columns;
        let count = self.rooms.len();
        let Slot::Activation { stage, room, .. } = &mut self.slots[id.0] else {
            return self.pack(("rows", id.0), |it| pack::strided(it.values(id), columns, stride));
        };
        if let Some(room) = *room {
            debug_assert_eq!((self.rooms[room].columns, self.rooms[room].stride), (columns, stride), "{stage}");
            return Operand::Activation(room);
        }
        *room = Some(count);
        let stage = stage.clone();
        self.allowed(&stage, (rows * stride * 4) as u64);
        self.rooms.push(Room { stage, rows, columns, stride });
        Operand::Activation(count)
    }

    /// Constant indices as they are.
    fn indexed(&mut self, id: IndexId) -> Operand {
        self.pack(("indices", id.0), |it| it.indices(id).to_vec())
    }

    /// Workgroup memory for so many features in the last dispatch.
    fn give_room(&mut self, features: usize) {
        if let Some(dispatch) = self.dispatches.last_mut() {
            dispatch.room = Some(features as u32);
        }
    }

    /// Records a dispatch over `extent` outputs by x and y; its stage is that of the activation `of`.
    fn dispatch<P: Pod>(
        &mut self,
        shader: &'static Shader,
        params: P,
        operands: &[Operand],
        extent: [usize; 2],
        of: Id,
    ) {
        let limit = u64::from(self.gpu.device().limits().max_compute_workgroups_per_dimension);
        let groups = [0, 1].map(|axis| (extent[axis] as u64).div_ceil(u64::from(shader.tile[axis])));
        if let Some(wanted) = groups.into_iter().find(|groups| *groups > limit) {
            self.fail(format!("workgroups of {}", shader.name), wanted, limit);
        }
        let params = self.store("params", bytemuck::bytes_of(&params), wgpu::BufferUsages::UNIFORM);
        let bytes = |operand: &Operand| match operand {
            Operand::Constant(constant) => self.constants[*constant].size() as f64,
            Operand::Activation(room) => (self.rooms[*room].rows * self.rooms[*room].stride * 4) as f64,
        };
        let cost = Cost { flops: self.flops as f64, bytes: operands.iter().map(bytes).sum() };
        let stage = match &self.slots[of.0] {
            Slot::Activation { stage, .. } => stage.clone(),
            Slot::Constant(_) => String::new(),
        };
        let (groups, operands) = (groups.map(|groups| groups as u32), operands.to_vec());
        self.dispatches.push(Dispatch { shader, stage, params, room: None, operands, groups, cost });
    }
}
