//! Which body vertex each cloth vertex hangs by.

use super::Setup;
use crate::{Error, Result};
use ctsn_rig::{is_obstacle, strongest};
use kiddo::{ImmutableKdTree, SquaredEuclidean};

impl Setup {
    /// Index of the body vertex nearest to each cloth vertex [n], the reference of the mesh stream. network.md §3.
    pub fn reference(&self) -> Result<Vec<usize>> {
        self.nearest_among((0..self.body.len() / 3).collect())
    }

    /// The same without obstacles, which cloth hangs before, but not on: its skin weights are `W_C^I`. network.md §4.
    pub fn nearest(&self) -> Result<Vec<usize>> {
        let joints = &self.description.joints;
        let of_figure = |i: &usize| joints.get(strongest(&self.body_weights[*i])).is_none_or(|name| !is_obstacle(name));
        let figure: Vec<usize> = (0..self.body_weights.len()).filter(of_figure).collect();
        if figure.is_empty() { self.reference() } else { self.nearest_among(figure) }
    }

    fn nearest_among(&self, body: Vec<usize>) -> Result<Vec<usize>> {
        let place = |i: &usize| -> [f32; 3] { std::array::from_fn(|c| self.body[3 * i + c]) };
        let places: Vec<[f32; 3]> = body.iter().map(place).collect();
        let tree: ImmutableKdTree<f32, 3> = ImmutableKdTree::new_from_slice(&places)
            .map_err(|error| Error::Dataset(format!("body vertices: {error}")))?;
        let query =
            |vertex: &[f32; 3]| tree.query(vertex).nearest_one::<SquaredEuclidean<f32>>().execute().item as usize;
        Ok(self.template.as_chunks::<3>().0.iter().map(|vertex| body[query(vertex)]).collect())
    }
}
