//! Simulated truth on disk: a folder with `setup.safetensors` (cloth, body, joints) and one file per pose under `poses/`.
//! One file per pose, written whole or not at all, makes the simulation resumable and lets shards merge by copying.

use crate::rig::SkinWeights;
use crate::{Error, Result};
use ctsn_core::file::{Tensor, Tensors};
use ctsn_core::model::Surface;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What the poses of a dataset have in common, besides the meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// Character file name.
    pub character: String,
    /// Garment file name.
    pub garment: String,
    /// Poses per second at which the clips were sampled.
    pub rate: f64,
    /// Clip names; poses name their clip by index.
    pub clips: Vec<String>,
    /// Joint names.
    pub joints: Vec<String>,
    /// Index of the hip.
    pub root: usize,
    /// `B_j⁻¹`, row-major 3×4.
    pub inverse_bind: Vec<Vec<f32>>,
    /// Material, as the simulator names it.
    pub material: String,
}

/// Everything about a dataset but its poses.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Names and joints.
    pub description: Description,
    /// The garment before it was draped [n, 3].
    pub garment: Vec<f32>,
    /// `T_C`: the garment at rest on the canonical body [n, 3].
    pub template: Vec<f32>,
    /// Cloth triangles [t, 3].
    pub triangles: Vec<u32>,
    /// What is drawn of the cloth.
    pub surface: Surface,
    /// Body vertices in the canonical pose [b, 3].
    pub body: Vec<f32>,
    /// Body triangles.
    pub body_triangles: Vec<u32>,
    /// Body skin weights.
    pub body_weights: Vec<SkinWeights>,
}

/// How the simulation of one pose ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Index into the description's clips.
    pub clip: usize,
    /// Frame within the clip.
    pub frame: usize,
    /// Why the pose was left out; `None` when it converged.
    pub rejected: Option<String>,
    /// RMS residual force, in mean vertex weights.
    pub residual: f64,
    /// Greatest stretch, principal.
    pub stretch: f64,
    /// Least signed distance to the body, metres.
    pub distance: f64,
    /// Seconds of computing.
    pub seconds: f64,
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

/// A dataset in memory; rejected poses are left out of `samples` and counted.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// Cloth, body, joints.
    pub setup: Setup,
    /// Accepted poses, in the order of clip and frame.
    pub samples: Vec<Sample>,
    /// How many poses were left out.
    pub rejected: usize,
}

/// Which poses of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// The first 90 % of every clip.
    Train,
    /// The last 10 % of every clip in time, unseen during training.
    Test,
}

/// Path of the setup file of dataset `folder`.
fn setup_path(folder: &Path) -> PathBuf {
    folder.join("setup.safetensors")
}

/// Path of one pose of dataset `folder`.
pub fn pose_path(folder: &Path, clip: usize, frame: usize) -> PathBuf {
    folder.join("poses").join(format!("{clip:03}-{frame:05}.safetensors"))
}

/// Reads a whole file.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|source| Error::Io { path: path.to_owned(), source })
}

/// Writes a whole file or nothing: first beside it, then moved into place.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let io = |source| Error::Io { path: path.to_owned(), source };
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(io)?;
    }
    let partial = path.with_extension("partial");
    std::fs::write(&partial, bytes).map_err(io)?;
    std::fs::rename(&partial, path).map_err(io)
}

/// Reads a safetensors file, naming the file in errors.
pub fn tensors(path: &Path) -> Result<Tensors> {
    Tensors::parse(&read(path)?).map_err(|error| Error::File { path: path.to_owned(), reason: error.to_string() })
}

fn json<T: for<'a> Deserialize<'a>>(file: &Tensors, key: &str) -> Result<T> {
    let text = file.metadata.get(key).ok_or_else(|| Error::Dataset(format!("__metadata__ has no key {key}")))?;
    serde_json::from_str(text).map_err(|error| Error::Dataset(format!("__metadata__ {key}: {error}")))
}

fn to_json<T: Serialize>(value: &T) -> Result<String> {
    serde_json::to_string(value).map_err(|error| Error::Dataset(error.to_string()))
}

impl Setup {
    /// Writes the setup of dataset `folder`.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let joints = self.description.joints.len();
        let mut file = Tensors::default();
        file.metadata.insert("setup".to_owned(), to_json(&self.description)?);
        let mut dense = vec![0.0; self.body_weights.len() * joints];
        for (row, weights) in dense.chunks_exact_mut(joints).zip(&self.body_weights) {
            weights.iter().for_each(|(joint, weight)| row[*joint] = *weight as f32);
        }
        let rows = |values: &[f32]| Tensor::f32(&[values.len() / 3, 3], values);
        let triples = |values: &[u32]| Tensor::u32(&[values.len() / 3, 3], values);
        let surface = &self.surface;
        file.tensors.extend([
            ("garment.rest".to_owned(), rows(&self.garment)),
            ("cloth.rest".to_owned(), rows(&self.template)),
            ("cloth.triangles".to_owned(), triples(&self.triangles)),
            ("draw.vertex".to_owned(), Tensor::u32(&[surface.vertex.len()], &surface.vertex)),
            ("draw.uv".to_owned(), Tensor::f32(&[surface.uv.len() / 2, 2], &surface.uv)),
            ("draw.triangles".to_owned(), triples(&surface.triangles)),
            ("body.rest".to_owned(), rows(&self.body)),
            ("body.triangles".to_owned(), triples(&self.body_triangles)),
            ("body.weights".to_owned(), Tensor::f32(&[self.body_weights.len(), joints], &dense)),
        ]);
        write(&setup_path(folder), &file.to_bytes())
    }

    /// Reads the setup of dataset `folder`; `None` when there is none yet.
    pub fn read(folder: &Path) -> Result<Option<Self>> {
        let path = setup_path(folder);
        if !path.exists() {
            return Ok(None);
        }
        let file = tensors(&path)?;
        let named = |error: Error| Error::File { path: path.clone(), reason: error.to_string() };
        Self::from_file(&file).map(Some).map_err(named)
    }

    fn from_file(file: &Tensors) -> Result<Self> {
        let description: Description = json(file, "setup")?;
        let joints = description.joints.len();
        let positions = |name: &str, count| file.f32(name, &[count, Some(3)]);
        let (template, shape) = positions("cloth.rest", None)?;
        let (body, body_shape) = positions("body.rest", None)?;
        let vertex = file.u32("draw.vertex", &[None], shape[0])?;
        let dense = file.f32("body.weights", &[Some(body_shape[0]), Some(joints)])?.0;
        let sparse = |row: &[f32]| -> SkinWeights {
            let used = row.iter().enumerate().filter(|entry| *entry.1 != 0.0);
            used.map(|(joint, weight)| (joint, f64::from(*weight))).collect()
        };
        Ok(Self {
            garment: positions("garment.rest", Some(shape[0]))?.0,
            triangles: file.u32("cloth.triangles", &[None, Some(3)], shape[0])?,
            surface: Surface {
                uv: file.f32("draw.uv", &[Some(vertex.len()), Some(2)])?.0,
                triangles: file.u32("draw.triangles", &[None, Some(3)], vertex.len())?,
                vertex,
            },
            body_triangles: file.u32("body.triangles", &[None, Some(3)], body_shape[0])?,
            body_weights: dense.chunks_exact(joints.max(1)).map(sparse).collect(),
            description,
            template,
            body,
        })
    }

    /// Refuses to go on with a dataset made from something else.
    pub fn check_same(&self, other: &Self, folder: &Path) -> Result<()> {
        let mut expected = other.clone();
        expected.template.clone_from(&self.template);
        if *self == expected {
            return Ok(());
        }
        let reason = "holds another character, garment, rate or material; name another folder, or delete this one";
        Err(Error::File { path: folder.to_owned(), reason: reason.to_owned() })
    }
}

impl Sample {
    /// Writes one pose of dataset `folder`.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let mut file = Tensors::default();
        file.metadata.insert("record".to_owned(), to_json(&self.record)?);
        file.tensors.insert("pose.joints".to_owned(), Tensor::f32(&[self.joints.len() / 12, 3, 4], &self.joints));
        file.tensors.insert("truth.positions".to_owned(), Tensor::f32(&[self.truth.len() / 3, 3], &self.truth));
        write(&pose_path(folder, self.record.clip, self.record.frame), &file.to_bytes())
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

impl Dataset {
    /// Reads a whole dataset.
    pub fn read(folder: &Path) -> Result<Self> {
        let missing = || Error::File {
            path: folder.to_owned(),
            reason: "holds no setup.safetensors; run `ctsn simulate` first".to_owned(),
        };
        let setup = Setup::read(folder)?.ok_or_else(missing)?;
        let poses = folder.join("poses");
        let io = |source| Error::Io { path: poses.clone(), source };
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(&poses).map_err(io)? {
            paths.push(entry.map_err(io)?.path());
        }
        paths.retain(|path| path.extension().is_some_and(|extension| extension == "safetensors"));
        paths.sort();
        let sizes = (setup.description.joints.len(), setup.template.len() / 3);
        let mut samples = Vec::new();
        for path in &paths {
            samples.push(Sample::read(path, sizes.0, sizes.1)?);
        }
        let all = samples.len();
        samples.retain(|sample| sample.record.rejected.is_none());
        let clips = setup.description.clips.len();
        if let Some(sample) = samples.iter().find(|sample| sample.record.clip >= clips) {
            return Err(Error::Dataset(format!("a pose names clip {}, there are {clips}", sample.record.clip)));
        }
        Ok(Self { rejected: all - samples.len(), setup, samples })
    }

    /// The samples of one split: every clip is cut at 90 % of its time.
    pub fn split(&self, split: Split) -> Vec<&Sample> {
        let clips = self.setup.description.clips.len();
        let mut lengths = vec![0; clips];
        self.samples.iter().for_each(|sample| {
            let length = &mut lengths[sample.record.clip];
            *length = (*length).max(sample.record.frame + 1);
        });
        let train = |sample: &&Sample| sample.record.frame * 10 < lengths[sample.record.clip] * 9;
        self.samples.iter().filter(|sample| train(sample) == (split == Split::Train)).collect()
    }
}
