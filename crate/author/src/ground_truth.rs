//! Simulates every frame of a character's clips into a dataset folder: poses in parallel, each written as soon as it is done,
//! those already there skipped. The result does not depend on order, threads or shards.

pub mod noise;
mod request;
mod shard;
#[cfg(test)]
mod tests;
mod timing;

use crate::dataset::{Record, Sample, Setup, pose_path, twin_path};
use crate::rig::{Pose, joints, numbers, vertices};
use crate::simulate::Simulator;
use crate::{Error, Result};
use glam::DVec3;
use rayon::prelude::*;
pub use request::Request;
pub use shard::Shard;
use std::path::{Path, PathBuf};
pub use timing::seconds;
use timing::{Stopwatch, Timing};

/// A pose to simulate, and where it goes.
struct Task<'a> {
    clip: usize,
    frame: usize,
    twin: bool,
    pose: &'a Pose,
    path: PathBuf,
}

/// One run: what is left to do in a folder.
pub struct Run<'a> {
    request: Request<'a>,
    folder: PathBuf,
    simulator: Simulator,
    /// `T_C` as the setup keeps it, metres [n].
    template: Vec<DVec3>,
    tasks: Vec<Task<'a>>,
    /// Poses and twins of this shard that were there already.
    pub found: usize,
}

impl<'a> Run<'a> {
    /// Prepares dataset `folder`, draping the garment unless that was done before.
    pub fn new(request: Request<'a>, folder: &Path) -> Result<Self> {
        let poses: usize = request.character.clips.iter().map(|clip| clip.poses.len()).sum();
        if poses == 0 {
            let name = request.names[0];
            let reason = format!("{name} has no clip, wanted at least one: there is no pose to simulate");
            return Err(Error::Simulation(reason));
        }
        let settings = request.settings.clone();
        let simulator = Simulator::new(request.character, request.garment, request.material.1, settings)?;
        let mut wanted = request.setup();
        let setup = match Setup::read(folder)? {
            Some(found) => {
                found.check_same(&wanted, folder)?;
                found
            }
            None => {
                wanted.template = numbers(&simulator.drape()?);
                wanted.write(folder)?;
                wanted
            }
        };
        let template = vertices(&setup.template);
        let mut tasks = tasks(&request, poses, folder);
        let all = tasks.len();
        tasks.retain(|task| !task.path.exists());
        Ok(Self { found: all - tasks.len(), request, folder: folder.to_owned(), simulator, template, tasks })
    }

    /// Poses and twins left to simulate.
    pub fn left(&self) -> usize {
        self.tasks.len()
    }

    /// Simulates what is left. `progress(record, twin)` follows every pose; a twin serves the noise floor only.
    pub fn simulate(&self, progress: impl Fn(&Record, bool) + Sync) -> Result<()> {
        let timing = Timing::open(&self.folder, self.request.shard)?;
        let run = |task: &Task| -> Result<()> {
            let start = Stopwatch::start();
            let turned = task.twin.then(|| noise::turned(self.request.character, task.pose, task.clip, task.frame));
            let pose = turned.as_ref().unwrap_or(task.pose);
            let outcome = self.simulator.simulate(&self.template, pose);
            let record = Record::new(task.clip, task.frame, &outcome);
            let sample = Sample { record, joints: joints(pose), truth: numbers(&outcome.positions) };
            sample.write(&task.path)?;
            timing.add(&sample.record, start.elapsed())?;
            progress(&sample.record, task.twin);
            Ok(())
        };
        self.tasks.par_iter().with_max_len(1).try_for_each(run)
    }
}

/// The poses and twins of the request's shard, in [`order`].
fn tasks<'a>(request: &Request<'a>, poses: usize, folder: &Path) -> Vec<Task<'a>> {
    let clips = request.character.clips.iter().enumerate();
    let frames = clips
        .flat_map(|(clip, sampled)| sampled.poses.iter().enumerate().map(move |(frame, pose)| (clip, frame, pose)));
    let frames: Vec<_> = frames.collect();
    let chosen = order(poses).into_iter().take(request.poses.unwrap_or(poses)).enumerate();
    let mut tasks = Vec::new();
    for (index, at) in chosen.filter(|(index, _)| request.shard.holds(*index)) {
        let (clip, frame, pose) = frames[at];
        tasks.push(Task { clip, frame, twin: false, pose, path: pose_path(folder, clip, frame) });
        if index < request.twins {
            tasks.push(Task { clip, frame, twin: true, pose, path: twin_path(folder, clip, frame) });
        }
    }
    tasks
}

/// Indices below `count` in an order of which every beginning is evenly spread: multiples of the golden ratio, by their fraction. So more
/// poses add to fewer, a run that is cut off has done some of every clip, and no gait is always met at the same phase.
fn order(count: usize) -> Vec<usize> {
    const GOLDEN: u32 = 0x9E37_79B9;
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|index| (*index as u32).wrapping_mul(GOLDEN));
    order
}
