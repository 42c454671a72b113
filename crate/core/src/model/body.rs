//! The body that cloth is kept out of: a simplified mesh of the character's, posed like it. Optional; a model without
//! it predicts as the network does. The file's tensors: `body.rest` [b, 3] in the order of [`Body::rest`],
//! `body.joints` and `body.weights` [b, width], `body.triangles` [t, 3], `body.seeds` [n, s].

use super::Skinning;
use super::write::Writer;
use crate::Result;
use crate::file::Tensors;

/// Most triangles around a vertex: the search for the closest point walks around vertices, for each of the cloth's.
const MOST_AROUND: u32 = 256;

/// The body's mesh, and where each cloth vertex looks for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Body<B, I> {
    /// `b`: vertices.
    pub vertices: usize,
    /// Canonical positions, metres [b, 3]; first [`LANDMARKS`](crate::cpu::repair::collide::LANDMARKS) that lie evenly.
    pub rest: B,
    /// Skin weights.
    pub skinning: Skinning<B, I>,
    /// Triangles [t, 3].
    pub triangles: I,
    /// The triangles around each body vertex.
    pub fans: Fans<I>,
    /// Body vertices near which each cloth vertex was in training [n, s]; the last on the other side of a crease, or
    /// the first again.
    pub seeds: I,
}

/// The triangles around each vertex, in compressed rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fans<I> {
    /// Row starts [b + 1].
    pub offsets: I,
    /// The other two corners of each triangle, in its order [3t, 2].
    pub corners: I,
}

impl Fans<Vec<u32>> {
    /// Fans of `triangles` [t, 3] over `count` vertices; every index must be below `count`.
    pub fn new(count: usize, triangles: &[u32]) -> Self {
        let mut fans = vec![Vec::new(); count];
        for [a, b, c] in triangles.as_chunks::<3>().0 {
            fans[*a as usize].extend([*b, *c]);
            fans[*b as usize].extend([*c, *a]);
            fans[*c as usize].extend([*a, *b]);
        }
        let mut offsets = vec![0; count + 1];
        (0..count).for_each(|i| offsets[i + 1] = offsets[i] + fans[i].len() as u32 / 2);
        Self { offsets, corners: fans.concat() }
    }
}

impl Body<Vec<f32>, Vec<u32>> {
    /// A body of vertices `rest` [b, 3], of `triangles` [t, 3] whose corners are below b; `seeds` [n, s] likewise.
    pub fn new(rest: Vec<f32>, skinning: Skinning<Vec<f32>, Vec<u32>>, triangles: Vec<u32>, seeds: Vec<u32>) -> Self {
        let vertices = rest.len() / 3;
        let fans = Fans::new(vertices, &triangles);
        Self { vertices, rest, skinning, triangles, fans, seeds }
    }

    /// The body of a file for `n` cloth vertices and `joints` joints; `None` where it has none.
    pub(super) fn read(file: &Tensors, n: usize, joints: usize) -> Result<Option<Self>> {
        if !file.tensors.keys().any(|name| name.starts_with("body.")) {
            return Ok(None);
        }
        let (rest, shape) = file.f32("body.rest", &[None, Some(3)])?;
        let count = shape[0];
        let (weights, shape) = file.f32("body.weights", &[Some(count), None])?;
        let width = shape[1];
        let slots = file.u32("body.joints", &[Some(count), Some(width)], joints)?;
        let triangles = file.u32("body.triangles", &[None, Some(3)], count)?;
        let seeds = file.u32("body.seeds", &[Some(n), None], count)?;
        if width == 0 || seeds.is_empty() {
            let wanted = "at least one column".to_owned();
            let tensor = if width == 0 { "body.weights" } else { "body.seeds" }.to_owned();
            return Err(crate::Error::Shape { tensor, wanted, found: "none".to_owned() });
        }
        let body = Self::new(rest, Skinning { joints: slots, weights, width }, triangles, seeds);
        let around = body.fans.offsets.windows(2).map(|row| row[1] - row[0]);
        match around.enumerate().find(|(_, around)| *around > MOST_AROUND) {
            Some((vertex, found)) => Err(crate::Error::NotModel(format!(
                "body.triangles: wanted at most {MOST_AROUND} around a vertex, found {found} around {vertex}"
            ))),
            None => Ok(Some(body)),
        }
    }

    /// Adds it to the file of a model of `n` cloth vertices.
    pub(super) fn write(&self, n: usize, writer: &mut Writer) {
        let (count, width) = (self.vertices, self.skinning.width);
        writer.fixed("body.rest", &[count, 3], &self.rest);
        writer.indices("body.joints", &[count, width], &self.skinning.joints);
        writer.fixed("body.weights", &[count, width], &self.skinning.weights);
        writer.indices("body.triangles", &[self.triangles.len() / 3, 3], &self.triangles);
        writer.indices("body.seeds", &[n, self.seeds.len() / n], &self.seeds);
    }
}

impl<B, I> Body<B, I> {
    /// The same body on other storage.
    pub(super) fn map<'a, C, J>(
        &'a self,
        values: &mut impl FnMut(&'a B) -> C,
        indices: &mut impl FnMut(&'a I) -> J,
    ) -> Body<C, J> {
        Body {
            vertices: self.vertices,
            rest: values(&self.rest),
            skinning: self.skinning.map(values, indices),
            triangles: indices(&self.triangles),
            fans: Fans { offsets: indices(&self.fans.offsets), corners: indices(&self.fans.corners) },
            seeds: indices(&self.seeds),
        }
    }
}
