//! The mesh that is drawn where the cloth is another, as a dataset keeps it for the model. In `setup.safetensors`:
//! `drawn.corners` [w, 3], `drawn.coordinates` [w, 4], `drawn.vertex` [d], `drawn.uv` [d, 2], `drawn.triangles` [t, 3].

use crate::Result;
use ctsn_core::file::{Tensor, Tensors};
use ctsn_core::model::{Ride, Surface};

/// What rides on the cloth.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// Its vertices split at seams.
    pub surface: Surface,
    /// What its vertices ride on.
    pub ride: Ride<Vec<f32>, Vec<u32>>,
}

/// The surface of a garment in the numbers of a dataset.
pub fn stored_surface(surface: &ctsn_rig::Surface) -> Surface {
    Surface {
        vertex: surface.vertex.clone(),
        uv: surface.uv.iter().flat_map(|uv| uv.to_array().map(|value| value as f32)).collect(),
        triangles: surface.triangles.as_flattened().to_vec(),
    }
}

impl Drawn {
    /// That of a garment.
    pub fn new(drawn: &ctsn_rig::Drawn) -> Self {
        let mut surface = stored_surface(&drawn.surface);
        // A mesh without texture coordinates is drawn, too.
        surface.uv.resize(2 * surface.vertex.len(), 0.0);
        let corners = drawn.riders.iter().flat_map(|rider| rider.corners).collect();
        let coordinates = drawn.riders.iter().flat_map(|rider| rider.coordinates.map(|value| value as f32)).collect();
        Self { ride: Ride::new(corners, coordinates, &surface), surface }
    }

    /// Adds it to the file of a setup.
    pub(super) fn write(&self, file: &mut Tensors<'static>) {
        let Self { surface, ride } = self;
        let (drawn, riders) = (surface.vertex.len(), ride.corners.len() / 3);
        file.tensors.extend([
            ("drawn.corners".to_owned(), Tensor::u32(&[riders, 3], &ride.corners)),
            ("drawn.coordinates".to_owned(), Tensor::f32(&[riders, 4], &ride.coordinates)),
            ("drawn.vertex".to_owned(), Tensor::u32(&[drawn], &surface.vertex)),
            ("drawn.uv".to_owned(), Tensor::f32(&[drawn, 2], &surface.uv)),
            ("drawn.triangles".to_owned(), Tensor::u32(&[surface.triangles.len() / 3, 3], &surface.triangles)),
        ]);
    }

    /// That of a file for `n` cloth vertices; `None` where it has none.
    pub(super) fn read(file: &Tensors, n: usize) -> Result<Option<Self>> {
        if !file.tensors.contains_key("drawn.corners") {
            return Ok(None);
        }
        let (coordinates, shape) = file.f32("drawn.coordinates", &[None, Some(4)])?;
        let corners = file.u32("drawn.corners", &[Some(shape[0]), Some(3)], n)?;
        let vertex = file.u32("drawn.vertex", &[None], shape[0])?;
        let surface = Surface {
            uv: file.f32("drawn.uv", &[Some(vertex.len()), Some(2)])?.0,
            triangles: file.u32("drawn.triangles", &[None, Some(3)], vertex.len())?,
            vertex,
        };
        Ok(Some(Self { ride: Ride::new(corners, coordinates, &surface), surface }))
    }
}
