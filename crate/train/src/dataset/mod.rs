//! Simulated truth on disk: a folder with `setup.safetensors` (cloth, body, joints) and one file per pose under
//! `poses/`. One file per pose, written whole or not at all, makes the simulation resumable and lets shards merge by
//! copying.

mod digest;
mod drawn;
mod garment;
mod nearest;
mod same;
mod sample;
mod setup;
mod split;

use crate::{Error, Result};
use ctsn_core::file::Tensors;
pub use digest::{digest, fingerprint};
pub use drawn::{Drawn, stored_surface};
pub(crate) use sample::paths;
pub use sample::{Record, Sample, coarse_path, mixed_path, pose_path, twin_path};
use serde::{Deserialize, Serialize};
pub use setup::{Description, Setup};
pub use split::Split;
use std::path::Path;

/// A dataset in memory; rejected poses are left out of `samples` and counted.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// Cloth, body, joints.
    pub setup: Setup,
    /// Accepted poses, in the order of clip and frame.
    pub samples: Vec<Sample>,
    /// The poses that were left out, in the same order.
    pub rejected: Vec<Record>,
    /// Accepted mixed poses, to learn from only.
    pub mixed: Vec<Sample>,
    /// The mixed poses that were left out.
    pub mixed_rejected: Vec<Record>,
    /// Accepted poses whose cloth was simulated coarsely, to learn from only.
    pub coarse: Vec<Sample>,
    /// Those that were left out.
    pub coarse_rejected: Vec<Record>,
}

impl Dataset {
    /// A dataset of frames that were all kept.
    pub fn new(setup: Setup, samples: Vec<Sample>) -> Self {
        let [rejected, mixed_rejected, coarse_rejected] = Default::default();
        let [mixed, coarse] = Default::default();
        Self { setup, samples, rejected, mixed, mixed_rejected, coarse, coarse_rejected }
    }

    /// Reads a whole dataset.
    pub fn read(folder: &Path) -> Result<Self> {
        let setup = Setup::existing(folder)?;
        let sizes = (setup.description.joints.len(), setup.template.len() / 3);
        let read = |part: &str| -> Result<(Vec<Sample>, Vec<Record>)> {
            let (mut samples, mut rejected) = (Vec::new(), Vec::new());
            for path in paths(&folder.join(part))? {
                let sample = Sample::read(&path, sizes.0, sizes.1)?;
                if sample.record.rejected.is_none() { samples.push(sample) } else { rejected.push(sample.record) }
            }
            Ok((samples, rejected))
        };
        let ((samples, rejected), (mixed, mixed_rejected)) = (read("poses")?, read("mixed")?);
        let (coarse, coarse_rejected) = read("coarse")?;
        let clips = setup.description.clips.len();
        if let Some(record) = samples.iter().map(|sample| &sample.record).chain(&rejected).find(|r| r.clip >= clips) {
            let reason = format!("holds a pose of clip {}, wanted one of {clips} clips, from 0", record.clip);
            return Err(Error::File { path: folder.to_owned(), reason });
        }
        Ok(Self { setup, samples, rejected, mixed, mixed_rejected, coarse, coarse_rejected })
    }

    /// The frames that were left out, read from the `folder` of this dataset: how their cloth ended.
    pub fn left_out(&self, folder: &Path) -> Result<Vec<Sample>> {
        let (joints, vertices) = (self.setup.description.joints.len(), self.setup.template.len() / 3);
        let read = |record: &Record| Sample::read(&pose_path(folder, record.clip, record.frame), joints, vertices);
        self.rejected.iter().map(read).collect()
    }
}

/// A value of a file's metadata.
fn json<T: for<'a> Deserialize<'a>>(file: &Tensors, key: &str) -> Result<T> {
    let text = file.metadata.get(key).ok_or_else(|| Error::Dataset(format!("__metadata__ has no key {key}")))?;
    serde_json::from_str(text).map_err(|error| Error::Dataset(format!("__metadata__ {key}: {error}")))
}

/// A value for a file's metadata.
fn to_json<T: Serialize>(value: &T) -> Result<String> {
    serde_json::to_string(value).map_err(|error| Error::Dataset(error.to_string()))
}
