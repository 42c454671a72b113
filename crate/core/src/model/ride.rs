//! What is drawn where it is another mesh than the cloth: each of its vertices rides on a triangle of the cloth.
//! Optional; a model without it draws the cloth itself. The file's tensors: `draw.corners` [w, 3],
//! `draw.coordinates` [w, 4].

use super::Surface;
use super::write::Writer;
use crate::cpu::Cpu;
use crate::error::{Decimal, Error, Result};
use crate::file::Tensors;
use crate::operation::{self, Normals};

/// Barycentric coordinates add up to one but for so much, which f32 loses.
const ROUNDING: f32 = 1e-4;
/// A vertex beyond the cloth's rim has negative coordinates; none is as far away as this.
const FARTHEST: f32 = 16.0;

/// The drawn mesh, one vertex per position, and what each of its vertices rides on.
#[derive(Clone, Debug, PartialEq)]
pub struct Ride<B, I> {
    /// Three cloth vertices under each drawn one [w, 3].
    pub corners: I,
    /// Their barycentric coordinates, then the offset along the normal between them, metres [w, 4].
    pub coordinates: B,
    /// Triangles of the drawn mesh [t, 3].
    pub triangles: I,
}

impl Ride<Vec<f32>, Vec<u32>> {
    /// Of a mesh whose vertices `surface` splits at seams; every index must be in range.
    pub fn new(corners: Vec<u32>, coordinates: Vec<f32>, surface: &Surface) -> Self {
        let triangles = surface.triangles.iter().map(|corner| surface.vertex[*corner as usize]).collect();
        Self { corners, coordinates, triangles }
    }

    /// How many vertices ride, by a file that has them.
    pub(super) fn count(file: &Tensors) -> Result<Option<usize>> {
        if !["draw.corners", "draw.coordinates"].iter().any(|name| file.tensors.contains_key(*name)) {
            return Ok(None);
        }
        match file.f32("draw.coordinates", &[None, Some(4)])?.1[0] {
            0 => {
                let (tensor, wanted) = ("draw.coordinates".to_owned(), "at least one row".to_owned());
                Err(Error::Shape { tensor, wanted, found: "none".to_owned() })
            }
            count => Ok(Some(count)),
        }
    }

    /// That of a file for `n` cloth vertices; `None` where it has none.
    pub(super) fn read(file: &Tensors, n: usize, surface: Option<&Surface>) -> Result<Option<Self>> {
        let Some(count) = Self::count(file)? else { return Ok(None) };
        let surface = surface.ok_or_else(|| Error::MissingTensor("draw.vertex".to_owned()))?;
        let corners = file.u32("draw.corners", &[Some(count), Some(3)], n)?;
        let coordinates = file.f32("draw.coordinates", &[Some(count), Some(4)])?.0;
        for (i, [a, b, c, _]) in coordinates.as_chunks::<4>().0.iter().enumerate() {
            let sound = [a, b, c].iter().all(|share| share.abs() <= FARTHEST) && (a + b + c - 1.0).abs() <= ROUNDING;
            if !sound {
                let found = [a, b, c].map(|share| Decimal(*share));
                return Err(Error::NotModel(format!(
                    "draw.coordinates: wanted three of at most {FARTHEST} that add up to 1, found {}, {} and {} at vertex {i}",
                    found[0], found[1], found[2]
                )));
            }
        }
        Ok(Some(Self::new(corners, coordinates, surface)))
    }

    /// Adds it to the file of a model.
    pub(super) fn write(&self, writer: &mut Writer) {
        let count = self.corners.len() / 3;
        writer.indices("draw.corners", &[count, 3], &self.corners);
        writer.fixed("draw.coordinates", &[count, 4], &self.coordinates);
    }

    /// The drawn mesh on cloth `positions` [n, 3] of these `triangles` [t, 3] -> [w, 3].
    pub fn lay(&self, positions: &[f32], triangles: &[u32]) -> Vec<f32> {
        let (mut normals, mut riders) = (vec![0.0; positions.len()], vec![0.0; self.corners.len()]);
        let mut cpu = Cpu::new();
        cpu.compute(Normals { positions, triangles, normals: normals.as_mut_slice() });
        let (corners, coordinates) = (self.corners.as_slice(), self.coordinates.as_slice());
        let normals = normals.as_slice();
        cpu.compute(operation::Ride { corners, coordinates, positions, normals, riders: riders.as_mut_slice() });
        riders
    }
}

impl<B, I> Ride<B, I> {
    /// The same on other storage.
    pub(super) fn map<'a, C, J>(
        &'a self,
        values: &mut impl FnMut(&'a B) -> C,
        indices: &mut impl FnMut(&'a I) -> J,
    ) -> Ride<C, J> {
        let Self { corners, coordinates, triangles } = self;
        Ride { corners: indices(corners), coordinates: values(coordinates), triangles: indices(triangles) }
    }
}
