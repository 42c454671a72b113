//! What makes a mesh fit for cloth: a manifold with few rims, even edges, no thin triangles, clear of the body.

use ctsn_rig::mesh::triangle::least_angle;
use ctsn_rig::mesh::{Components, Edges, Mesh};
use ctsn_rig::statistics::Sorted;
use std::collections::BTreeSet;

/// Measured quality of a cloth mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// Vertices.
    pub vertices: usize,
    /// Every edge has one or two triangles, of opposite directions, and every vertex one fan of triangles.
    pub manifold: bool,
    /// Connected components.
    pub components: usize,
    /// Boundary loops.
    pub loops: usize,
    /// Euler characteristic V - E + F; 2 - loops for a sphere with holes.
    pub euler: i64,
    /// Mean edge length, metres.
    pub edge: f64,
    /// Edge lengths over their mean: smallest, 5th, 95th percentile, largest.
    pub spread: [f64; 4],
    /// Smallest angle per triangle, degrees: least, 1st, 5th, 50th percentile.
    pub angles: [f64; 4],
}

/// Measures a mesh; all zero for an empty one.
pub fn quality(mesh: &Mesh) -> Quality {
    let edges = Edges::new(&mesh.triangles);
    let used: BTreeSet<u32> = mesh.triangles.iter().flatten().copied().collect();
    let mut rims = Components::new(mesh.positions.len());
    edges.boundary().for_each(|(edge, _)| rims.join(edge.map(|v| v as usize)));
    let loops: BTreeSet<usize> = edges.boundary().map(|([a, _], _)| rims.of(a as usize)).collect();
    let lengths = edges.iter().map(|([a, b], _)| mesh.positions[a as usize].distance(mesh.positions[b as usize]));
    let lengths: Vec<f64> = lengths.collect();
    let mean = lengths.iter().sum::<f64>() / lengths.len().max(1) as f64;
    let lengths = Sorted::new(lengths.iter().map(|length| length / mean));
    let angles = Sorted::new(mesh.corners().map(least_angle));
    Quality {
        vertices: mesh.positions.len(),
        manifold: mesh.is_manifold(&edges),
        components: mesh.components().leaders().filter(|v| used.contains(&(*v as u32))).count(),
        loops: loops.len(),
        euler: used.len() as i64 - edges.count() as i64 + mesh.triangles.len() as i64,
        edge: mean,
        spread: [0, 5, 95, 100].map(|percent| lengths.percentile(percent)),
        angles: [0, 1, 5, 50].map(|percent| angles.percentile(percent)),
    }
}
