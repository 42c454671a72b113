//! `ctsn predict`: poses in, positions and normals out.

use super::{Device, model, one_of};
use anyhow::{Context, Result};
use ctsn_core::cpu::{Level, Threads};
use ctsn_core::file::{Tensor, Tensors};
use ctsn_core::model::HostModel;
use ctsn_core::{Predictor, Streams};
use ctsn_gpu::Gpu;
use ctsn_rig::file;
use ctsn_rig::statistics::Sorted;
use pollster::block_on;
use std::path::PathBuf;
use std::time::Instant;

/// Predict cloth for a file of poses
///
/// POSES holds the tensor `pose.joints` [P, J, 3, 4]: row-major world transforms of the model's joints, in metres.
/// OUT receives `positions` and `normals` [P, n, 3], in world space: of the cloth, or of the mesh that rides on it where
/// the model has one. The times that are told are those of whole
/// predictions; the first one's has the reading of the model in it.
#[derive(clap::Args)]
pub struct Arguments {
    /// Model file (safetensors)
    model: PathBuf,
    /// Poses (safetensors)
    poses: PathBuf,
    /// Where to write the prediction (safetensors)
    #[arg(short, long)]
    output: PathBuf,
    /// Device that computes
    #[arg(long, value_enum, default_value = "cpu")]
    device: Device,
    /// Threads that compute on the CPU
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    threads: u16,
    /// Streams of the network to run
    #[arg(long, value_parser = one_of(STREAMS), default_value = "both")]
    streams: Streams,
}

const STREAMS: &[(&str, &str, Streams)] = &[
    ("both", "The whole network", Streams::Both),
    ("skeleton", "The skeleton stream alone: the coarse prediction", Streams::Skeleton),
    ("none", "Plain skinning", Streams::None),
];

/// Predictions, and when each was done.
struct Predicted {
    positions: Vec<f32>,
    normals: Vec<f32>,
    done: Vec<Instant>,
}

impl Predicted {
    fn new() -> Self {
        Self { positions: Vec::new(), normals: Vec::new(), done: Vec::new() }
    }

    fn push(&mut self, positions: &[f32], normals: &[f32]) {
        self.done.push(Instant::now());
        self.positions.extend_from_slice(positions);
        self.normals.extend_from_slice(normals);
    }
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let start = Instant::now();
    let model = model(&arguments.model)?;
    let n = model.ride.as_ref().map_or(model.sizes.vertices, |ride| ride.corners.len() / 3);
    let joints = model.sizes.joints;
    let poses = file::tensors(&arguments.poses)?;
    let shape = [None, Some(joints), Some(3), Some(4)];
    let (poses, shape) = poses.f32("pose.joints", &shape).with_context(|| arguments.poses.display().to_string())?;
    let poses = poses.chunks_exact(12 * joints);
    let predicted = match arguments.device {
        Device::Cpu => cpu(model, poses, arguments)?,
        Device::Gpu => gpu(&model, poses, arguments.streams)?,
    };
    let mut out = Tensors::default();
    out.tensors.insert("positions".to_owned(), Tensor::f32(&[shape[0], n, 3], &predicted.positions));
    out.tensors.insert("normals".to_owned(), Tensor::f32(&[shape[0], n, 3], &predicted.normals));
    file::write(&arguments.output, &out.to_bytes())?;
    println!("{} poses of {n} vertices -> {}", shape[0], arguments.output.display());
    tell_times(start, &predicted.done);
    Ok(())
}

/// Milliseconds from `start` to the first prediction, and between one and the next.
fn tell_times(start: Instant, done: &[Instant]) {
    let milliseconds = |from: &Instant, to: &Instant| to.duration_since(*from).as_secs_f64() * 1e3;
    let Some(first) = done.first() else { return };
    print!("first prediction after {:.2} ms", milliseconds(&start, first));
    if done.len() > 1 {
        let laps = done.windows(2).map(|pair| milliseconds(&pair[0], &pair[1]));
        print!(", then {:.2} ms each (median of {})", Sorted::new(laps).median(), done.len() - 1);
    }
    println!();
}

/// Positions and normals of every pose.
fn cpu<'a>(model: HostModel, poses: impl Iterator<Item = &'a [f32]>, arguments: &Arguments) -> Result<Predicted> {
    let threads = Threads::new(arguments.threads.into())?;
    let mut predictor = Predictor::on_threads(model, Level::new(), threads);
    let mut predicted = Predicted::new();
    for pose in poses {
        predictor.predict_row_major(pose, arguments.streams)?;
        predicted.push(predictor.shown_positions(), predictor.shown_normals());
    }
    Ok(predicted)
}

/// The same by the GPU.
fn gpu<'a>(model: &HostModel, poses: impl Iterator<Item = &'a [f32]>, streams: Streams) -> Result<Predicted> {
    let gpu = block_on(Gpu::new())?;
    println!("on {}", gpu.name());
    let mut predictor = block_on(ctsn_gpu::Predictor::new(&block_on(ctsn_gpu::Model::new(&gpu, model))?))?;
    let mut predicted = Predicted::new();
    for pose in poses {
        predictor.predict_row_major(pose, streams)?;
        let prediction = block_on(predictor.read_shown())?;
        predicted.push(&prediction.positions, &prediction.normals);
    }
    Ok(predicted)
}
