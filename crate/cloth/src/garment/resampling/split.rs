//! The drawn mesh, no coarser than the cloth under it: where its edges are longer, the folds of the cloth would not be
//! seen. Longest edges are halved until none is too long; the artist's vertices and seams stay.

use ctsn_rig::mesh::{Edges, Side, ordered};
use ctsn_rig::{Garment, Mesh, Surface};
use std::collections::BTreeMap;

/// A mesh of which edges were halved, and the ends of the edge that each new vertex halves, in the order of the
/// vertices: those that were there before come first.
pub(super) struct Split {
    pub mesh: Mesh,
    pub surface: Surface,
    pub parents: Vec<[u32; 2]>,
    /// The face of the mesh before that each face is of.
    pub faces: Vec<usize>,
}

impl Split {
    /// Of a garment whose surface has a triangle for each of its mesh, until no edge is longer than `longest`, metres.
    pub fn new(garment: &Garment, longest: f64) -> Self {
        let (mesh, surface) = (garment.mesh.clone(), garment.surface.clone());
        let mut split = Self { faces: (0..mesh.triangles.len()).collect(), mesh, surface, parents: Vec::new() };
        while split.halve(longest) {}
        split
    }

    /// Halves every edge longer than `longest` that is the longest of all its faces; whether there was any.
    fn halve(&mut self, longest: f64) -> bool {
        let edges = Edges::new(&self.mesh.triangles);
        let length = |[a, b]: [u32; 2]| self.mesh.positions[a as usize].distance(self.mesh.positions[b as usize]);
        // Of equally long ones the same everywhere, so that a face has one alone.
        let before = |a: [u32; 2], b: [u32; 2]| length(a).total_cmp(&length(b)).then(a.cmp(&b)).is_lt();
        let most = |face: usize| {
            let [a, b, c] = self.mesh.triangles[face];
            let sides = [[a, b], [b, c], [c, a]].map(ordered);
            sides.into_iter().reduce(|one, two| if before(one, two) { two } else { one })
        };
        let long = |(edge, _): &([u32; 2], &[_])| length(*edge) > longest;
        let chosen =
            edges.iter().filter(long).filter(|(edge, sides)| sides.iter().all(|s| most(s.triangle) == Some(*edge)));
        let corners = |sides: &[Side]| sides.iter().map(|side| (side.triangle, side.corner)).collect::<Vec<_>>();
        let chosen: Vec<_> = chosen.map(|(edge, sides)| (edge, corners(sides))).collect();
        for (edge, sides) in &chosen {
            let [a, b] = edge.map(|v| self.mesh.positions[v as usize]);
            self.mesh.positions.push(0.5 * (a + b));
            self.parents.push(*edge);
            let middle = self.mesh.positions.len() as u32 - 1;
            let mut drawn = BTreeMap::new();
            sides.iter().for_each(|&(face, corner)| self.cut(face, corner, middle, &mut drawn));
        }
        !chosen.is_empty()
    }

    /// Cuts a face in two from the middle of the edge that begins at `corner`; `drawn`: drawn vertices there by the
    /// drawn ends of the edge.
    fn cut(&mut self, face: usize, corner: usize, middle: u32, drawn: &mut BTreeMap<[u32; 2], u32>) {
        let next = (corner + 1) % 3;
        let old = self.surface.triangles[face];
        let surface = &mut self.surface;
        let seam = *drawn.entry(ordered([old[corner], old[next]])).or_insert_with(|| {
            let [a, b] = [old[corner] as usize, old[next] as usize];
            surface.vertex.push(middle);
            if !surface.uv.is_empty() {
                surface.uv.push(0.5 * (surface.uv[a] + surface.uv[b]));
            }
            if !surface.colour.is_empty() {
                let [one, two] = [surface.colour[a], surface.colour[b]];
                surface.colour.push([0, 1, 2].map(|c| 0.5 * (one[c] + two[c])));
            }
            surface.vertex.len() as u32 - 1
        });
        let with = |mut corners: [u32; 3], at: usize, vertex: u32| {
            corners[at] = vertex;
            corners
        };
        let welded = self.mesh.triangles[face];
        self.mesh.triangles[face] = with(welded, next, middle);
        self.mesh.triangles.push(with(welded, corner, middle));
        self.surface.triangles[face] = with(old, next, seam);
        self.surface.triangles.push(with(old, corner, seam));
        self.faces.push(self.faces[face]);
    }
}
