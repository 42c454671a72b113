//! How the garment was cut: the lengths that its edges have without strain. Optional; a model without it shows what the
//! network predicts. The file's tensor: `cloth.cut` [n, 3].

use super::write::Writer;
use crate::Result;
use crate::error::{Decimal, Error};
use crate::file::Tensors;
use crate::topology::Graph;

/// Steps of the polish, where neither file nor page says otherwise.
pub const STEPS: usize = 16;

/// More steps than this are refused where someone asks for them: they take longer than the network.
pub const MOST_STEPS: usize = 256;

/// The garment without strain.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut<B> {
    /// Steps of the polish.
    pub steps: usize,
    /// Positions, metres [n, 3]: only their distances matter.
    pub positions: Vec<f32>,
    /// Squared length of each edge, square metres, in the order of the graph's neighbours.
    pub squares: B,
}

impl Cut<Vec<f32>> {
    /// Of positions [n, 3].
    ///
    /// # Errors
    /// An edge without a length, or too long for an f32.
    pub fn new(positions: Vec<f32>, graph: &Graph<Vec<u32>>, steps: usize) -> Result<Self> {
        let points = positions.as_chunks::<3>().0;
        let square = |i: usize, j: u32| -> f32 {
            points[i].iter().zip(&points[j as usize]).map(|(a, b)| (a - b) * (a - b)).sum()
        };
        let row = |i: usize| graph.of(i).iter().map(move |j| (i, *j, square(i, *j)));
        let mut squares = Vec::with_capacity(graph.neighbours.len());
        for (i, j, square) in (0..points.len()).flat_map(row) {
            if !(square >= f32::MIN_POSITIVE && square.is_finite()) {
                let found = format!("that of vertices {i} and {j} squared is {}", Decimal(square));
                return Err(Error::NotModel(format!("cloth.cut: wanted edges with a length, {found}")));
            }
            squares.push(square);
        }
        Ok(Self { steps, positions, squares })
    }

    /// That of a file for `n` cloth vertices; `None` where it has none.
    pub(super) fn read(file: &Tensors, n: usize, graph: &Graph<Vec<u32>>, steps: usize) -> Result<Option<Self>> {
        if !file.tensors.contains_key("cloth.cut") {
            return Ok(None);
        }
        let positions = file.f32("cloth.cut", &[Some(n), Some(3)])?.0;
        Self::new(positions, graph, steps).map(Some)
    }

    /// Adds it to the file of a model.
    pub(super) fn write(&self, writer: &mut Writer) {
        writer.fixed("cloth.cut", &[self.positions.len() / 3, 3], &self.positions);
    }
}

impl<B> Cut<B> {
    /// The same on other storage.
    pub(super) fn map<'a, C>(&'a self, values: &mut impl FnMut(&'a B) -> C) -> Cut<C> {
        Cut { steps: self.steps, positions: self.positions.clone(), squares: values(&self.squares) }
    }
}
