//! What a dataset's cloth is: the garment as it was given to the simulator, and its elastic model.

use super::Setup;
use crate::Result;
use ctsn_cloth::simulate::Elastic;
use ctsn_rig::{Garment, Mesh, Surface, vertices};
use glam::DVec2;

impl Setup {
    /// The garment before it was draped.
    pub fn garment(&self) -> Garment {
        let triangles = |list: &[u32]| list.as_chunks::<3>().0.to_vec();
        let uv = self.surface.uv.as_chunks::<2>().0.iter().map(|uv| DVec2::from(uv.map(f64::from)));
        Garment {
            mesh: Mesh { positions: vertices(&self.garment), triangles: triangles(&self.triangles) },
            surface: Surface {
                vertex: self.surface.vertex.clone(),
                uv: uv.collect(),
                triangles: triangles(&self.surface.triangles),
                ..Surface::default()
            },
            pins: self.description.settings.attached.clone(),
            drawn: None,
        }
    }

    /// The elastic model by which the truth was simulated.
    pub fn elastic(&self) -> Result<Elastic> {
        let description = &self.description;
        Elastic::new(&self.garment(), &description.material.material, description.settings.shape)
    }
}
