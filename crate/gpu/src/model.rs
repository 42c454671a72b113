//! A model on a GPU: its constants, uploaded once, and the recorded frames. Shared by all predictors of the model.

use crate::cost::{Stage, stages};
use crate::recorder::Recorder;
use crate::recording::{Dispatch, Room};
use crate::{Gpu, Result};
use ctsn_core::model::{HostModel, Sizes};
use ctsn_core::network::{Activations, Drawn, predict};
use ctsn_core::pose::Rig;
use ctsn_core::{Confidence, Streams};
use std::cell::RefCell;
use std::mem;
use std::sync::Arc;

/// Streams in the order in which frames are recorded.
const ORDER: [Streams; 3] = [Streams::Both, Streams::Skeleton, Streams::None];

/// Where the frame of `streams` is among those recorded.
pub(crate) fn place(streams: Streams) -> usize {
    ORDER.iter().position(|one| *one == streams).unwrap_or_else(|| unreachable!("every one is recorded"))
}

/// A model on a GPU; clones share it. Dropping the last one, predictors included, frees its memory.
#[derive(Clone)]
pub struct Model(pub(crate) Arc<Inner>);

pub(crate) struct Inner {
    pub gpu: Gpu,
    pub sizes: Sizes,
    pub rig: Arc<Rig>,
    /// What each predictor reckons its poses' confidence with.
    pub trust: Option<Confidence>,
    pub constants: Vec<wgpu::Buffer>,
    pub rooms: Vec<Room>,
    /// Frames, by streams as [`ORDER`] has them.
    pub frames: [Vec<Dispatch>; 3],
    /// Rooms of what is written and read from outside.
    pub joints: usize,
    /// What the residuals of skeleton and mesh stream count; nothing where a model lacks the stream.
    pub shares: [Option<usize>; 2],
    pub positions: usize,
    pub normals: usize,
    /// Positions and normals of what rides on the cloth; the cloth's own where nothing does.
    pub shown: [usize; 2],
    /// Positions and normals of what is drawn: what is shown where the model has no surface.
    pub drawn: [usize; 2],
    /// Rooms of the stages' results, by name: of those that a frame computes.
    pub results: Vec<(String, usize)>,
}

impl Model {
    /// Uploads `model` and records its frames. Compiles every shader it needs.
    ///
    /// # Errors
    /// [`crate::Error::Limit`], [`crate::Error::OutOfMemory`], [`crate::Error::Lost`].
    pub async fn new(gpu: &Gpu, model: &HostModel) -> Result<Self> {
        gpu.scoped(|| record(gpu, model)).await
    }

    /// The device it is on.
    pub fn gpu(&self) -> &Gpu {
        &self.0.gpu
    }

    /// Sizes of the network.
    pub fn sizes(&self) -> Sizes {
        self.0.sizes
    }

    /// Joints, inverse bind transforms and body frame.
    pub fn rig(&self) -> &Rig {
        &self.0.rig
    }

    /// Stages of a frame, in order, with their dispatches and least work.
    pub fn stages(&self, streams: Streams) -> Vec<Stage> {
        stages(self.0.frame(streams)).0
    }
}

fn record(gpu: &Gpu, model: &HostModel) -> Result<Model> {
    let recorder = RefCell::new(Recorder::new(gpu));
    let recorded =
        model.map(|values| recorder.borrow_mut().constant(values), |indices| recorder.borrow_mut().index(indices));
    let mut recorder = recorder.into_inner();
    // A room is a stage's own: by it the stage's dispatches are known.
    let mut a = Activations::keeping(model, |stage, length| recorder.activation(stage, length));
    let mut one = |streams| {
        predict(&mut recorder, &recorded, streams, &mut a);
        recorder.take()
    };
    let frames = [one(ORDER[0])?, one(ORDER[1])?, one(ORDER[2])?];
    for dispatch in frames.iter().flatten() {
        gpu.pipeline(dispatch.shader, dispatch.room);
    }
    let room = |id| recorder.room(id).unwrap_or_else(|| unreachable!("every frame writes it"));
    let (joints, shares) = (room(a.joints), [a.skeleton_share, a.mesh_share].map(|id| recorder.room(id)));
    let (positions, normals) = (room(a.positions), room(a.normals));
    let own = |drawn: &Drawn<_>| [room(drawn.positions), room(drawn.normals)];
    let shown = a.riders.as_ref().map_or([positions, normals], own);
    let drawn = a.drawn.as_ref().map_or(shown, own);
    let results = a.stages().into_iter().filter_map(|(name, id)| Some((name, recorder.room(*id)?))).collect();
    let (constants, rooms) = (mem::take(&mut recorder.constants), mem::take(&mut recorder.rooms));
    let (gpu, sizes, rig, trust) = (gpu.clone(), model.sizes, Arc::clone(&model.rig), Confidence::new(model));
    Ok(Model(Arc::new(Inner {
        gpu,
        sizes,
        rig,
        trust,
        constants,
        rooms,
        frames,
        joints,
        shares,
        positions,
        normals,
        shown,
        drawn,
        results,
    })))
}

impl Inner {
    pub fn frame(&self, streams: Streams) -> &[Dispatch] {
        &self.frames[place(streams)]
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        // In a browser dropping alone frees nothing.
        self.constants.iter().for_each(wgpu::Buffer::destroy);
        self.frames.iter().flatten().for_each(|dispatch| dispatch.params.destroy());
    }
}
