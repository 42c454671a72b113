//! Slow motion between the judged poses shows whether a prediction trembles: the poses themselves are too far apart for
//! that. It needs no truth. Each joint turns evenly, relative to its parent, from one judged pose of a clip to the
//! next, so that only the cloth accelerates. The motion has a quarter of the clip's own speed. (Tried: one second from
//! pose to pose. The same cape then trembled more, the denser its clips were sampled.)

use super::Judge;
use crate::dataset::{Record, Sample};

/// How many times slower than the clip.
const SLOWER: f64 = 4.0;
/// Frames per second.
pub(super) const RATE: f64 = 30.0;
/// About how many frames there are in all: pairs of poses are left out evenly to keep to it. A single pair has no more
/// frames either, and moves faster instead.
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
        joints: ctsn_rig::joints(&judge.between(pair[0], pair[1], frame as f64 / steps as f64)),
        truth: Vec::new(),
    };
    let chosen = pairs.into_iter().step_by((all / FRAMES).max(1)).enumerate();
    chosen.flat_map(|(clip, (pair, steps))| (0..=steps).map(move |step| frame(clip, pair, step, steps))).collect()
}
