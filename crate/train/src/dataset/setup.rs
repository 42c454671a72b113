//! What the poses of a dataset have in common: cloth, body and joints, and what the simulation was told.
//! `setup.safetensors`.

use super::{Drawn, json, to_json};
use crate::{Error, Result};
use ctsn_cloth::simulate::{Fabric, Settings};
use ctsn_core::file::{Tensor, Tensors};
use ctsn_core::model::Surface;
use ctsn_rig::file::{tensors, write};
use ctsn_rig::{Character, Joint, Mesh, SkinWeights, SkinnedMesh};
use serde::{Deserialize, Serialize};
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
    /// Frames per clip.
    pub frames: Vec<usize>,
    /// Joint names.
    pub joints: Vec<String>,
    /// Index of each joint's parent, which stands before it; empty where joints have none.
    pub parents: Vec<Option<usize>>,
    /// Index of the hip.
    pub root: usize,
    /// `B_j⁻¹`, row-major 3×4.
    pub inverse_bind: Vec<Vec<f32>>,
    /// What the cloth is made of.
    pub material: Fabric,
    /// The simulator's numerical settings: another path is another truth.
    pub settings: Settings,
    /// Digest of the model whose predictions the poses were relaxed from; none where they came along a path.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub teacher: Option<String>,
}

/// Everything about a dataset but its poses.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Names and joints.
    pub description: Description,
    /// The garment as it was cut, before it was draped: without strain [n, 3].
    pub garment: Vec<f32>,
    /// `T_C`: the garment draped on the canonical body, stretched by its weight [n, 3].
    pub template: Vec<f32>,
    /// Cloth triangles [t, 3].
    pub triangles: Vec<u32>,
    /// What is drawn of the cloth.
    pub surface: Surface,
    /// What is drawn in its place and rides on it.
    pub drawn: Option<Drawn>,
    /// Body vertices in the canonical pose [b, 3].
    pub body: Vec<f32>,
    /// Body triangles.
    pub body_triangles: Vec<u32>,
    /// Body skin weights.
    pub body_weights: Vec<SkinWeights>,
}

/// Path of the setup file of dataset `folder`.
fn setup_path(folder: &Path) -> PathBuf {
    folder.join("setup.safetensors")
}

impl Setup {
    /// The garment at rest on the canonical body.
    pub fn cloth(&self) -> Mesh {
        Mesh { positions: ctsn_rig::vertices(&self.template), triangles: self.triangles.as_chunks::<3>().0.to_vec() }
    }

    /// Writes the setup of dataset `folder`.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let joints = self.description.joints.len();
        let mut file = Tensors::default();
        file.metadata.insert("setup".to_owned(), to_json(&self.description)?);
        let mut dense = vec![0.0; self.body_weights.len() * joints];
        for (row, weights) in dense.chunks_exact_mut(joints.max(1)).zip(&self.body_weights) {
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
        if let Some(drawn) = &self.drawn {
            drawn.write(&mut file);
        }
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
        let description: serde_json::Value = json(file, "setup")?;
        if description["material"].is_string() {
            let how = "delete it, and run the same `ctsn simulate` again: the poses are kept";
            return Err(Error::Dataset(format!("is of an older version, which kept the fabric as text; {how}")));
        }
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
            drawn: Drawn::read(file, shape[0])?,
            body_triangles: file.u32("body.triangles", &[None, Some(3)], body_shape[0])?,
            body_weights: dense.chunks_exact(joints.max(1)).map(sparse).collect(),
            description,
            template,
            body,
        })
    }

    /// The body and its joints, without clips.
    pub fn character(&self) -> Result<Character> {
        let Description { joints, inverse_bind, parents, root, .. } = &self.description;
        let joint = |(index, (name, bind)): (usize, (&String, &Vec<f32>))| {
            let inverse_bind = ctsn_rig::affine(bind.as_slice().try_into().ok()?);
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
            body: SkinnedMesh {
                mesh: Mesh {
                    positions: ctsn_rig::vertices(&self.body),
                    triangles: self.body_triangles.as_chunks::<3>().0.to_vec(),
                },
                weights: self.body_weights.clone(),
            },
            surface: Default::default(),
            clips: Vec::new(),
            metres_per_unit: 1.0,
            parts: Default::default(),
        })
    }
}
