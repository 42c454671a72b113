//! Predictions on the GPU: whole frames by the host's clock, stages by the GPU's, beside the least work each must do.

use super::median;
use anyhow::Result;
use ctsn_core::Streams;
use ctsn_core::model::HostModel;
use ctsn_gpu::wgpu::PollType;
use ctsn_gpu::{Gpu, Model, Predictor, Stage};
use ctsn_rig::statistics::Sorted;
use pollster::block_on;
use std::time::Instant;

/// Frames submitted together where throughput is measured.
const TOGETHER: usize = 10;

pub fn run(model: &HostModel, poses: &[&[f32]], runs: usize) -> Result<()> {
    let gpu = block_on(Gpu::new())?;
    let model = block_on(Model::new(&gpu, model))?;
    let mut predictor = block_on(Predictor::new(&model))?;
    let stages = model.stages(Streams::Both);
    let dispatches: usize = stages.iter().map(|stage| stage.dispatches).sum();
    let (upload, read) = (48 * model.sizes().joints, 24 * model.sizes().vertices);
    println!(
        "on {}: {dispatches} dispatches a frame, {upload} bytes up, {read} bytes back where they are read",
        gpu.name()
    );
    let wait = || gpu.device().poll(PollType::wait_indefinitely());
    let (mut one, mut many, mut back) = (Vec::new(), Vec::new(), Vec::new());
    for run in 0..runs {
        let pose = poses[run % poses.len()];
        let start = Instant::now();
        predictor.predict_row_major(pose, Streams::Both)?;
        wait()?;
        one.push(start.elapsed().as_secs_f64() * 1e3);
        let start = Instant::now();
        for _ in 0..TOGETHER {
            predictor.predict_row_major(pose, Streams::Both)?;
        }
        wait()?;
        many.push(start.elapsed().as_secs_f64() * 1e3 / TOGETHER as f64);
        let start = Instant::now();
        block_on(predictor.read())?;
        back.push(start.elapsed().as_secs_f64() * 1e3);
    }
    let one = Sorted::new(one);
    println!("frame     {:.3} ms, waited for (median of {runs}, least {:.3})", one.median(), one.percentile(0));
    println!("          {:.3} ms, {TOGETHER} submitted together", median(&many));
    println!("read-back {:.3} ms", median(&back));
    if gpu.has_timestamps() {
        return table(&predictor, &stages, runs);
    }
    println!("the adapter has no timestamps");
    Ok(())
}

/// Medians per stage.
fn table(predictor: &Predictor, stages: &[Stage], runs: usize) -> Result<()> {
    let mut times = vec![Vec::new(); stages.len()];
    for _ in 0..runs {
        let stages = block_on(predictor.time_stages(Streams::Both)?)?;
        times.iter_mut().zip(stages).for_each(|(times, time)| times.push(time));
    }
    println!(
        "{:<11} {:>10} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "stage", "dispatches", "ms", "MFLOP", "MB", "GFLOP/s", "GB/s"
    );
    let mut sum = 0.0;
    for (stage, times) in stages.iter().zip(&times) {
        let time = median(times);
        sum += time;
        let (flop, byte) = (stage.cost.flops * 1e-6, stage.cost.bytes * 1e-6);
        let Stage { name, dispatches, .. } = stage;
        println!(
            "{name:<11} {dispatches:>10} {time:>9.4} {flop:>9.2} {byte:>9.2} {:>9.1} {:>9.1}",
            flop / time,
            byte / time
        );
    }
    println!("{:<11} {:>10} {sum:>9.4}", "sum", "");
    Ok(())
}
