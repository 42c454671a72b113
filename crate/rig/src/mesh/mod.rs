//! The mesh room: triangle meshes, and what all stages ask of them.

mod components;
mod dynamic;
mod edges;
mod manifold;
pub mod triangle;

pub use components::Components;
pub use dynamic::DynamicMesh;
pub use edges::{Edges, Hinge, Side, around, ordered};

use ctsn_core::topology::Graph;
use glam::DVec3;

/// Triangle mesh with one vertex per position (welded), counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, metres.
    pub positions: Vec<DVec3>,
    /// Vertex indices, three per triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Corners of every triangle, metres.
    pub fn corners(&self) -> impl Iterator<Item = [DVec3; 3]> {
        self.triangles.iter().map(|triangle| triangle.map(|i| self.positions[i as usize]))
    }

    /// Surface area, square metres.
    pub fn area(&self) -> f64 {
        self.corners().map(triangle::area).sum()
    }

    /// Least and greatest corner of the bounding box, metres.
    pub fn bounds(&self) -> [DVec3; 2] {
        bounds(self.positions.iter().copied())
    }

    /// Length of the longest side of the bounding box, metres.
    pub fn extent(&self) -> f64 {
        let [low, high] = self.bounds();
        (high - low).max_element()
    }

    /// The neighbours of every vertex along edges, ascending.
    pub fn rings(&self) -> Graph<Vec<u32>> {
        Graph::new(self.positions.len(), self.triangles.as_flattened())
    }

    /// For each vertex the next corner of each triangle around it, in the triangles' order: all its neighbours where it
    /// is on no rim.
    pub fn successors(&self) -> Vec<Vec<u32>> {
        let mut successors = vec![Vec::new(); self.positions.len()];
        let edges = self.triangles.iter().flat_map(|triangle| around(*triangle));
        edges.for_each(|[from, to]| successors[from as usize].push(to));
        successors
    }

    /// Area-weighted vertex normals, unit length; +Y where a vertex has no area around it.
    pub fn normals(&self, positions: &[DVec3]) -> Vec<DVec3> {
        let mut normals = vec![DVec3::ZERO; positions.len()];
        for triangle in &self.triangles {
            let normal = triangle::cross(triangle.map(|i| positions[i as usize]));
            triangle.iter().for_each(|&i| normals[i as usize] += normal);
        }
        normals.iter().map(|normal| normal.try_normalize().unwrap_or(DVec3::Y)).collect()
    }
}

/// Least and greatest corner of the box around points; (∞, -∞) around none.
pub fn bounds(points: impl IntoIterator<Item = DVec3>) -> [DVec3; 2] {
    let grown = |[low, high]: [DVec3; 2], point| [low.min(point), high.max(point)];
    points.into_iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], grown)
}
