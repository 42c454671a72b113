//! `ctsn bench`: milliseconds per prediction and per training step on this machine.

mod gpu;

use super::{Device, Network};
use anyhow::Result;
use ctsn_author::dataset::{Sample, Setup};
use ctsn_author::synthetic;
use ctsn_author::train::{Settings, Trainer};
use ctsn_core::cpu::Level;
use ctsn_core::model::{HostModel, Storage};
use ctsn_core::{Predictor, Streams};
use std::path::PathBuf;
use std::time::Instant;

/// Time predictions and training steps of a model of given size with random weights
#[derive(clap::Args)]
pub struct Arguments {
    /// Cloth vertices, about
    #[arg(long, default_value_t = 5000)]
    vertices: usize,
    /// Joints
    #[arg(long, default_value_t = 65)]
    joints: usize,
    #[command(flatten)]
    network: Network,
    /// What computes
    #[arg(long, value_enum, default_value = "cpu")]
    device: Device,
    /// Predictions timed
    #[arg(long, default_value_t = 200)]
    runs: usize,
    /// Only write the model to this file, for a benchmark elsewhere
    #[arg(long)]
    write_model: Option<PathBuf>,
    /// Time training steps as well
    #[arg(long)]
    train: bool,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let Arguments { vertices, joints, runs, .. } = *arguments;
    let architecture = arguments.network.architecture();
    let (setup, samples) = synthetic::dataset(vertices, joints, 16);
    let samples: Vec<_> = samples.iter().collect();
    let mut model = ctsn_author::train::initial(&setup, &samples, architecture, 1)?;
    model.body = Some(ctsn_author::body::body(&setup, &samples)?);
    if let Some(path) = &arguments.write_model {
        return Ok(ctsn_author::dataset::write(path, &model.to_bytes(Storage::F32))?);
    }
    println!("n = {}, J = {joints}, {architecture:?}", model.sizes.vertices);
    let poses: Vec<&[f32]> = samples.iter().map(|sample| sample.joints.as_slice()).collect();
    match arguments.device {
        Device::Cpu => cpu(&model, &poses, runs.max(1))?,
        Device::Gpu => gpu::run(&model, &poses, runs.max(1))?,
    }
    if arguments.train {
        train(model, &setup, &samples)?;
    }
    Ok(())
}

/// Predictions on the CPU.
fn cpu(model: &HostModel, poses: &[&[f32]], runs: usize) -> Result<()> {
    let bare = HostModel { body: None, ..model.clone() };
    let triangles = model.body.as_ref().map_or(0, |body| body.triangles.len() / 3);
    println!("with repair of penetration against a body of {triangles} triangles, and without");
    let baseline = Level::baseline();
    for (name, level, model) in
        [("SIMD", Level::new(), model), ("SIMD without", Level::new(), &bare), ("baseline", baseline, model)]
    {
        let mut predictor = Predictor::from_model(model.clone(), level);
        let mut times: Vec<f64> = Vec::new();
        for run in 0..runs {
            let start = Instant::now();
            predictor.predict_row_major(poses[run % poses.len()], Streams::Both)?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        println!(
            "{name:<13} {:.2} ms a prediction (median of {}, least {:.2})",
            median(&mut times),
            times.len(),
            times[0]
        );
    }
    Ok(())
}

/// Training steps.
fn train(model: HostModel, setup: &Setup, samples: &[&Sample]) -> Result<()> {
    let settings = Settings { epochs: 10, ..Settings::default() };
    let mut trainer = Trainer::new(model, setup, samples, settings)?;
    let (mut times, mut last) = (Vec::new(), Instant::now());
    while trainer.epoch < settings.epochs {
        trainer.epoch(|_, _, _| {
            times.push(last.elapsed().as_secs_f64() * 1e3);
            last = Instant::now();
        })?;
    }
    println!("training  {:.1} ms a step of {} poses (median of {})", median(&mut times), settings.batch, times.len());
    Ok(())
}

/// Sorts the times; the median.
fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
