//! The node hierarchy: world transform = product of the local ones from the top, T·R·S each. glTF 2.0 §3.5.

use super::Read;
use ::gltf::Document;
use ::gltf::scene::Transform;
use glam::{DAffine3, DMat4, DQuat, DVec3};

/// Translation, rotation and scale of a node, which animations replace one by one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Local {
    pub translation: DVec3,
    pub rotation: DQuat,
    pub scale: DVec3,
}

/// The hierarchy of all nodes of a file. Lengths in file units.
pub(super) struct Nodes {
    /// Parent of each node.
    pub parent: Vec<Option<usize>>,
    /// Nodes, parents before children.
    pub order: Vec<usize>,
    /// Local transform of each node as the file states it; matrices are kept as they are.
    pub rest: Vec<DAffine3>,
    /// The same, decomposed for animation (shear is lost; glTF forbids animating nodes given by a matrix).
    pub local: Vec<Local>,
}

impl Nodes {
    /// Refuses hierarchies that are no forest, and transforms that are not finite.
    pub fn read(document: &Document) -> Read<Nodes> {
        let count = document.nodes().len();
        let mut parent = vec![None; count];
        for node in document.nodes() {
            for child in node.children().map(|child| child.index()) {
                if let Some(other) = parent[child].replace(node.index()) {
                    return Err(format!("node {child} has two parents, {other} and {}", node.index()));
                }
            }
        }
        let order = depth_first(document, &parent);
        if order.len() < count {
            return Err("its nodes form a circle: wanted every node below a top node".to_string());
        }
        let mut nodes = Nodes { parent, order, rest: Vec::new(), local: Vec::new() };
        for node in document.nodes() {
            let (rest, local) = transform(node.transform());
            if !rest.is_finite() {
                return Err(format!("node {} ({:?}): its transform is not finite", node.index(), node.name()));
            }
            nodes.rest.push(rest);
            nodes.local.push(local);
        }
        Ok(nodes)
    }

    /// World transforms from local ones. [nodes] -> [nodes]
    pub fn worlds(&self, local: &[DAffine3]) -> Vec<DAffine3> {
        let mut world = local.to_vec();
        for &node in &self.order {
            if let Some(parent) = self.parent[node] {
                world[node] = world[parent] * local[node];
            }
        }
        world
    }

    /// The node's ancestors, nearest first.
    pub fn ancestors(&self, node: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(self.parent[node], |&above| self.parent[above])
    }
}

impl Local {
    /// T · R · S.
    pub fn affine(&self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

/// Affine part of a column-major 4×4 matrix.
pub(super) fn affine(columns: [f64; 16]) -> DAffine3 {
    DAffine3::from_mat4(DMat4::from_cols_array(&columns))
}

/// Unit quaternion x, y, z, w; the identity where it has no length.
pub(super) fn unit_rotation(xyzw: [f64; 4]) -> DQuat {
    let quaternion = DQuat::from_array(xyzw);
    let length = quaternion.length();
    if length.is_normal() { quaternion / length } else { DQuat::IDENTITY }
}

fn depth_first(document: &Document, parent: &[Option<usize>]) -> Vec<usize> {
    let children: Vec<Vec<usize>> =
        document.nodes().map(|node| node.children().map(|child| child.index()).collect()).collect();
    let mut order = Vec::with_capacity(parent.len());
    let mut stack: Vec<usize> = (0..parent.len()).rev().filter(|&node| parent[node].is_none()).collect();
    while let Some(node) = stack.pop() {
        order.push(node);
        stack.extend(children[node].iter().rev());
    }
    order
}

fn transform(transform: Transform) -> (DAffine3, Local) {
    match transform {
        Transform::Matrix { matrix } => {
            let rest = affine(DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from))).to_cols_array());
            let (scale, rotation, translation) = rest.to_scale_rotation_translation();
            (rest, Local { translation, rotation: unit_rotation(rotation.to_array()), scale })
        }
        Transform::Decomposed { translation, rotation, scale } => {
            let local = Local {
                translation: DVec3::from(translation.map(f64::from)),
                rotation: unit_rotation(rotation.map(f64::from)),
                scale: DVec3::from(scale.map(f64::from)),
            };
            (local.affine(), local)
        }
    }
}
