//! Slow motion between the judged poses, to see a prediction tremble: datasets are sampled too sparsely for that. It needs no truth.
//! Each joint turns evenly, relative to its parent, from one judged pose of a clip to the next; what accelerates is the cloth.

use super::Judge;
use crate::dataset::{Record, Sample};
use crate::rig;

/// Frames from one judged pose to the next, and frames per second: a second each.
const STEPS: usize = 30;
pub(super) const RATE: f64 = 30.0;
/// Pairs of poses moved between, spread over all.
const PAIRS: usize = 40;

/// The frames in between, without truth; each pair of poses is a clip of its own.
pub(super) fn motion(judge: &Judge, samples: &[&Sample]) -> Vec<Sample> {
    let same_clip = |pair: &&[&Sample]| pair[0].record.clip == pair[1].record.clip;
    let pairs: Vec<&[&Sample]> = samples.windows(2).filter(same_clip).collect();
    let chosen = pairs.iter().step_by(pairs.len().div_ceil(PAIRS).max(1)).enumerate();
    let frame = |clip: usize, pair: &[&Sample], frame: usize| Sample {
        record: Record { clip, frame, ..Record::default() },
        joints: rig::joints(&judge.between(pair[0], pair[1], frame as f64 / STEPS as f64)),
        truth: Vec::new(),
    };
    chosen.flat_map(|(clip, pair)| (0..=STEPS).map(move |step| frame(clip, pair, step))).collect()
}
