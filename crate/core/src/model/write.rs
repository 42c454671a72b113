//! Model -> model file, the inverse of `read.rs`. network.md §8.

use super::read::{Description, transpose};
use super::{CLOTH_WEIGHTS, HostModel, Linear, MESH_BASIS, SKELETON_BASIS, surroundings};
use crate::file::{Tensor, Tensors};
use crate::pose::Frame;
use miniserde::json;

/// A model's file: the mesh stream's tensors stand last, and `__metadata__["coarse"]` says where they begin, so that a
/// page can show the coarse cloth before they are there.
pub fn file_bytes(mut file: Tensors) -> Vec<u8> {
    let folds = |name: &str| ["graph.", "vertex.", "mesh."].iter().any(|prefix| name.starts_with(prefix));
    let coarse = file.tensors.iter().filter(|(name, _)| !folds(name)).map(|(_, tensor)| tensor.bytes.len());
    let coarse = coarse.sum::<usize>().to_string();
    file.metadata.insert("coarse".to_owned(), coarse);
    file.to_bytes_with_last(folds)
}

/// How learned tensors are stored; everything else stays F32 or, where it counts or names vertices, whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// 32-bit floats.
    F32,
    /// 16-bit floats: half the bytes.
    F16,
}

pub(super) struct Writer {
    file: Tensors<'static>,
    storage: Storage,
}

impl Writer {
    pub(super) fn fixed(&mut self, name: &str, shape: &[usize], values: &[f32]) {
        self.file.tensors.insert(name.to_owned(), Tensor::f32(shape, values));
    }

    fn learned(&mut self, name: &str, shape: &[usize], values: &[f32]) {
        let tensor = match self.storage {
            Storage::F32 => Tensor::f32(shape, values),
            Storage::F16 => Tensor::f16(shape, values),
        };
        self.file.tensors.insert(name.to_owned(), tensor);
    }

    pub(super) fn indices(&mut self, name: &str, shape: &[usize], values: &[u32]) {
        self.file.tensors.insert(name.to_owned(), Tensor::u32(shape, values));
    }

    fn linear(&mut self, name: &str, layer: &Linear<Vec<f32>>) {
        let weight = transpose(&layer.weight, layer.inputs, layer.outputs);
        self.learned(&format!("{name}.weight"), &[layer.outputs, layer.inputs], &weight);
        self.learned(&format!("{name}.bias"), &[layer.outputs], &layer.bias);
    }
}

impl HostModel {
    /// The model file's bytes.
    pub fn to_bytes(&self, storage: Storage) -> Vec<u8> {
        let mut writer = Writer { file: Tensors::default(), storage };
        writer.file.metadata.insert("ctsn".to_owned(), self.description());
        if let Some(training) = &self.training {
            writer.file.metadata.insert("training".to_owned(), training.clone());
        }
        self.write_cloth(&mut writer);
        self.write_reference(&mut writer);
        self.write_network(&mut writer);
        if let Some(ride) = &self.ride {
            ride.write(&mut writer);
        }
        if let Some(cut) = &self.cut {
            cut.write(&mut writer);
        }
        if let Some(body) = &self.body {
            body.write(self.sizes.vertices, &mut writer);
        }
        file_bytes(writer.file)
    }

    fn description(&self) -> String {
        json::to_string(&Description {
            version: 1,
            frame: match self.rig.frame {
                Frame::HipYaw => "hip_yaw".to_owned(),
                Frame::Hip => "hip".to_owned(),
            },
            root: self.rig.root,
            joints: self.rig.joints.clone(),
            inverse_bind: self.rig.inverse_bind.iter().map(|transform| transform.to_vec()).collect(),
            heads: self.sizes.heads,
            edge_scale: self.reference.edge_scale,
            polish: self.cut.as_ref().map(|cut| cut.steps as u32),
        })
    }

    fn write_cloth(&self, writer: &mut Writer) {
        let (n, joints) = (self.sizes.vertices, self.sizes.joints);
        writer.fixed("cloth.rest", &[n, 3], &self.rest);
        writer.indices("cloth.triangles", &[self.triangles.len() / 3, 3], &self.triangles);
        writer.learned(CLOTH_WEIGHTS, &[n, joints], &self.skinning.to_dense(joints));
        if let Some(surface) = &self.surface {
            writer.indices("draw.vertex", &[surface.vertex.len()], &surface.vertex);
            writer.fixed("draw.uv", &[surface.vertex.len(), 2], &surface.uv);
            writer.indices("draw.triangles", &[surface.triangles.len() / 3, 3], &surface.triangles);
        }
        writer.fixed("pose.mean", &[12 * joints], &self.rig.mean);
        writer.fixed("pose.std", &[12 * joints], &self.rig.std);
        if let Some(range) = &self.rig.range {
            writer.fixed("pose.min", &[12 * joints], &range.min);
            writer.fixed("pose.max", &[12 * joints], &range.max);
        }
    }

    /// The gathered reference vertices, each distinct one once.
    fn write_reference(&self, writer: &mut Writer) {
        let (joints, reference) = (self.sizes.joints, &self.reference);
        let dense = reference.skinning.to_dense(joints);
        let mut rows = std::collections::BTreeMap::new();
        let (mut rest, mut weights, mut index) = (Vec::new(), Vec::new(), Vec::new());
        for (position, row) in reference.rest.chunks_exact(3).zip(dense.chunks_exact(joints)) {
            let bits = |value: &f32| value.to_bits();
            let key: Vec<u32> = position.iter().chain(row).map(bits).collect();
            let next = rows.len() as u32;
            let place = *rows.entry(key).or_insert(next);
            if place == next {
                rest.extend_from_slice(position);
                weights.extend_from_slice(row);
            }
            index.push(place);
        }
        writer.fixed("reference.rest", &[rows.len(), 3], &rest);
        writer.fixed("reference.weights", &[rows.len(), joints], &weights);
        writer.indices("reference.index", &[index.len()], &index);
        writer.fixed("reference.mean", &[3], &reference.mean);
        writer.fixed("reference.std", &[3], &reference.std);
        if let Some(around) = &self.surroundings {
            surroundings::write(around, writer);
        }
    }

    fn write_network(&self, writer: &mut Writer) {
        let sizes = self.sizes;
        let (n, features) = (sizes.vertices, sizes.features);
        for (name, basis, count) in
            [(SKELETON_BASIS, &self.skeleton_basis, sizes.embedding), (MESH_BASIS, &self.mesh_basis, sizes.basis)]
        {
            writer.learned(name, &[count, n, 3], &transpose(basis, n * 3, count));
        }
        for (name, layers) in [("embedding", &self.embedding), ("vertex", &self.vertex_mlp)] {
            layers.iter().enumerate().for_each(|(i, layer)| writer.linear(&format!("{name}.{i}"), layer));
        }
        for (l, layer) in self.layers.iter().enumerate() {
            for (part, name) in ["query", "key", "value", "skip"].iter().enumerate() {
                let columns = |row: &[f32]| row[part * features..][..features].to_vec();
                let stacked = layer.project.weight.chunks_exact(4 * features);
                let weight = stacked.flat_map(columns).collect();
                let linear = Linear {
                    weight,
                    bias: columns(&layer.project.bias),
                    inputs: layer.project.inputs,
                    outputs: features,
                };
                writer.linear(&format!("graph.{l}.{name}"), &linear);
            }
            writer.learned(&format!("graph.{l}.edge.weight"), &[features, 6], &transpose(&layer.edge, 6, features));
            writer.learned(&format!("graph.{l}.gate.weight"), &[3 * features], &layer.gate);
            writer.learned(&format!("graph.{l}.norm.weight"), &[features], &layer.norm_weight);
            writer.learned(&format!("graph.{l}.norm.bias"), &[features], &layer.norm_bias);
        }
    }
}
