//! A character in a pose with cloth on it, as layers to draw.

use super::Layer;
use ctsn_rig::{Character, Mesh, Pose};
use glam::DVec3;

/// Cloth, linear RGB.
const CLOTH: [f32; 3] = [0.06, 0.20, 0.42];
/// Body without colours of its own, linear RGB.
const BODY: [f32; 3] = [0.55, 0.45, 0.38];

/// A mesh to draw.
struct Part {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    colour: Vec<[f32; 3]>,
}

/// A dressed character.
pub(super) struct Figure {
    body: Part,
    cloth: Option<Part>,
}

impl Figure {
    /// The body in `pose`, and cloth (positions in the same world, triangles).
    pub fn new(character: &Character, pose: &Pose, cloth: Option<(&[DVec3], &[[u32; 3]])>) -> Self {
        let (posed, surface) = (character.pose_body(pose), &character.surface);
        let normals = character.body.mesh.normals(&posed);
        let plain = surface.triangles.is_empty();
        let vertex = if plain { (0..posed.len() as u32).collect() } else { surface.vertex.clone() };
        let drawn = |of_body: &[DVec3]| vertex.iter().map(|&at| of_body[at as usize]).collect();
        let body = Part {
            positions: drawn(&posed),
            normals: drawn(&normals),
            triangles: if plain { character.body.mesh.triangles.clone() } else { surface.triangles.clone() },
            colour: if surface.colour.is_empty() { vec![BODY] } else { surface.colour.clone() },
        };
        let cloth = cloth.map(|(positions, triangles)| {
            let mesh = Mesh { positions: positions.to_vec(), triangles: triangles.to_vec() };
            let normals = mesh.normals(positions);
            Part { normals, positions: mesh.positions, triangles: mesh.triangles, colour: vec![CLOTH] }
        });
        Self { body, cloth }
    }

    /// The same with the cloth in other colours, linear RGB per vertex; an empty list changes nothing.
    pub fn painted(mut self, colour: &[[f32; 3]]) -> Self {
        if let Some(cloth) = self.cloth.as_mut().filter(|_| !colour.is_empty()) {
            cloth.colour = colour.to_vec();
        }
        self
    }

    /// The layers to draw.
    pub fn layers(&self) -> Vec<Layer<'_>> {
        let mut layers = vec![self.body.layer(false)];
        layers.extend(self.cloth.as_ref().map(|cloth| cloth.layer(true)));
        layers
    }
}

impl Part {
    fn layer(&self, two_sided: bool) -> Layer<'_> {
        let Self { positions, normals, triangles, colour } = self;
        Layer { positions, normals, triangles, colour, two_sided }
    }
}
