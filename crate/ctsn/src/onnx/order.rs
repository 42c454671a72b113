//! The order of the vertices inside the graph: those of as many neighbours stand together, so that their table of
//! neighbours is a full rectangle.

use ctsn_core::topology::Graph;
use std::ops::Range;

/// An order of the vertices.
pub struct Order {
    /// Which vertex stands at each place [n].
    pub vertices: Vec<usize>,
    /// Where each vertex stands [n].
    pub places: Vec<usize>,
}

/// Vertices of as many neighbours.
pub struct Ring {
    /// Their places.
    pub places: Range<usize>,
    /// Neighbours of each.
    pub degree: usize,
    /// Places of their neighbours [places, degree].
    pub neighbours: Vec<usize>,
}

impl Order {
    /// By the number of neighbours; among equals as before.
    pub fn by_degree(graph: &Graph<Vec<u32>>) -> Self {
        let mut vertices: Vec<usize> = (0..graph.offsets.len() - 1).collect();
        vertices.sort_by_key(|vertex| graph.of(*vertex).len());
        let mut places = vec![0; vertices.len()];
        vertices.iter().enumerate().for_each(|(place, vertex)| places[*vertex] = place);
        Self { vertices, places }
    }

    /// The vertices by their number of neighbours, in this order.
    pub fn rings(&self, graph: &Graph<Vec<u32>>) -> Vec<Ring> {
        let degree = |place: usize| graph.of(self.vertices[place]).len();
        let starts = (0..self.vertices.len()).filter(|place| *place == 0 || degree(*place) != degree(*place - 1));
        let mut bounds: Vec<usize> = starts.collect();
        bounds.push(self.vertices.len());
        let ring = |bounds: &[usize]| {
            let around = self.vertices[bounds[0]..bounds[1]].iter().flat_map(|vertex| graph.of(*vertex));
            let neighbours = around.map(|neighbour| self.places[*neighbour as usize]).collect();
            Ring { places: bounds[0]..bounds[1], degree: degree(bounds[0]), neighbours }
        };
        bounds.windows(2).map(ring).collect()
    }

    /// Rows [n, width] in this order.
    pub fn rows(&self, rows: &[f32], width: usize) -> Vec<f32> {
        self.vertices.iter().flat_map(|vertex| &rows[vertex * width..][..width]).copied().collect()
    }

    /// Rows [n, width] in this order, as columns [width, n].
    pub fn columns(&self, rows: &[f32], width: usize) -> Vec<f32> {
        (0..width).flat_map(|column| self.vertices.iter().map(move |vertex| rows[vertex * width + column])).collect()
    }
}
