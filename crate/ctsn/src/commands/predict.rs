//! `ctsn predict`: poses in, positions and normals out.

use super::{Device, model, one_of};
use anyhow::{Context, Result};
use ctsn_core::cpu::Level;
use ctsn_core::file::{Tensor, Tensors};
use ctsn_core::model::HostModel;
use ctsn_core::{Predictor, Streams};
use ctsn_gpu::Gpu;
use ctsn_rig::file;
use pollster::block_on;
use std::path::PathBuf;

/// Predict cloth for a file of poses
///
/// POSES holds the tensor `pose.joints` [P, J, 3, 4]: row-major world transforms of the model's joints, in metres.
/// OUT receives `positions` and `normals` [P, n, 3], in world space.
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
    /// Streams of the network to run
    #[arg(long, value_parser = one_of(STREAMS), default_value = "both")]
    streams: Streams,
}

const STREAMS: &[(&str, &str, Streams)] = &[
    ("both", "The whole network", Streams::Both),
    ("skeleton", "The skeleton stream alone: the coarse prediction", Streams::Skeleton),
    ("rest", "No stream: the garment at rest, skinned with the learned weights", Streams::Rest),
    ("none", "Plain skinning, with the weights of the nearest body vertices", Streams::None),
];

pub fn run(arguments: &Arguments) -> Result<()> {
    let model = model(&arguments.model)?;
    let (joints, n) = (model.sizes.joints, model.sizes.vertices);
    let poses = file::tensors(&arguments.poses)?;
    let shape = [None, Some(joints), Some(3), Some(4)];
    let (poses, shape) = poses.f32("pose.joints", &shape).with_context(|| arguments.poses.display().to_string())?;
    let poses = poses.chunks_exact(12 * joints);
    let [positions, normals] = match arguments.device {
        Device::Cpu => cpu(model, poses, arguments.streams)?,
        Device::Gpu => gpu(&model, poses, arguments.streams)?,
    };
    let mut out = Tensors::default();
    out.tensors.insert("positions".to_owned(), Tensor::f32(&[shape[0], n, 3], &positions));
    out.tensors.insert("normals".to_owned(), Tensor::f32(&[shape[0], n, 3], &normals));
    file::write(&arguments.output, &out.to_bytes())?;
    println!("{} poses of {n} vertices -> {}", shape[0], arguments.output.display());
    Ok(())
}

/// Positions and normals of every pose.
fn cpu<'a>(model: HostModel, poses: impl Iterator<Item = &'a [f32]>, streams: Streams) -> Result<[Vec<f32>; 2]> {
    let mut predictor = Predictor::from_model(model, Level::new());
    let mut results = [Vec::new(), Vec::new()];
    for pose in poses {
        predictor.predict_row_major(pose, streams)?;
        results[0].extend_from_slice(predictor.positions());
        results[1].extend_from_slice(predictor.normals());
    }
    Ok(results)
}

/// The same by the GPU.
fn gpu<'a>(model: &HostModel, poses: impl Iterator<Item = &'a [f32]>, streams: Streams) -> Result<[Vec<f32>; 2]> {
    let gpu = block_on(Gpu::new())?;
    println!("on {}", gpu.name());
    let mut predictor = block_on(ctsn_gpu::Predictor::new(&block_on(ctsn_gpu::Model::new(&gpu, model))?))?;
    let mut results = [Vec::new(), Vec::new()];
    for pose in poses {
        predictor.predict_row_major(pose, streams)?;
        let prediction = block_on(predictor.read())?;
        results[0].extend(prediction.positions);
        results[1].extend(prediction.normals);
    }
    Ok(results)
}
