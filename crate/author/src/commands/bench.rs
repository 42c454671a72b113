//! `ctsn bench`: milliseconds per prediction and per training step on this machine.

mod gpu;

use super::{Device, Network};
use anyhow::{Result, ensure};
use ctsn_author::dataset::{Dataset, Sample, Setup};
use ctsn_author::synthetic;
use ctsn_author::train::{Settings, Trainer};
use ctsn_core::cpu::{Level, skin::skin};
use ctsn_core::device::Space;
use ctsn_core::model::{HostModel, Sizes, Skin, Storage};
use ctsn_core::pose::BodyFrame;
use ctsn_core::{Predictor, Streams};
use std::path::PathBuf;
use std::time::Instant;

/// Time predictions and training steps, of a trained model or of one of given size with random weights
#[derive(clap::Args)]
pub struct Arguments {
    /// Model file to time, with DATA; without one, a model of made-up cloth
    #[arg(requires = "data", conflicts_with_all = ["vertices", "joints", "write_model", "embedding", "basis", "layers", "heads", "features"])]
    model: Option<PathBuf>,
    /// Dataset folder the model was trained on, for poses
    data: Option<PathBuf>,
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
    let (model, setup, samples) = match (&arguments.model, &arguments.data) {
        (Some(path), Some(data)) => {
            let Dataset { setup, samples, .. } = Dataset::read(data)?;
            ensure!(!samples.is_empty(), "{}: wanted poses to predict, found none that was kept", data.display());
            (super::model(path)?, setup, samples)
        }
        _ => made_up(arguments)?,
    };
    if let Some(path) = &arguments.write_model {
        return Ok(ctsn_author::dataset::write(path, &model.to_bytes(Storage::F32))?);
    }
    let Sizes { vertices, joints, embedding, basis, features, .. } = model.sizes;
    let layers = model.layers.len();
    println!("n = {vertices}, J = {joints}, m = {embedding}, k = {basis}, L = {layers}, F = {features}");
    let poses: Vec<&[f32]> = samples.iter().map(|sample| sample.joints.as_slice()).collect();
    let runs = arguments.runs.max(1);
    match arguments.device {
        Device::Cpu => cpu(&model, &poses, runs)?,
        Device::Gpu => gpu::run(&model, &poses, runs)?,
    }
    if arguments.train {
        train(model, &setup, &samples.iter().collect::<Vec<_>>())?;
    }
    Ok(())
}

/// A model of made-up cloth, and what it wears it on.
fn made_up(arguments: &Arguments) -> Result<(HostModel, Setup, Vec<Sample>)> {
    let (setup, samples) = synthetic::dataset(arguments.vertices, arguments.joints, 16);
    let all: Vec<_> = samples.iter().collect();
    let mut model = ctsn_author::train::initial(&setup, &all, arguments.network.architecture(), 1)?;
    // Where the cloth is predicted is where the repair must look for the body.
    let worn = samples.iter().map(|sample| worn(&model, sample)).collect::<Result<Vec<_>>>()?;
    model.body = Some(ctsn_author::body::body(&setup, &worn.iter().collect::<Vec<_>>())?);
    Ok((model, setup, samples))
}

/// A sample with plainly skinned cloth for its truth: that is about what an untrained network predicts.
fn worn(model: &HostModel, sample: &Sample) -> Result<Sample> {
    let mut frame = BodyFrame::new(model.sizes.joints);
    model.rig.body_frame(&sample.joints, &mut frame)?;
    let Skin { joints, weights, .. } = &model.skin;
    let mut truth = vec![0.0; model.rest.len()];
    skin(Level::new(), &model.rest, joints, weights, &frame.transforms, Space::Body, &mut truth);
    Ok(Sample { truth, ..sample.clone() })
}

/// Predictions on the CPU.
fn cpu(model: &HostModel, poses: &[&[f32]], runs: usize) -> Result<()> {
    let bare = HostModel { body: None, ..model.clone() };
    let triangles = model.body.as_ref().map_or(0, |body| body.triangles.len() / 3);
    println!("with repair of penetration against a body of {triangles} triangles, and without");
    let (simd, baseline) = (Level::new(), Level::baseline());
    let mut predictors = [(simd, model), (simd, &bare), (baseline, model), (baseline, &bare)]
        .map(|(level, model)| Predictor::from_model(model.clone(), level));
    // In turn, so that what else the machine does falls on all of them alike.
    let mut times = [const { Vec::new() }; 4];
    for run in 0..runs {
        for (predictor, times) in predictors.iter_mut().zip(&mut times) {
            let start = Instant::now();
            predictor.predict_row_major(poses[run % poses.len()], Streams::Both)?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
    }
    let pushed = predictors[0]
        .activations()
        .collision
        .as_ref()
        .map_or(0, |collision| collision.push.as_chunks::<3>().0.iter().filter(|push| **push != [0.0; 3]).count());
    println!("in the last pose it pushes {:.0} % of the vertices", 100.0 * pushed as f64 / model.sizes.vertices as f64);
    for (name, [repaired, bare]) in ["SIMD", "baseline"].into_iter().zip(times.as_chunks_mut::<2>().0) {
        let (with, without) = (median(repaired), median(bare));
        let (share, least) = (100.0 * (with / without - 1.0), 100.0 * (repaired[0] / bare[0] - 1.0));
        println!(
            "{name:<9} {with:.2} ms a prediction, {without:.2} without (medians of {runs}): repair is {share:.1} % (of the least {least:.1})"
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
