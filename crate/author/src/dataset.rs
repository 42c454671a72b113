//! Simulated truth on disk: a folder with `setup.safetensors` (cloth, body, joints) and one file per pose under `poses/`.
//! One file per pose, written whole or not at all, makes the simulation resumable and lets shards merge by copying.

mod same;
mod sample;
mod split;

use crate::rig::{self, Character, Joint, Mesh, SkinWeights, Surface as Drawn, is_obstacle, strongest};
use crate::{Error, Result};
use ctsn_core::file::{Tensor, Tensors};
use ctsn_core::model::Surface;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
pub use same::{digest, fingerprint};
pub(crate) use sample::paths;
pub use sample::{Record, Sample, mixed_path, pose_path, twin_path};
use serde::{Deserialize, Serialize};
pub use split::Split;
use std::path::{Path, PathBuf};

/// What the poses of a dataset have in common, besides the meshes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// Character file name.
    pub character: String,
    /// Garment file name.
    pub garment: String,
    /// Poses per second at which the clips were sampled.
    pub rate: f64,
    /// Clip names; poses name their clip by index.
    pub clips: Vec<String>,
    /// Frames per clip; empty in a dataset of an older version.
    #[serde(default)]
    pub frames: Vec<usize>,
    /// Joint names.
    pub joints: Vec<String>,
    /// Index of each joint's parent, which stands before it; empty in a dataset of an older version, whose joints have none.
    #[serde(default)]
    pub parents: Vec<Option<usize>>,
    /// Index of the hip.
    pub root: usize,
    /// `B_j⁻¹`, row-major 3×4.
    pub inverse_bind: Vec<Vec<f32>>,
    /// Name and constants of the material.
    pub material: String,
    /// The simulator's numerical settings: another path is another truth.
    #[serde(default)]
    pub settings: String,
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
}

/// Path of the setup file of dataset `folder`.
fn setup_path(folder: &Path) -> PathBuf {
    folder.join("setup.safetensors")
}

/// Reads a whole file.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|source| Error::Io { path: path.to_owned(), source })
}

/// Writes a whole file or nothing: first beside it, under a name that no other process uses, then moved into place.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let io = |source| Error::Io { path: path.to_owned(), source };
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(io)?;
    }
    let partial = path.with_extension(format!("partial-{}", std::process::id()));
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
    /// The garment at rest on the canonical body.
    pub fn cloth(&self) -> Mesh {
        Mesh { positions: rig::vertices(&self.template), triangles: self.triangles.as_chunks::<3>().0.to_vec() }
    }

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

    /// Reads the setup of a dataset `folder` that must be one.
    pub fn existing(folder: &Path) -> Result<Self> {
        let reason = "holds no setup.safetensors; run `ctsn simulate` first";
        Self::read(folder)?.ok_or_else(|| Error::File { path: folder.to_owned(), reason: reason.to_owned() })
    }

    fn from_file(file: &Tensors) -> Result<Self> {
        let description: Description = json(file, "setup")?;
        let (joints, parents) = (description.joints.len(), description.parents.len());
        if ![0, joints].contains(&parents) {
            return Err(Error::Dataset(format!("wanted a parent for each of {joints} joints, found {parents}")));
        }
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

    /// Index of the body vertex nearest to each cloth vertex [n], the reference of the mesh stream. network.md §3.
    pub fn reference(&self) -> Result<Vec<usize>> {
        self.nearest_among((0..self.body.len() / 3).collect())
    }

    /// The same without obstacles, which cloth hangs before, but not on: its skin weights are `W_C^I`. network.md §4.
    pub fn nearest(&self) -> Result<Vec<usize>> {
        let joints = &self.description.joints;
        let of_figure = |i: &usize| joints.get(strongest(&self.body_weights[*i])).is_none_or(|name| !is_obstacle(name));
        let figure: Vec<usize> = (0..self.body_weights.len()).filter(of_figure).collect();
        if figure.is_empty() { self.reference() } else { self.nearest_among(figure) }
    }

    fn nearest_among(&self, body: Vec<usize>) -> Result<Vec<usize>> {
        let place = |i: &usize| -> [f32; 3] { std::array::from_fn(|c| self.body[3 * i + c]) };
        let places: Vec<[f32; 3]> = body.iter().map(place).collect();
        let tree: ImmutableKdTree<f32, 3> = ImmutableKdTree::new_from_slice(&places)
            .map_err(|error| Error::Dataset(format!("body vertices: {error}")))?;
        let query =
            |vertex: &[f32; 3]| tree.query(vertex).nearest_one::<SquaredEuclidean<f32>>().execute().item as usize;
        Ok(self.template.as_chunks::<3>().0.iter().map(|vertex| body[query(vertex)]).collect())
    }

    /// The body and its joints, without clips.
    pub fn character(&self) -> Result<Character> {
        let Description { joints, inverse_bind, parents, root, .. } = &self.description;
        let joint = |(index, (name, bind)): (usize, (&String, &Vec<f32>))| {
            let inverse_bind = rig::affine(bind.as_slice().try_into().ok()?);
            let parent = parents.get(index).copied().flatten();
            parent.is_none_or(|parent| parent < index).then(|| Joint { name: name.clone(), parent, inverse_bind })
        };
        let found: Option<Vec<Joint>> = joints.iter().zip(inverse_bind).enumerate().map(joint).collect();
        let wrong = || {
            let wanted = "inverse binds of 12 numbers, parents before their children, and a root among them";
            Error::Dataset(format!("wanted {} {wanted}", joints.len()))
        };
        Ok(Character {
            joints: found.filter(|list| list.len() == joints.len() && *root < list.len()).ok_or_else(wrong)?,
            root: *root,
            body: Mesh {
                positions: rig::vertices(&self.body),
                triangles: self.body_triangles.as_chunks::<3>().0.to_vec(),
            },
            weights: self.body_weights.clone(),
            surface: Drawn::default(),
            clips: Vec::new(),
            metres_per_unit: 1.0,
        })
    }
}

impl Dataset {
    /// A dataset of frames that were all kept.
    pub fn new(setup: Setup, samples: Vec<Sample>) -> Self {
        Self { setup, samples, rejected: Vec::new(), mixed: Vec::new(), mixed_rejected: Vec::new() }
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
        let clips = setup.description.clips.len();
        if let Some(record) = samples.iter().map(|sample| &sample.record).chain(&rejected).find(|r| r.clip >= clips) {
            return Err(Error::Dataset(format!("a pose names clip {}, there are {clips}", record.clip)));
        }
        Ok(Self { rejected, setup, samples, mixed_rejected, mixed })
    }
}
