//! A garment under repair: each face with the vertices of the cloth and those that are drawn.

use ctsn_rig::gltf::Source;
use ctsn_rig::{Garment, Mesh, Surface};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// A triangle: vertices of the cloth, and of the surface that draws it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Face {
    pub corners: [u32; 3],
    pub drawn: [u32; 3],
}

pub(super) struct Patch {
    pub positions: Vec<DVec3>,
    /// Number in the file, per vertex.
    pub numbers: Vec<u32>,
    pub pinned: Vec<bool>,
    pub faces: Vec<Face>,
}

impl Patch {
    pub fn new(garment: &Garment, source: &Source) -> Patch {
        let Garment { mesh, surface, pins, .. } = garment;
        // The mesh has the surface's triangles in their order, without those that have no area.
        let mut drawn = surface.triangles.iter();
        let vertex = |drawn: &[u32; 3]| drawn.map(|corner| surface.vertex[corner as usize]);
        let face = |corners: &[u32; 3]| {
            let drawn = drawn.find(|drawn| vertex(drawn) == *corners).copied();
            Face { corners: *corners, drawn: drawn.unwrap_or(*corners) }
        };
        let faces = mesh.triangles.iter().map(face).collect();
        let pinned = (0..mesh.positions.len() as u32).map(|vertex| pins.binary_search(&vertex).is_ok()).collect();
        Patch { positions: mesh.positions.clone(), numbers: source.numbers.clone(), pinned, faces }
    }

    pub fn triangles(&self) -> Vec<[u32; 3]> {
        self.faces.iter().map(|face| face.corners).collect()
    }

    pub fn corners(&self, face: usize) -> [DVec3; 3] {
        self.faces[face].corners.map(|vertex| self.positions[vertex as usize])
    }

    /// A face by the vertices of the file.
    pub fn name(&self, face: usize) -> String {
        let [a, b, c] = self.faces[face].corners.map(|vertex| self.numbers[vertex as usize]);
        format!("{a}-{b}-{c}")
    }

    /// Another vertex at the place of one.
    pub fn copy(&mut self, vertex: u32) -> u32 {
        let at = vertex as usize;
        self.positions.push(self.positions[at]);
        self.numbers.push(self.numbers[at]);
        self.pinned.push(self.pinned[at]);
        self.positions.len() as u32 - 1
    }

    /// Keeps the faces that `wanted` names.
    pub fn retain(&mut self, wanted: impl Fn(usize) -> bool) {
        let mut index = 0;
        self.faces.retain(|_| {
            index += 1;
            wanted(index - 1)
        });
    }

    /// The garment of what is left, and the numbers of its vertices in the file.
    pub fn finish(self, before: &Garment) -> (Garment, Vec<u32>) {
        let used: BTreeSet<u32> = self.faces.iter().flat_map(|face| face.corners).collect();
        let used: Vec<u32> = used.into_iter().collect();
        let new: BTreeMap<u32, u32> = used.iter().enumerate().map(|(new, old)| (*old, new as u32)).collect();
        let pick = |vertex: &u32| self.positions[*vertex as usize];
        let triangles = self.faces.iter().map(|face| face.corners.map(|vertex| new[&vertex])).collect();
        let mesh = Mesh { positions: used.iter().map(pick).collect(), triangles };
        let surface =
            if before.surface.vertex.is_empty() { Surface::default() } else { self.draw(&before.surface, &new) };
        let pins = (0..used.len() as u32).filter(|vertex| self.pinned[used[*vertex as usize] as usize]).collect();
        let drawn = before.drawn.clone().map(|mut drawn| {
            // What rode on a vertex that is gone rides on the nearest one that is left.
            let near = |place: DVec3| {
                let far = |v: &u32| self.positions[*v as usize].distance_squared(place);
                used.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b))).map_or(0, |old| new[&old])
            };
            let now = |old: u32| new.get(&old).copied().unwrap_or_else(|| near(before.mesh.positions[old as usize]));
            drawn.riders.iter_mut().for_each(|rider| rider.corners = rider.corners.map(now));
            drawn
        });
        let numbers = used.iter().map(|vertex| self.numbers[*vertex as usize]).collect();
        (Garment { mesh, surface, pins, drawn }, numbers)
    }

    /// The surface that draws the faces: a drawn vertex for each pair of an old one and a vertex of the cloth.
    fn draw(&self, before: &Surface, new: &BTreeMap<u32, u32>) -> Surface {
        let mut surface = Surface::default();
        let mut known: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        for face in &self.faces {
            let corner = |at: usize| {
                let pair = [face.drawn[at], face.corners[at]];
                *known.entry(pair).or_insert_with(|| {
                    let old = pair[0] as usize;
                    surface.vertex.push(new[&pair[1]]);
                    surface.uv.extend(before.uv.get(old));
                    surface.colour.extend(before.colour.get(old));
                    surface.vertex.len() as u32 - 1
                })
            };
            let triangle = [0, 1, 2].map(corner);
            surface.triangles.push(triangle);
        }
        surface
    }
}
