//! The poses whose cloth is simulated coarsely: frames that are learned from, and mixed poses, in turn.

use super::order;
use ctsn_rig::Pose;
use ctsn_rig::mixed::Mixer;

/// Mixed poses from this number on are none that is simulated finely.
const FIRST: usize = 1 << 32;

/// Makes them.
pub(super) struct CoarsePoses {
    frames: Vec<Pose>,
    mixer: Option<Mixer>,
}

impl CoarsePoses {
    /// Of the frames that are learned from, and of what is mixed from them.
    pub fn new(frames: Vec<Pose>, mixer: Option<Mixer>) -> Self {
        // Fine poses are the first ones in this order: the last ones are met among them late or never.
        let frames = order(frames.len()).into_iter().rev().map(|frame| frames[frame].clone()).collect();
        Self { frames, mixer }
    }

    /// Pose number `number`; `None` where there is none that was not there before.
    pub fn pose(&self, number: usize) -> Option<Pose> {
        match &self.mixer {
            None => self.frames.get(number).cloned(),
            Some(mixer) if number.is_multiple_of(2) => Some(mixer.pose(FIRST + number)),
            Some(mixer) => Some(self.frames.get(number / 2).cloned().unwrap_or_else(|| mixer.pose(FIRST + number))),
        }
    }
}
