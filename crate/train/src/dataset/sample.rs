//! One simulated pose: where it came from, how its simulation ended, its joints and the true positions; a file each.
//! Nothing in it names the machine or the hour: on machines of one level the same pose is the same file, byte for byte.

use super::{json, to_json};
use crate::{Error, Result};
use ctsn_cloth::simulate::{Outcome, Status};
use ctsn_core::file::{Tensor, Tensors};
use ctsn_rig::file::{tensors, write};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// How the simulation of one pose ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Index into the description's clips.
    pub clip: usize,
    /// Frame within the clip.
    pub frame: usize,
    /// Why the pose was left out; `None` when it converged.
    pub rejected: Option<String>,
    /// RMS residual force, in mean vertex weights.
    pub residual: f64,
    /// RMS move of the vertices over the last iterations, metres; zero where the residual alone says that the cloth is
    /// at rest.
    pub drift: f64,
    /// 99th percentile of the principal stretch over the triangles.
    pub stretch_p99: f64,
    /// Greatest stretch, principal.
    pub stretch: f64,
    /// Least signed distance to the body, metres.
    pub distance: f64,
    /// Pairs of cloth triangles that cross each other.
    pub crossings: usize,
    /// Vertices that were moved out of the body at the end.
    pub lifted: usize,
}

impl Record {
    /// The record of an outcome.
    pub fn new(clip: usize, frame: usize, outcome: &Outcome) -> Self {
        let rejected = match &outcome.status {
            Status::Converged => None,
            Status::Rejected { reason } => Some(reason.clone()),
        };
        // JSON has neither infinity nor NaN; a refused pose carries a large number instead.
        let finite = |value: f64| if value.is_nan() { 1e9 } else { value.clamp(-1e9, 1e9) };
        Self {
            clip,
            frame,
            rejected,
            residual: finite(outcome.residual),
            drift: finite(outcome.drift),
            stretch_p99: finite(outcome.stretch_p99),
            stretch: finite(outcome.stretch_max),
            distance: finite(outcome.least_distance),
            crossings: outcome.crossings,
            lifted: outcome.lifted,
        }
    }
}

/// One simulated pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Where it came from and how it ended.
    pub record: Record,
    /// `G_j` [J, 3, 4], row-major, world.
    pub joints: Vec<f32>,
    /// True positions in the body frame [n, 3].
    pub truth: Vec<f32>,
}

/// Path of one pose of dataset `folder`.
pub fn pose_path(folder: &Path, clip: usize, frame: usize) -> PathBuf {
    folder.join("poses").join(format!("{clip:03}-{frame:05}.safetensors"))
}

/// Path of the twin of one pose: the same pose a little changed, simulated to measure the noise floor.
pub fn twin_path(folder: &Path, clip: usize, frame: usize) -> PathBuf {
    folder.join("twins").join(format!("{clip:03}-{frame:05}.safetensors"))
}

/// Path of mixed pose `number`.
pub fn mixed_path(folder: &Path, number: usize) -> PathBuf {
    folder.join("mixed").join(format!("{number:05}.safetensors"))
}

/// Path of coarsely simulated pose `number`.
pub fn coarse_path(folder: &Path, number: usize) -> PathBuf {
    folder.join("coarse").join(format!("{number:05}.safetensors"))
}

/// The files of poses in `folder`, in the order of clip and frame; none where there is no such folder.
pub fn paths(folder: &Path) -> Result<Vec<PathBuf>> {
    let io = |source| Error::Io { path: folder.to_owned(), source };
    let mut paths = Vec::new();
    if !folder.exists() {
        return Ok(paths);
    }
    for entry in std::fs::read_dir(folder).map_err(io)? {
        paths.push(entry.map_err(io)?.path());
    }
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "safetensors"));
    paths.sort_by_cached_key(|path| (numbered(path), path.clone()));
    Ok(paths)
}

/// The numbers in a name. As text, clip 1000 would stand before clip 101.
fn numbered(path: &Path) -> Vec<usize> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    name.split('-').map(|part| part.parse().unwrap_or(usize::MAX)).collect()
}

impl Sample {
    /// Writes one pose.
    pub fn write(&self, path: &Path) -> Result<()> {
        let mut file = Tensors::default();
        file.metadata.insert("record".to_owned(), to_json(&self.record)?);
        file.tensors.insert("pose.joints".to_owned(), Tensor::f32(&[self.joints.len() / 12, 3, 4], &self.joints));
        file.tensors.insert("truth.positions".to_owned(), Tensor::f32(&[self.truth.len() / 3, 3], &self.truth));
        write(path, &file.to_bytes())
    }

    /// Reads one pose of `joints` joints and `vertices` cloth vertices.
    pub fn read(path: &Path, joints: usize, vertices: usize) -> Result<Self> {
        let named = |reason: String| Error::File { path: path.to_owned(), reason };
        let file = tensors(path)?;
        let record = json(&file, "record").map_err(|error| named(error.to_string()))?;
        let values = |name: &str, shape: &[Option<usize>]| {
            file.f32(name, shape).map(|values| values.0).map_err(|error| named(error.to_string()))
        };
        let pose = values("pose.joints", &[Some(joints), Some(3), Some(4)])?;
        Ok(Self { record, joints: pose, truth: values("truth.positions", &[Some(vertices), Some(3)])? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thousand_clips_stay_in_order() {
        let name = |clip| pose_path(Path::new(""), clip, 7);
        let mut names = [1000, 2, 101, 99, 100].map(name);
        names.sort_by_cached_key(|path| numbered(path));
        assert_eq!(names, [2, 99, 100, 101, 1000].map(name));
        assert_eq!(numbered(&mixed_path(Path::new(""), 12)), [12]);
    }
}
