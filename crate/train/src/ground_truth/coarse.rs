//! The poses whose cloth is simulated coarsely: frames that are learned from, and mixed poses, in turn.

use super::order;
use ctsn_rig::Pose;
use ctsn_rig::mixed::Mixer;

/// Mixed poses from this number on are none that is simulated finely.
const FIRST: usize = 1 << 32;

/// Makes them.
pub(super) struct CoarsePoses {
    frames: Vec<Pose>,
}

impl CoarsePoses {
    /// Of the frames that are learned from.
    pub fn new(frames: &[Pose]) -> Self {
        // Fine poses are the first ones in this order: the last ones are met among them late or never.
        let frames = order(frames.len()).into_iter().rev().map(|frame| frames[frame].clone()).collect();
        Self { frames }
    }

    /// Pose number `number`; `None` where nothing can be mixed and the frames are used up.
    pub fn pose(&self, number: usize, mixer: Option<&Mixer>) -> Option<Pose> {
        let Some(mixer) = mixer else { return self.frames.get(number).cloned() };
        let frame = (!number.is_multiple_of(2)).then(|| self.frames.get(number / 2).cloned()).flatten();
        Some(frame.unwrap_or_else(|| mixer.pose(FIRST + number)))
    }

    /// How many poses there are.
    pub fn count(&self, mixer: Option<&Mixer>) -> usize {
        if mixer.is_some() { usize::MAX } else { self.frames.len() }
    }
}
