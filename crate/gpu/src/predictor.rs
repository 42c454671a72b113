//! A model ready to predict on a GPU: one command buffer per frame, the pose its only upload, read-back on request.

use crate::model::{Model, place};
use crate::read::Reader;
use crate::recording::{Dispatch, Operand, Room};
use crate::{Error, Gpu, Result};
use ctsn_core::{Confidence, Streams};
use wgpu::BufferUsages as Usage;

/// One cloth: a [`Model`] with the intermediate results of its own. Dropping it frees them.
pub struct Predictor {
    pub(crate) model: Model,
    pose: Vec<f32>,
    trust: Option<Confidence>,
    confidence: f32,
    pub(crate) buffers: Vec<wgpu::Buffer>,
    /// Frames, by streams as the model records them.
    frames: [Vec<Step>; 3],
    pub(crate) reader: Reader,
}

/// A dispatch with its resources.
pub(crate) struct Step {
    pipeline: wgpu::ComputePipeline,
    bindings: wgpu::BindGroup,
    groups: [u32; 2],
}

/// A prediction read back: of the cloth's n vertices, of the w that are shown, or of the d drawn ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// Positions, three numbers each, world, metres.
    pub positions: Vec<f32>,
    /// Unit vertex normals, three numbers each.
    pub normals: Vec<f32>,
}

impl Predictor {
    /// Room for one cloth of `model`, warmed up: the first frame costs what any other does.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Lost`].
    pub async fn new(model: &Model) -> Result<Self> {
        let gpu = model.gpu();
        let mut predictor = gpu.scoped(|| Ok(Self::make(model))).await?;
        let rest: Vec<f32> = model.rig().joints.iter().flat_map(|_| IDENTITY).collect();
        predictor.predict_row_major(&rest, Streams::Both)?;
        match predictor.read().await {
            // A model may well overflow in a pose of our making.
            Ok(_) | Err(Error::Core(_)) => Ok(predictor),
            Err(error) => Err(error),
        }
    }

    fn make(model: &Model) -> Self {
        let (gpu, inner) = (model.gpu(), &model.0);
        let own = [inner.positions, inner.normals];
        let shown = |room| [own, inner.shown, inner.drawn].as_flattened().contains(&room);
        let buffers = buffers(gpu, &inner.rooms, shown);
        let step = |dispatch: &Dispatch| Step::new(gpu, dispatch, &inner.constants, &buffers);
        let frames = [0, 1, 2].map(|streams| inner.frames[streams].iter().map(step).collect());
        let pose = vec![0.0; 12 * inner.sizes.joints];
        Self {
            model: model.clone(),
            pose,
            trust: inner.trust.clone(),
            confidence: 1.0,
            buffers,
            frames,
            reader: Reader::default(),
        }
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Joint world matrices [J, 16], column-major as in three.js, metres: submits the frame and returns at once.
    ///
    /// # Errors
    /// A pose that is none; [`Error::Lost`].
    pub fn predict(&mut self, joints: &[f32], streams: Streams) -> Result<()> {
        self.predict_faded(joints, streams, 1.0)
    }

    /// The same with a share `mesh` of the mesh stream's residual, 0 to 1; towards plain skinning nothing is blended.
    ///
    /// # Errors
    /// A pose that is none; [`Error::Lost`].
    pub fn predict_faded(&mut self, joints: &[f32], streams: Streams, mesh: f32) -> Result<()> {
        self.model.rig().read_column_major(joints, &mut self.pose)?;
        self.submit(streams, mesh)
    }

    /// Joint world transforms [J, 3, 4], row-major, metres: submits the frame and returns at once.
    ///
    /// # Errors
    /// A pose that is none; [`Error::Lost`].
    pub fn predict_row_major(&mut self, joints: &[f32], streams: Streams) -> Result<()> {
        self.model.rig().read(joints, &mut self.pose)?;
        self.submit(streams, 1.0)
    }

    fn submit(&mut self, streams: Streams, mesh: f32) -> Result<()> {
        let gpu = self.model.gpu();
        gpu.check()?;
        self.confidence = self.trust.as_mut().map_or(1.0, |trust| trust.of(self.model.rig(), &self.pose));
        self.write_pose(mesh);
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        self.steps(streams).iter().for_each(|step| step.encode(&mut pass));
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
        gpu.check()
    }

    pub(crate) fn write_pose(&self, mesh: f32) {
        let (inner, queue) = (&self.model.0, self.model.gpu().queue());
        queue.write_buffer(&self.buffers[inner.joints], 0, bytemuck::cast_slice(&self.pose));
        for (room, share) in inner.shares.iter().zip([1.0, mesh]) {
            let share = self.confidence * share;
            room.iter().for_each(|room| queue.write_buffer(&self.buffers[*room], 0, bytemuck::bytes_of(&share)));
        }
    }

    pub(crate) fn steps(&self, streams: Streams) -> &[Step] {
        &self.frames[place(streams)]
    }

    /// What the residuals were worth in the last pose, 0 to 1, as [`ctsn_core::Predictor::confidence`].
    pub fn confidence(&self) -> f32 {
        self.confidence
    }

    /// Predicted positions [n, 3], world, metres, not padded: fit to be a vertex or storage buffer of the page.
    pub fn positions(&self) -> &wgpu::Buffer {
        &self.buffers[self.model.0.positions]
    }

    /// Unit vertex normals [n, 3], as [`Self::positions`].
    pub fn normals(&self) -> &wgpu::Buffer {
        &self.buffers[self.model.0.normals]
    }

    /// Positions of the mesh that is drawn, one vertex per place [w, 3], not padded: of what rides on the cloth where
    /// the model has that, of the cloth otherwise.
    pub fn shown_positions(&self) -> &wgpu::Buffer {
        &self.buffers[self.model.0.shown[0]]
    }

    /// Its unit normals [w, 3].
    pub fn shown_normals(&self) -> &wgpu::Buffer {
        &self.buffers[self.model.0.shown[1]]
    }

    /// Positions of the drawn vertices [d, 3], not padded: of the surface where the model has one, of the shown mesh
    /// otherwise.
    pub fn drawn_positions(&self) -> &wgpu::Buffer {
        &self.buffers[self.model.0.drawn[0]]
    }

    /// Unit normals of the drawn vertices [d, 3].
    pub fn drawn_normals(&self) -> &wgpu::Buffer {
        &self.buffers[self.model.0.drawn[1]]
    }

    /// Reads back the last prediction submitted before this call. The future borrows nothing: further frames may
    /// follow, and further reads. Natively it waits for the GPU when first polled.
    ///
    /// # Errors
    /// [`Error::Lost`]; a prediction that is not finite.
    pub fn read(&self) -> impl Future<Output = Result<Prediction>> + use<> {
        self.read_both([self.positions(), self.normals()])
    }

    /// As [`Self::read`], of the mesh that is drawn [w, 3].
    ///
    /// # Errors
    /// [`Error::Lost`]; a prediction that is not finite.
    pub fn read_shown(&self) -> impl Future<Output = Result<Prediction>> + use<> {
        self.read_both([self.shown_positions(), self.shown_normals()])
    }

    /// As [`Self::read`], of the drawn vertices [d, 3].
    ///
    /// # Errors
    /// [`Error::Lost`]; a prediction that is not finite.
    pub fn read_drawn(&self) -> impl Future<Output = Result<Prediction>> + use<> {
        self.read_both([self.drawn_positions(), self.drawn_normals()])
    }

    fn read_both(&self, buffers: [&wgpu::Buffer; 2]) -> impl Future<Output = Result<Prediction>> + use<> {
        let read = self.reader.read::<f32>(self.model.gpu(), &buffers);
        async move {
            let mut results = read.await?;
            let normals = results.pop().unwrap_or_default();
            let positions = results.pop().unwrap_or_default();
            match positions.iter().position(|value| !value.is_finite()) {
                Some(element) => {
                    let (what, found) = ("positions".to_owned(), positions[element]);
                    Err(Error::Core(ctsn_core::Error::NotFinite { what, element, found }))
                }
                None => Ok(Prediction { positions, normals }),
            }
        }
    }

    /// Reads back what every stage handed on in the last prediction, under the stages' names: for tests.
    ///
    /// # Errors
    /// [`Error::Lost`].
    pub fn stages(&self) -> impl Future<Output = Result<Vec<(String, Vec<f32>)>>> + use<> {
        let inner = self.model.0.clone();
        let buffers: Vec<&wgpu::Buffer> = inner.results.iter().map(|(_, room)| &self.buffers[*room]).collect();
        let read = self.reader.read(self.model.gpu(), &buffers);
        async move {
            let unpad = |((name, room), values): (&(String, usize), Vec<f32>)| {
                (name.clone(), inner.rooms[*room].unpad(&values))
            };
            Ok(inner.results.iter().zip(read.await?).map(unpad).collect())
        }
    }
}

impl Step {
    pub fn new(gpu: &Gpu, dispatch: &Dispatch, constants: &[wgpu::Buffer], activations: &[wgpu::Buffer]) -> Self {
        let pipeline = gpu.pipeline(dispatch.shader, dispatch.room);
        let operand = |operand: &Operand| match operand {
            Operand::Constant(constant) => &constants[*constant],
            Operand::Activation(room) => &activations[*room],
        };
        let buffers = std::iter::once(&dispatch.params).chain(dispatch.operands.iter().map(operand));
        let resources = buffers.map(wgpu::Buffer::as_entire_binding);
        let entries: Vec<_> =
            (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        let bindings = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(&dispatch.stage),
            layout: &pipeline.layout,
            entries: &entries,
        });
        Self { pipeline: pipeline.pipeline, bindings, groups: dispatch.groups }
    }

    pub(crate) fn encode(&self, pass: &mut wgpu::ComputePass) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.dispatch_workgroups(self.groups[0], self.groups[1], 1);
    }
}

/// A buffer for each intermediate result; those that are `shown` may be drawn from.
pub(crate) fn buffers(gpu: &Gpu, rooms: &[Room], shown: impl Fn(usize) -> bool) -> Vec<wgpu::Buffer> {
    let buffer = |(i, room): (usize, &Room)| {
        let shown = if shown(i) { Usage::VERTEX } else { Usage::empty() };
        gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some(&room.stage),
            size: (room.rows * room.stride * 4) as u64,
            usage: Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST | shown,
            mapped_at_creation: false,
        })
    };
    rooms.iter().enumerate().map(buffer).collect()
}

/// A joint that stands at the origin.
const IDENTITY: [f32; 12] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];

impl Drop for Predictor {
    fn drop(&mut self) {
        // In a browser dropping alone frees nothing.
        self.buffers.iter().for_each(wgpu::Buffer::destroy);
    }
}
