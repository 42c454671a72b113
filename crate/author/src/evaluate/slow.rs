//! Slow motion between the judged poses, to see a prediction tremble: datasets are sampled too sparsely for that. It needs no truth.
//! Each joint turns evenly, relative to its parent, from one judged pose of a clip to the next; what accelerates is the cloth. All move at
//! a quarter of the clip's own speed: a second from each to the next, the same cape trembled more the denser its clips were sampled.

use super::Judge;
use crate::dataset::{Record, Sample};
use crate::rig;

/// How many times slower than the clip.
const SLOWER: f64 = 4.0;
/// Frames per second.
pub(super) const RATE: f64 = 30.0;
/// Frames in all, about: so many of the pairs of poses, spread over all. Poses further apart than that are moved between faster.
const FRAMES: usize = 1200;

/// The frames in between, without truth; each pair of poses is a clip of its own.
pub(super) fn motion(judge: &Judge, samples: &[&Sample]) -> Vec<Sample> {
    let same_clip = |pair: &&[&Sample]| pair[0].record.clip == pair[1].record.clip;
    let steps = |pair: &[&Sample]| {
        let seconds = pair[1].record.frame.abs_diff(pair[0].record.frame) as f64 / judge.rate();
        ((seconds * SLOWER * RATE).round() as usize).clamp(2, FRAMES)
    };
    let pairs: Vec<_> = samples.windows(2).filter(same_clip).map(|pair| (pair, steps(pair))).collect();
    let all: usize = pairs.iter().map(|(_, steps)| steps).sum();
    let frame = |clip: usize, pair: &[&Sample], frame: usize, steps: usize| Sample {
        record: Record { clip, frame, ..Record::default() },
        joints: rig::joints(&judge.between(pair[0], pair[1], frame as f64 / steps as f64)),
        truth: Vec::new(),
    };
    let chosen = pairs.into_iter().step_by((all / FRAMES).max(1)).enumerate();
    chosen.flat_map(|(clip, (pair, steps))| (0..=steps).map(move |step| frame(clip, pair, step, steps))).collect()
}
