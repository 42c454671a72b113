//! The sheet that is resampled: where its vertices may lie, and what they take along from the artist's.

use crate::wrap::{Faces, Piece, even};
use ctsn_rig::gltf::Source;
use ctsn_rig::mesh::triangle::{closest, cross, point};
use ctsn_rig::mesh::{Edges, Mesh};
use ctsn_rig::{Garment, Surface};
use glam::{DVec2, DVec3};

/// How far flat faces are rounded off between the normals of their corners (Boubekeur & Alexa, Phong Tessellation,
/// 2008): coarse facets would be creases in the cloth's rest shape.
const ROUND: f64 = 0.75;
/// A vertex is pinned where so much of what is under it is.
const PINNED: f64 = 0.5;

pub(super) struct Sheet<'a> {
    garment: &'a Garment,
    source: &'a Source,
    faces: Faces<'a>,
    /// Unit normal per face.
    looks: Vec<DVec3>,
    /// Unit normal per vertex.
    normals: Vec<DVec3>,
    /// Open edges, by loop.
    rims: Vec<Vec<[u32; 2]>>,
}

impl<'a> Sheet<'a> {
    pub fn new(garment: &'a Garment, source: &'a Source) -> Self {
        let mesh = &garment.mesh;
        Self {
            faces: Faces::new(mesh),
            looks: mesh.corners().map(|corners| cross(corners).normalize_or_zero()).collect(),
            normals: mesh.normals(&mesh.positions),
            rims: Edges::new(&mesh.triangles).rims(),
            garment,
            source,
        }
    }

    /// About `target` vertices evenly on it: the garment, and how its vertices are numbered in the file.
    pub fn resample(&self, target: usize) -> (Garment, Source) {
        let mut rim = vec![None; self.garment.mesh.positions.len()];
        for (index, edges) in self.rims.iter().enumerate() {
            edges.iter().for_each(|[from, _]| rim[*from as usize] = Some(index));
        }
        let onto = |rim: Option<usize>, point: DVec3, normal: DVec3| match rim {
            Some(rim) => self.on_rim(rim, point),
            None => self.on_face(point, normal),
        };
        let Piece { mesh, .. } = even(Piece { mesh: self.garment.mesh.clone(), rim }, &onto, target);
        let normals = mesh.normals(&mesh.positions);
        let under: Vec<([u32; 3], [f64; 3])> =
            mesh.positions.iter().zip(&normals).map(|(place, normal)| self.under(*place, *normal)).collect();
        let pinned = |(corners, weights): &([u32; 3], [f64; 3])| {
            let held = |corner: &u32| self.garment.pins.binary_search(corner).is_ok();
            corners.iter().zip(weights).filter(|(corner, _)| held(corner)).map(|(_, weight)| weight).sum::<f64>()
                >= PINNED
        };
        let pins = (0..).zip(&under).filter(|(_, under)| pinned(under)).map(|(vertex, _)| vertex).collect();
        let nearest = |(corners, weights): &([u32; 3], [f64; 3])| {
            let most = (0..3).max_by(|a, b| weights[*a].total_cmp(&weights[*b])).unwrap_or(0);
            self.source.numbers[corners[most] as usize]
        };
        let source = Source { numbers: under.iter().map(nearest).collect(), ..self.source.clone() };
        (Garment { surface: self.texture(&mesh), mesh, pins, drawn: None }, source)
    }

    /// The face under a place that looks as `normal` does.
    fn face(&self, place: DVec3, normal: DVec3) -> usize {
        let alike = self.faces.nearest_of(place, |face| self.looks[face].dot(normal) > 0.0);
        alike.or_else(|| self.faces.nearest(place)).map_or(0, |(face, _)| face)
    }

    /// What is under a place: a face's corners and the barycentric coordinates of the closest point.
    fn under(&self, place: DVec3, normal: DVec3) -> ([u32; 3], [f64; 3]) {
        let corners = self.garment.mesh.triangles[self.face(place, normal)];
        (corners, closest(place, corners.map(|v| self.garment.mesh.positions[v as usize])))
    }

    /// The place on the sheet, its faces rounded off.
    fn on_face(&self, place: DVec3, normal: DVec3) -> DVec3 {
        let (corners, weights) = self.under(place, normal);
        let places = corners.map(|v| self.garment.mesh.positions[v as usize]);
        let flat = point(places, weights);
        let on_plane = |k: usize| {
            let normal = self.normals[corners[k] as usize];
            flat - normal * normal.dot(flat - places[k])
        };
        flat + ROUND * (point([0, 1, 2].map(on_plane), weights) - flat)
    }

    /// The place on a rim.
    fn on_rim(&self, rim: usize, place: DVec3) -> DVec3 {
        let on_edge = |edge: &[u32; 2]| {
            let [a, b] = edge.map(|v| self.garment.mesh.positions[v as usize]);
            let share = (place - a).dot(b - a) / (b - a).length_squared().max(f64::MIN_POSITIVE);
            a + share.clamp(0.0, 1.0) * (b - a)
        };
        let near = |a: &DVec3, b: &DVec3| a.distance_squared(place).total_cmp(&b.distance_squared(place));
        self.rims[rim].iter().map(on_edge).min_by(near).unwrap_or(place)
    }

    /// The artist's texture coordinates on the faces of another mesh, each as the face under its middle has them: the
    /// thread runs along them.
    fn texture(&self, mesh: &Mesh) -> Surface {
        let drawn = &self.garment.surface;
        if drawn.uv.is_empty() || drawn.triangles.len() != self.garment.mesh.triangles.len() {
            return Surface::default();
        }
        let mut surface = Surface::default();
        for (face, corners) in mesh.triangles.iter().zip(mesh.corners()) {
            let under = self.face(corners.iter().sum::<DVec3>() / 3.0, cross(corners));
            let places = self.garment.mesh.triangles[under].map(|v| self.garment.mesh.positions[v as usize]);
            let uv: [DVec2; 3] = drawn.triangles[under].map(|v| drawn.uv[v as usize]);
            let first = surface.vertex.len() as u32;
            surface.triangles.push([first, first + 1, first + 2]);
            for (vertex, corner) in face.iter().zip(corners) {
                let [a, b, c] = in_plane(corner, places);
                surface.vertex.push(*vertex);
                surface.uv.push(uv[0] * a + uv[1] * b + uv[2] * c);
            }
        }
        surface
    }
}

/// Barycentric coordinates of a place in the plane of a triangle, also beyond its edges.
fn in_plane(place: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let normal = cross([a, b, c]);
    let square = normal.length_squared().max(f64::MIN_POSITIVE);
    let share = |from: DVec3, to: DVec3| (from - place).cross(to - place).dot(normal) / square;
    let (u, v) = (share(b, c), share(c, a));
    [u, v, 1.0 - u - v]
}
