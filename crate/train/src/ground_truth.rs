//! Simulates the frames of a character's clips into a dataset folder. Poses run in parallel and are written as soon as
//! they are done; those already there are skipped. The result does not depend on order, threads or shards; of the
//! machine, only on its [`level`](level::level).

mod adopted;
mod coarse;
mod level;
pub mod noise;
mod poses;
mod request;
mod shard;
mod teacher;
#[cfg(test)]
mod tests;
mod timing;

use crate::dataset::{Record, Sample, Split, coarse_path, mixed_path, pose_path, twin_path};
use crate::judging::check_joints;
use crate::{Error, Result};
pub use adopted::adopt;
use coarse::CoarsePoses;
use ctsn_cloth::simulate::{Outcome, Simulator};
use ctsn_rig::mixed::Mixer;
use ctsn_rig::path::is_sound;
use ctsn_rig::{Character, Pose, joints, numbers, vertices};
use glam::DVec3;
pub use poses::unsimulated;
use rayon::prelude::*;
pub use request::Request;
pub use shard::Shard;
use std::path::{Path, PathBuf};
use std::time::Instant;
use teacher::Teacher;
pub use timing::Log;
use timing::{Stopwatch, Timing};

/// Greatest turn of a joint of a mixed pose beyond its frame, radians: 30°.
const FURTHER: f64 = std::f64::consts::FRAC_PI_6;

/// Kinds of poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A frame of a clip.
    Frame,
    /// A frame a little changed, for the noise floor.
    Twin,
    /// Limbs of several frames ([`Mixer`]); its number stands where others have a frame number.
    Mixed,
    /// A pose of which a fine garment is simulated thinned, for the skeleton stream; likewise.
    Coarse,
}

/// A pose to simulate, and where it goes.
struct Task {
    kind: Kind,
    clip: usize,
    frame: usize,
    path: PathBuf,
}

/// One run: what is left to do in a folder.
pub struct Run<'a> {
    request: Request<'a>,
    folder: PathBuf,
    simulator: Simulator,
    teacher: Option<Teacher<'a>>,
    mixer: Option<Mixer>,
    coarse: Option<CoarsePoses>,
    /// `T_C` as the setup keeps it, metres [n].
    template: Vec<DVec3>,
    tasks: Vec<Task>,
    /// Poses of this shard, of any kind, that were there already.
    pub found: usize,
}

impl<'a> Run<'a> {
    /// Prepares dataset `folder`, draping the garment unless that was done before.
    pub fn new(request: Request<'a>, folder: &Path) -> Result<Self> {
        let poses = request.frames()?;
        let frames = if request.mixed + request.coarse > 0 { learned(request.character) } else { Vec::new() };
        let coarse = (request.coarse > 0).then(|| CoarsePoses::new(&frames));
        let mixer = Mixer::new(request.character, frames, FURTHER);
        if request.mixed > 0 && mixer.is_none() {
            let wanted = "wanted limbs, two chains of joints at least, and frames to learn from";
            return Err(Error::Simulation(format!("{} has nothing to mix: {wanted}", request.names[0])));
        }
        if request.coarse > 0 && request.teacher.is_none() {
            let wanted = "wanted a model from whose predictions they are relaxed";
            return Err(Error::Simulation(format!("{} coarse poses: {wanted}, found none", request.coarse)));
        }
        let mut wanted = request.setup();
        if let Some(teacher) = request.teacher {
            check_joints(teacher, &wanted)?;
        }
        let settings = request.settings.clone();
        let simulator = Simulator::new(request.character, request.garment, request.material.1, settings)?;
        let mut begun = wanted.take_drape(folder)?;
        if !begun {
            wanted.template = numbers(&simulator.drape()?);
            // Another machine may have begun the folder meanwhile.
            begun = wanted.take_drape(folder)?;
        }
        let teacher = request.teacher.map(|model| Teacher::new(model, &wanted)).transpose()?;
        if !begun {
            wanted.write(folder)?;
        }
        let template = vertices(&wanted.template);
        let coarse = coarse.filter(|_| simulator.is_fine());
        let count = coarse.as_ref().map_or(0, |poses| poses.count(mixer.as_ref()));
        let mut tasks = tasks(&request, poses, folder);
        tasks.retain(|task| task.kind != Kind::Coarse || task.frame < count);
        let all = tasks.len();
        tasks.retain(|task| !task.path.exists());
        Ok(Self {
            found: all - tasks.len(),
            request,
            folder: folder.to_owned(),
            simulator,
            teacher,
            mixer,
            coarse,
            template,
            tasks,
        })
    }

    /// Poses of any kind left to simulate.
    pub fn left(&self) -> usize {
        self.tasks.len()
    }

    /// Simulates what is left, beginning no pose after `until`. `progress(record, kind)` is called after every pose.
    pub fn simulate(&self, until: Option<Instant>, progress: impl Fn(&Record, Kind) + Sync) -> Result<()> {
        let timing = Timing::open(&self.folder, self.request.shard)?;
        let character = self.request.character;
        let run = |task: &Task| -> Result<()> {
            if until.is_some_and(|until| Instant::now() >= until) {
                return Ok(());
            }
            let start = Stopwatch::start();
            let frame = || &character.clips[task.clip].poses[task.frame];
            let number = task.frame;
            let other = match task.kind {
                Kind::Frame => None,
                Kind::Twin => Some(noise::turned(character, frame(), task.clip, number)),
                Kind::Mixed => self.mixer.as_ref().map(|mixer| mixer.pose(number)),
                Kind::Coarse => self.coarse.as_ref().and_then(|poses| poses.pose(number, self.mixer.as_ref())),
            };
            let pose = other.unwrap_or_else(|| frame().clone());
            let outcome = self.outcome(&pose, task.kind);
            let record = Record::new(task.clip, task.frame, &outcome);
            let sample = Sample { record, joints: joints(&pose), truth: numbers(&outcome.positions) };
            sample.write(&task.path)?;
            timing.add(&sample.record, start.elapsed())?;
            progress(&sample.record, task.kind);
            Ok(())
        };
        self.tasks.par_iter().with_max_len(1).try_for_each(run)
    }

    /// One pose, simulated from what the teacher predicts; along the path where there is no teacher. So it is, too,
    /// where what comes of a prediction would be left out: layers of it may be jammed, or on the wrong side of a limb.
    /// Not so a pose that was made up: of a dress of 6,016 vertices one that came to rest took 11 s of a core, one that
    /// did not by any way 457 s. Another is as good.
    fn outcome(&self, pose: &Pose, kind: Kind) -> Outcome {
        let (simulator, template) = (&self.simulator, &self.template);
        let predicted = self.teacher.as_ref().and_then(|teacher| {
            let start = teacher.predict(self.request.character, pose, template).ok()?;
            match kind {
                Kind::Coarse => simulator.relax_coarse(template, pose, &start),
                Kind::Mixed => Some(simulator.try_relax(template, pose, &start)),
                Kind::Frame | Kind::Twin => Some(simulator.relax(template, pose, &start)),
            }
        });
        let is_made_up = matches!(kind, Kind::Mixed | Kind::Coarse);
        predicted.filter(|it| it.converged() || is_made_up).unwrap_or_else(|| simulator.simulate(template, pose))
    }
}

/// The frames to train on. Mixed poses are made of these alone, so that unseen frames stay unseen.
fn learned(character: &Character) -> Vec<Pose> {
    let clips = &character.clips;
    let train =
        |clip: usize, frame: usize| Split::of(clips.len(), clip, frame, clips[clip].poses.len()) == Split::Train;
    let frames = |clip: usize| clips[clip].poses.iter().enumerate().filter(move |(frame, _)| train(clip, *frame));
    let frames = (0..clips.len()).flat_map(frames).map(|(_, pose)| pose);
    frames.filter(|pose| is_sound(character, pose)).cloned().collect()
}

/// The poses and twins of the request's shard, in [`order`], its mixed and coarse poses evenly among them.
fn tasks(request: &Request, poses: usize, folder: &Path) -> Vec<Task> {
    let clips = request.character.clips.iter().enumerate();
    let frames: Vec<_> = clips.flat_map(|(clip, sampled)| (0..sampled.poses.len()).map(move |f| (clip, f))).collect();
    let chosen: Vec<usize> = order(poses).into_iter().take(request.poses.unwrap_or(poses)).collect();
    let held = |count: usize| (0..count).filter(|number| request.shard.holds(*number));
    // Each with the share of its kind that comes before.
    let mut tasks = Vec::new();
    for index in held(chosen.len()) {
        let ((clip, frame), share) = (frames[chosen[index]], index as f64 / chosen.len() as f64);
        tasks.push((share, Task { kind: Kind::Frame, clip, frame, path: pose_path(folder, clip, frame) }));
        if index < request.twins {
            tasks.push((share, Task { kind: Kind::Twin, clip, frame, path: twin_path(folder, clip, frame) }));
        }
    }
    for frame in held(request.mixed) {
        let task = Task { kind: Kind::Mixed, clip: 0, frame, path: mixed_path(folder, frame) };
        tasks.push((frame as f64 / request.mixed as f64, task));
    }
    for frame in held(request.coarse) {
        let task = Task { kind: Kind::Coarse, clip: 0, frame, path: coarse_path(folder, frame) };
        tasks.push((frame as f64 / request.coarse as f64, task));
    }
    tasks.sort_by(|a, b| a.0.total_cmp(&b.0));
    tasks.into_iter().map(|(_, task)| task).collect()
}

/// Indices below `count`, ordered so that the first few, however many, are evenly spread: by the fractional part of
/// index times golden ratio. So more poses extend fewer, an interrupted run has done some of every clip, and no gait is
/// always met at the same phase.
fn order(count: usize) -> Vec<usize> {
    const GOLDEN: u32 = 0x9E37_79B9;
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|index| (*index as u32).wrapping_mul(GOLDEN));
    order
}
