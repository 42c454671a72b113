//! Which poses are learned from, which are watched while learning, which stay unseen.

use super::{Dataset, Sample};

/// What a pose of a dataset is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// What is learned from.
    Train,
    /// By what training is steered: every tenth of the other clips; with fewer than ten clips, the tenth of each before
    /// the last.
    Validation,
    /// The last tenth of the clips, unseen during training; with fewer than ten clips, the last tenth of each in time.
    Test,
    /// Every pose, whichever it is for: of data that nothing was learned from.
    All,
}

impl Split {
    /// What frame `frame` of a clip of `length` frames is for, the clip being number `clip` of `clips`.
    pub fn of(clips: usize, clip: usize, frame: usize, length: usize) -> Self {
        // A few clips cannot be parted: the test would see motion of one kind only.
        let (test, validation) = match clips {
            // Of a clip of fewer than ten frames the last one, and the one before it.
            0..10 => {
                (frame * 10 >= length * 9 || frame + 1 >= length, frame * 100 >= length * 81 || frame + 2 >= length)
            }
            // Spread over the clips: neighbours are often of one kind.
            _ => (clip >= clips - clips.div_ceil(10), clip % 10 == 4),
        };
        match (test, validation) {
            (true, _) => Self::Test,
            (_, true) => Self::Validation,
            _ => Self::Train,
        }
    }
}

impl Dataset {
    /// All that was kept of the simulated garment itself, mixed poses last.
    pub fn all(&self) -> impl Iterator<Item = &Sample> {
        self.samples.iter().chain(&self.mixed)
    }

    /// The samples of one split, without mixed poses.
    pub fn split(&self, split: Split) -> Vec<&Sample> {
        let description = &self.setup.description;
        let clips = description.clips.len();
        // What is made up may tell no lengths.
        let mut lengths = description.frames.clone();
        lengths.resize(clips, 0);
        for record in self.samples.iter().map(|sample| &sample.record).chain(&self.rejected) {
            lengths[record.clip] = lengths[record.clip].max(record.frame + 1);
        }
        let of =
            |sample: &Sample| Split::of(clips, sample.record.clip, sample.record.frame, lengths[sample.record.clip]);
        self.samples.iter().filter(|sample| split == Split::All || of(sample) == split).collect()
    }
}
