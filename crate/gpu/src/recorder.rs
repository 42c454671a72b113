//! The device that records: every operation of the forward pass becomes one dispatch. Runs once, at load.

use crate::cost::Cost;
use crate::pack::{self, whole};
use crate::recording::{Dispatch, Operand, Room};
use crate::{Error, Gpu, Result};
use bytemuck::Pod;
use ctsn_core::device::{Activation, Device, Space};
use ctsn_core::model::{Layer, Linear, Reference, Sizes, Skin};
use ctsn_core::network::Drawn;
use ctsn_core::pose::{Frame, Rig};
use ctsn_core::topology::Graph;
use ctsn_shaders::{self as shaders, Shader};
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
    failure: Option<Error>,
}

impl<'m> Recorder<'m> {
    pub fn new(gpu: &'m Gpu) -> Self {
        let (slots, indices, packed) = (Vec::new(), Vec::new(), HashMap::new());
        Self { gpu, slots, indices, packed, constants: vec![], rooms: vec![], dispatches: vec![], failure: None }
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

    /// Lays out an intermediate result as rows, padded to `stride` numbers.
    fn output(&mut self, id: Id, columns: usize, stride: usize) -> Operand {
        let rows = self.length(id) / columns;
        let count = self.rooms.len();
        let Slot::Activation { stage, room, .. } = &mut self.slots[id.0] else {
            unreachable!("an operation writes activations only")
        };
        if let Some(room) = *room {
            return Operand::Activation(room);
        }
        *room = Some(count);
        let stage = stage.clone();
        self.allowed(&stage, (rows * stride * 4) as u64);
        self.rooms.push(Room { stage, rows, columns, stride });
        Operand::Activation(count)
    }

    /// [n, 3], not padded: an intermediate result, or a constant of the model.
    fn plain(&mut self, id: Id) -> Operand {
        self.room(id).map_or_else(|| self.pack(("rest", id.0), |this| this.values(id).to_vec()), Operand::Activation)
    }

    /// An intermediate result that an earlier operation wrote.
    fn input(&self, id: Id) -> Operand {
        Operand::Activation(self.room(id).unwrap_or_else(|| unreachable!("an operation reads what was written")))
    }

    /// Records a dispatch over `extent` outputs by x and y; its stage is that of `output`.
    fn dispatch<P: Pod>(
        &mut self,
        shader: &'static Shader,
        params: P,
        operands: &[Operand],
        extent: [usize; 2],
        output: Id,
        flops: usize,
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
        let cost = Cost { flops: flops as f64, bytes: operands.iter().map(bytes).sum() };
        let Slot::Activation { stage, .. } = &self.slots[output.0] else {
            unreachable!("an operation writes activations only")
        };
        let (stage, groups, operands) = (stage.clone(), groups.map(|groups| groups as u32), operands.to_vec());
        self.dispatches.push(Dispatch { shader, stage, params, operands, groups, cost });
    }
}

impl Device for Recorder<'_> {
    type Buffer = Id;
    type Indices = IndexId;

    fn buffer(&mut self, values: &[f32]) -> Id {
        self.slots.push(Slot::Constant(Cow::Owned(values.to_vec())));
        Id(self.slots.len() - 1)
    }

    fn indices(&mut self, indices: &[u32]) -> IndexId {
        self.indices.push(Cow::Owned(indices.to_vec()));
        IndexId(self.indices.len() - 1)
    }

    fn write(&mut self, buffer: &mut Id, values: &[f32]) {
        self.slots[buffer.0] = Slot::Constant(Cow::Owned(values.to_vec()));
    }

    fn body_frame(&mut self, rig: &Rig, joints: &Id, transforms: &mut Id, vector: &mut Id) {
        let count = rig.joints.len();
        let operands = [
            self.output(*joints, 12, 12),
            self.pack(("inverse bind", 0), |_| rig.inverse_bind.as_flattened().to_vec()),
            self.pack(("standard", 0), |_| pack::standard(rig)),
            self.output(*transforms, 12, 12),
            self.output(*vector, 12 * count, 12 * count),
        ];
        let yaw = u32::from(rig.frame == Frame::HipYaw);
        let params = shaders::BodyFrame { joints: count as u32, root: rig.root as u32, yaw };
        self.dispatch(&shaders::BODY_FRAME, params, &operands, [count + 1, 1], *transforms, count * 110);
    }

    fn linear(&mut self, x: &Id, layer: &Linear<Id>, activation: Activation, y: &mut Id) {
        let Linear { weight, bias, inputs, outputs } = *layer;
        let rows = self.length(*y) / outputs;
        let operands = [
            self.input(*x),
            self.pack(("weight", weight.0), |this| pack::rows(this.values(weight), outputs, whole(inputs))),
            self.pack(("bias", bias.0), |this| pack::rows(this.values(bias), outputs, 1)),
            self.output(*y, outputs, whole(outputs)),
        ];
        let [inputs4, outputs4] = [inputs, outputs].map(|numbers| whole(numbers) / 4);
        let params = shaders::Linear {
            rows: rows as u32,
            inputs: inputs4 as u32,
            outputs: outputs4 as u32,
            relu: u32::from(activation == Activation::Relu),
        };
        let shader = if rows == 1 { &shaders::LINEAR_ROW } else { &shaders::LINEAR };
        self.dispatch(shader, params, &operands, [outputs4, rows], *y, 2 * rows * inputs * outputs);
    }

    fn blend(&mut self, weights: &Id, basis: &Id, rest: &Id, residual: &mut Id, template: &mut Id) {
        let numbers = self.length(*residual);
        let count = self.length(*basis) / numbers;
        let shared = self.length(*weights) == count;
        let operands = [
            self.input(*weights),
            self.pack(("basis", basis.0), |this| pack::basis(this.values(*basis), count)),
            self.plain(*rest),
            self.output(*residual, 3, 3),
            self.output(*template, 3, 3),
        ];
        let count4 = (whole(count) / 4) as u32;
        let stride = if shared { 0 } else { count4 };
        let params = shaders::Blend { numbers: numbers as u32, count: count4, stride };
        self.dispatch(&shaders::BLEND, params, &operands, [numbers, 1], *residual, numbers * (2 * count + 1));
    }

    fn skin(&mut self, rest: &Id, skin: &Skin<Id, IndexId>, transforms: &Id, space: Space, positions: &mut Id) {
        let (joints, weights, width) = (skin.joints, skin.weights, skin.width);
        let n = self.length(*positions) / 3;
        let operands = [
            self.plain(*rest),
            self.pack(("skin joints", joints.0), |this| pack::slots(&this.indices[joints.0], width)),
            self.pack(("skin weights", weights.0), |this| pack::slots(this.values(weights), width)),
            self.input(*transforms),
            self.output(*positions, 3, 3),
        ];
        let back = self.length(*transforms) / 4 - 3;
        let world = u32::from(space == Space::World);
        let params = shaders::Skin { vertices: n as u32, width: width as u32, back: back as u32, world };
        self.dispatch(&shaders::SKIN, params, &operands, [n, 1], *positions, n * (24 * width + 42));
    }

    fn features(&mut self, v: &Id, rest: &Id, reference: &Reference<Id, IndexId>, nodes: &mut Id, potentials: &mut Id) {
        let n = self.length(*v) / 3;
        let operands = [self.input(*v), self.plain(*rest), self.output(*nodes, 3, 4), self.output(*potentials, 6, 8)];
        let params = shaders::Features {
            mean: reference.mean,
            edge_scale: reference.edge_scale,
            deviation: reference.std,
            vertices: n as u32,
        };
        self.dispatch(&shaders::FEATURES, params, &operands, [n, 1], *nodes, 12 * n);
    }

    fn attend(
        &mut self,
        graph: &Graph<IndexId>,
        sizes: Sizes,
        projected: &mut Id,
        potentials: &Id,
        layer: &Layer<Id>,
        _attended: &mut Id,
        output: &mut Id,
    ) {
        let Sizes { vertices: n, features, heads, .. } = sizes;
        let Layer { edge, gate, norm_weight, norm_bias, .. } = *layer;
        if features > shaders::MAX_FEATURES {
            self.fail("features of a graph layer".to_owned(), features as u64, shaders::MAX_FEATURES as u64);
        }
        let operands = [
            self.pack(("offsets", graph.offsets.0), |this| this.indices[graph.offsets.0].to_vec()),
            self.pack(("neighbours", graph.neighbours.0), |this| this.indices[graph.neighbours.0].to_vec()),
            self.input(*projected),
            self.input(*potentials),
            self.pack(("layer", edge.0), |this| {
                let [edge, gate, weight, bias] = [edge, gate, norm_weight, norm_bias].map(|id| this.values(id));
                pack::layer(edge, gate, weight, bias)
            }),
            self.output(*output, features, whole(features)),
        ];
        let d = features / heads;
        let lanes = d.next_power_of_two().min((shaders::LANES / heads.min(shaders::LANES)).next_power_of_two());
        let lanes = lanes.min(shaders::LANES);
        let params = shaders::Attend {
            vertices: n as u32,
            features: features as u32,
            stride: whole(features) as u32,
            heads: heads as u32,
            lanes: lanes as u32,
            scale: 1.0 / (d as f32).sqrt(),
        };
        let edges = self.indices[graph.neighbours.0].len();
        let limit = self.gpu.device().limits().max_compute_workgroups_per_dimension as usize;
        let extent = [n.min(limit), n.div_ceil(limit)];
        let flops = edges * features * 28 + n * features * 19;
        self.dispatch(&shaders::ATTEND, params, &operands, extent, *output, flops);
    }

    fn normals(&mut self, positions: &Id, triangles: &[u32], normals: &mut Id) {
        let n = self.length(*positions) / 3;
        let (offsets, corners) = pack::corners(n, triangles);
        let operands = [
            self.input(*positions),
            self.pack(("normal offsets", 0), |_| offsets),
            self.pack(("normal corners", 0), |_| corners),
            self.output(*normals, 3, 3),
        ];
        let params = shaders::Normals { vertices: n as u32 };
        self.dispatch(&shaders::NORMALS, params, &operands, [n, 1], *normals, 18 * triangles.len() + 9 * n);
    }

    fn surface(&mut self, vertex: &[u32], positions: &Id, normals: &Id, drawn: &mut Drawn<Id>) {
        let operands = [
            self.pack(("surface vertex", 0), |_| vertex.to_vec()),
            self.input(*positions),
            self.input(*normals),
            self.output(drawn.positions, 3, 3),
            self.output(drawn.normals, 3, 3),
        ];
        let params = shaders::Surface { drawn: vertex.len() as u32 };
        self.dispatch(&shaders::SURFACE, params, &operands, [vertex.len(), 1], drawn.positions, 0);
    }
}
