//! Shards: poses dealt round-robin, so that every shard gets an even mix of easy and hard clips.

use std::str::FromStr;

/// One of `count` equal parts of the poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 0 to below `count`, as array jobs count.
    pub index: usize,
    /// Number of shards, at least 1.
    pub count: usize,
}

impl Shard {
    /// The only shard of an undivided run.
    pub const WHOLE: Shard = Shard { index: 0, count: 1 };

    /// Whether the pose of that index belongs to this shard.
    pub fn holds(&self, pose: usize) -> bool {
        pose % self.count == self.index
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match parts {
            Some((index, count)) if index < count => Ok(Shard { index, count }),
            _ => Err("wanted i/N with i from 0 to N - 1, 0/8 for the first of eight shards".to_owned()),
        }
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}
