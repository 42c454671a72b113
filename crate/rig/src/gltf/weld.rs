//! One vertex per position: vertices that were split for drawing (seams in normals or UVs) become one for simulation.

use crate::mesh::bounds;
use crate::{Mesh, SkinWeights, Surface};
use glam::{DVec2, DVec3, I64Vec3};
use std::collections::HashMap;

/// Vertices closer than this share of the largest extent are one. Rounding to f32 moves copies apart by 1e-7 of it.
const SAME_POSITION: f64 = 1e-6;
/// Copies of a vertex stay apart where their weights differ by more than this (sum of absolute differences, at most 2):
/// closed lips, touching fingers.
const SAME_WEIGHTS: f64 = 0.25;

/// Triangles with split vertices, gathered from the parts of a file.
#[derive(Default)]
pub(super) struct Soup {
    /// [v] metres.
    pub positions: Vec<DVec3>,
    /// [v]; an empty list where a vertex has no weights.
    pub weights: Vec<SkinWeights>,
    /// [v]; zero where a part has none, and fewer where the last have none.
    pub uv: Vec<DVec2>,
    /// [v] whether springs hold the vertex to the body; empty in a part without pins.
    pub pinned: Vec<bool>,
    /// Three vertices per triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Linear RGB per vertex. [v]
    pub colour: Vec<[f32; 3]>,
    /// Whether cloth passes through it, as through hair.
    pub is_loose: bool,
    /// [t] that of the part each triangle is of.
    pub loose: Vec<bool>,
    /// [v] number of each vertex in the file, counted through its parts.
    pub numbers: Vec<u32>,
    /// Numbers of vertices that no triangle uses.
    pub unused: Vec<u32>,
}

/// A welded mesh, its weights, and the surface that draws it.
pub(super) struct Welded {
    /// Without degenerate triangles, and those that cloth passes through.
    pub mesh: Mesh,
    /// [mesh vertices]
    pub weights: Vec<SkinWeights>,
    /// With all triangles, degenerate ones too.
    pub surface: Surface,
    /// Mesh vertices of which a copy is pinned, ascending.
    pub pins: Vec<u32>,
    /// Where its vertices came from.
    pub source: Source,
}

/// How a mesh's vertices are numbered in its file (counted from 0 through all its parts), and what was left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Source {
    /// Vertex of the file (the first of its copies) per vertex of the mesh.
    pub numbers: Vec<u32>,
    /// Vertices of the file that no triangle uses.
    pub unused: Vec<u32>,
    /// Triangles without an area, by vertices of the file.
    pub degenerate: Vec<[u32; 3]>,
    /// Whether the file is one that [`write_garment`](super::write_garment) wrote.
    pub own: bool,
}

impl Soup {
    /// Adds a part without the vertices that no triangle uses. The indices of its triangles count from its first
    /// vertex; `turn` reverses them.
    pub fn add(&mut self, part: Soup, turn: bool) {
        let first = (self.numbers.len() + self.unused.len()) as u32;
        let mut place: Vec<Option<u32>> = vec![None; part.positions.len()];
        for triangle in &part.triangles {
            let mut corners = triangle.map(|corner| {
                let old = corner as usize;
                *place[old].get_or_insert_with(|| {
                    self.positions.push(part.positions[old]);
                    self.weights.push(part.weights.get(old).cloned().unwrap_or_default());
                    if let Some(uv) = part.uv.get(old) {
                        // The vertices before may be of a part without.
                        self.uv.resize(self.positions.len() - 1, DVec2::ZERO);
                        self.uv.push(*uv);
                    }
                    self.colour.extend(part.colour.get(old));
                    self.pinned.push(part.pinned.get(old).copied().unwrap_or_default());
                    self.numbers.push(first + corner);
                    self.positions.len() as u32 - 1
                })
            });
            if turn {
                corners.swap(1, 2);
            }
            self.triangles.push(corners);
            self.loose.push(part.is_loose);
        }
        self.unused.extend((first..).zip(&place).filter(|(_, place)| place.is_none()).map(|(number, _)| number));
    }

    /// Largest side of the bounding box, metres.
    pub fn extent(&self) -> f64 {
        let [low, high] = bounds(self.positions.iter().copied());
        if self.positions.is_empty() { 0.0 } else { (high - low).max_element() }
    }

    /// Welds. A welded vertex has the position and weights of the first of its copies.
    pub fn weld(self) -> Welded {
        let cell = (self.extent() * SAME_POSITION).max(f64::MIN_POSITIVE);
        let mut kept: Vec<usize> = Vec::new();
        let mut grid: HashMap<I64Vec3, Vec<u32>> = HashMap::new();
        let mut vertex = Vec::with_capacity(self.positions.len());
        for (at, &position) in self.positions.iter().enumerate() {
            let centre = (position / cell).floor().as_i64vec3();
            let near =
                (0..27).filter_map(|i| grid.get(&centre.saturating_add(I64Vec3::new(i % 3, i / 3 % 3, i / 9) - 1)));
            let same = near.flatten().copied().find(|&candidate| {
                let other = kept[candidate as usize];
                self.positions[other].distance(position) <= cell
                    && difference(&self.weights[other], &self.weights[at]) <= SAME_WEIGHTS
            });
            vertex.push(same.unwrap_or_else(|| {
                let new = kept.len() as u32;
                kept.push(at);
                grid.entry(centre).or_default().push(new);
                new
            }));
        }
        let positions: Vec<DVec3> = kept.iter().map(|&at| self.positions[at]).collect();
        let mut triangles: Vec<[u32; 3]> =
            self.triangles.iter().map(|t| t.map(|corner| vertex[corner as usize])).collect();
        let flat = |(triangle, _): &(&[u32; 3], &[u32; 3])| degenerate(**triangle, &positions, cell);
        let flat = triangles.iter().zip(&self.triangles).filter(flat);
        let flat = flat.map(|(_, drawn)| drawn.map(|corner| self.numbers[corner as usize])).collect();
        // A body of hair alone is a body.
        let all = self.loose.iter().all(|loose| *loose);
        let mut loose = self.loose.iter().map(|loose| *loose && !all);
        triangles.retain(|&triangle| !loose.next().unwrap_or_default() && !degenerate(triangle, &positions, cell));
        let mut pins: Vec<u32> = (0..vertex.len()).filter(|&at| self.pinned[at]).map(|at| vertex[at]).collect();
        pins.sort_unstable();
        pins.dedup();
        let numbers = kept.iter().map(|&at| self.numbers[at]).collect();
        let mut uv = self.uv;
        if !uv.is_empty() {
            uv.resize(self.positions.len(), DVec2::ZERO);
        }
        Welded {
            mesh: Mesh { positions, triangles },
            weights: kept.iter().map(|&at| self.weights[at].clone()).collect(),
            surface: Surface { vertex, uv, triangles: self.triangles, colour: self.colour },
            pins,
            source: Source { numbers, unused: self.unused, degenerate: flat, own: false },
        }
    }
}

/// Whether two corners are one vertex, or twice the area is at most `cell` squared.
fn degenerate([a, b, c]: [u32; 3], positions: &[DVec3], cell: f64) -> bool {
    let [p, q, r] = [a, b, c].map(|corner| positions[corner as usize]);
    a == b || b == c || c == a || (q - p).cross(r - p).length() <= cell * cell
}

/// Sum of absolute differences of two lists of weights, 0 to 2.
fn difference(a: &SkinWeights, b: &SkinWeights) -> f64 {
    let weight = |list: &SkinWeights, joint| list.iter().find(|entry| entry.0 == joint).map_or(0.0, |entry| entry.1);
    let of_a: f64 = a.iter().map(|&(joint, value)| (value - weight(b, joint)).abs()).sum();
    let only_b: f64 = b.iter().filter(|entry| weight(a, entry.0) == 0.0).map(|entry| entry.1).sum();
    of_a + only_b
}
