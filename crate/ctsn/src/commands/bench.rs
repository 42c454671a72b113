//! `ctsn bench`: milliseconds per prediction and per training step on this machine.

mod gpu;
mod stages;

use super::Device;
use anyhow::{Result, ensure};
use ctsn_core::cpu::{Cpu, Level, Threads};
use ctsn_core::model::{Cut, HostModel, STEPS, Sizes, Storage};
use ctsn_core::network::{Activations, collide, forward, polish, pose, skin, stand};
use ctsn_core::operation::Space;
use ctsn_core::pose::BodyFrame;
use ctsn_core::{Predictor, Streams};
use ctsn_rig::statistics::Sorted;
use ctsn_train::dataset::{Dataset, Sample, Setup};
use ctsn_train::synthetic;
use ctsn_train::training::{Architecture, Settings, Trainer};
use std::path::PathBuf;
use std::time::Instant;

/// Time predictions and training steps, of a trained model or of one of given size with random weights
#[derive(clap::Args)]
pub struct Arguments {
    /// Model file to time, with DATA; without one, a model of made-up cloth
    #[arg(requires = "data", conflicts_with_all = ["vertices", "joints", "write_model", "Architecture"])]
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
    network: Architecture,
    /// Device that computes
    #[arg(long, value_enum, default_value = "cpu")]
    device: Device,
    /// Threads that compute on the CPU
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    threads: u16,
    /// Predictions timed
    #[arg(long, default_value_t = 200)]
    runs: usize,
    /// Only write the model to this file, for a benchmark elsewhere
    #[arg(long)]
    write_model: Option<PathBuf>,
    /// Time every operation by itself, beside what its flops and bytes take at the processor's limits
    #[arg(long, conflicts_with_all = ["device", "threads", "train"])]
    stages: bool,
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
        return Ok(ctsn_rig::file::write(path, &model.to_bytes(Storage::F32))?);
    }
    let Sizes { vertices, joints, embedding, basis, features, .. } = model.sizes;
    let layers = model.layers.len();
    println!("n = {vertices}, J = {joints}, m = {embedding}, k = {basis}, L = {layers}, F = {features}");
    let poses: Vec<&[f32]> = samples.iter().map(|sample| sample.joints.as_slice()).collect();
    let runs = arguments.runs.max(1);
    if arguments.stages {
        return stages::run(&model, &poses, runs);
    }
    match arguments.device {
        Device::Cpu => cpu(&model, &poses, runs, arguments.threads.into())?,
        Device::Gpu => gpu::run(&model, &poses, runs)?,
    }
    if arguments.train {
        train(model, &setup, &samples.iter().collect::<Vec<_>>())?;
    }
    Ok(())
}

/// A model of made-up cloth, its setup and its poses.
fn made_up(arguments: &Arguments) -> Result<(HostModel, Setup, Vec<Sample>)> {
    let (setup, samples) = synthetic::dataset(arguments.vertices, arguments.joints, 16);
    let all: Vec<_> = samples.iter().collect();
    let mut model = ctsn_train::training::initial(&setup, &all, arguments.network, 1)?;
    // The repair must find the body where the cloth is predicted.
    let worn = samples.iter().map(|sample| worn(&model, sample)).collect::<Result<Vec<_>>>()?;
    model.body = Some(ctsn_train::body::body(&setup, &worn.iter().collect::<Vec<_>>(), &[])?);
    model.cut = Some(Cut::new(setup.garment.clone(), &model.graph, STEPS)?);
    Ok((model, setup, samples))
}

/// The sample with plainly skinned cloth as its truth: about what an untrained network predicts.
fn worn(model: &HostModel, sample: &Sample) -> Result<Sample> {
    let mut frame = BodyFrame::new(model.sizes.joints);
    model.rig.body_frame(&sample.joints, &mut frame)?;
    let mut truth = vec![0.0; model.rest.len()];
    skin(&mut Cpu::new(), &model.rest, &model.skinning, &frame.transforms, Space::Body, &mut truth);
    Ok(Sample { truth, ..sample.clone() })
}

/// Predictions on the CPU, and the repair of penetration in them.
fn cpu(model: &HostModel, poses: &[&[f32]], runs: usize, threads: usize) -> Result<()> {
    let threads = Threads::new(threads)?;
    let triangles = model.body.as_ref().map_or(0, |body| body.triangles.len() / 3);
    println!("with repair of penetration against a body of {triangles} triangles");
    let mut timed = [Level::new(), Level::baseline()].map(|level| Timed::new(model, level, &threads));
    // By turns, so that other work of the machine slows all of them alike.
    for run in 0..runs {
        for timed in &mut timed {
            timed.predict(poses[run % poses.len()])?;
        }
    }
    let pushed = timed[0]
        .room
        .collision
        .as_ref()
        .map_or(0, |collision| collision.push.as_chunks::<3>().0.iter().filter(|push| **push != [0.0; 3]).count());
    println!("in the last pose it pushes {:.0} % of the vertices", 100.0 * pushed as f64 / model.sizes.vertices as f64);
    for (name, timed) in ["SIMD", "baseline"].into_iter().zip(&mut timed) {
        let (whole, repair) = (median(&timed.whole), median(&timed.repair));
        let share = 100.0 * repair / (whole - repair);
        println!(
            "{name:<9} {whole:.2} ms a prediction, {repair:.2} of it repair: {share:.1} % of the rest (medians of {runs})"
        );
    }
    Ok(())
}

/// Predictions at one SIMD level, timed as a whole; then the repair of penetration is timed by itself. (Tried: the
/// difference to a predictor without a body. It came to 15 or 31 % from one process to the next, since one of the two
/// was a tenth faster for its place in memory.)
struct Timed {
    predictor: Predictor,
    device: Cpu,
    room: Activations<Vec<f32>>,
    /// Milliseconds.
    whole: Vec<f64>,
    repair: Vec<f64>,
}

impl Timed {
    fn new(model: &HostModel, level: Level, threads: &Threads) -> Self {
        let mut room = Activations::new(model, |_, length| vec![0.0; length]);
        (room.skeleton_share[0], room.mesh_share[0]) = (1.0, 1.0);
        let predictor = Predictor::on_threads(model.clone(), level, threads.clone());
        Self {
            predictor,
            device: Cpu::with_threads(level, threads.clone()),
            room,
            whole: Vec::new(),
            repair: Vec::new(),
        }
    }

    fn predict(&mut self, joints: &[f32]) -> Result<()> {
        let start = Instant::now();
        self.predictor.predict_row_major(joints, Streams::Both)?;
        self.whole.push(start.elapsed().as_secs_f64() * 1e3);
        let (device, model, room) = (&mut self.device, self.predictor.model(), &mut self.room);
        model.rig.read(joints, &mut room.joints)?;
        pose(device, model, room);
        forward(device, model, Streams::Both, Space::World, room);
        let start = Instant::now();
        stand(device, model, room);
        let stood = start.elapsed();
        polish(device, model, room);
        let start = Instant::now();
        collide(device, model, true, room);
        self.repair.push((stood + start.elapsed()).as_secs_f64() * 1e3);
        Ok(())
    }
}

/// Times training steps by the paper's losses alone, to compare with other frameworks.
fn train(model: HostModel, setup: &Setup, samples: &[&Sample]) -> Result<()> {
    let settings = Settings { epochs: Some(10), ..Settings::default() };
    let mut trainer = Trainer::new(HostModel { body: None, ..model }, setup, samples, settings)?;
    let (mut times, mut last) = (Vec::new(), Instant::now());
    while trainer.epoch < settings.epochs() {
        trainer.epoch(|_, _, _| {
            times.push(last.elapsed().as_secs_f64() * 1e3);
            last = Instant::now();
        })?;
    }
    println!("training  {:.1} ms a step of {} poses (median of {})", median(&times), settings.batch, times.len());
    Ok(())
}

/// The median of times.
fn median(times: &[f64]) -> f64 {
    Sorted::new(times.iter().copied()).median()
}
