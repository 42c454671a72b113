//! Triangles -> neighbour lists. network.md §3: the edges of the cloth triangles, both directions, no self loops.

use std::ops::Deref;

/// Neighbour lists of `n` vertices in compressed rows: vertex `i` has `neighbours[offsets[i]..offsets[i + 1]]`,
/// ascending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Graph<I> {
    /// Row starts, n + 1.
    pub offsets: I,
    /// Neighbours, one entry per directed edge.
    pub neighbours: I,
}

impl Graph<Vec<u32>> {
    /// Neighbour lists of the edges of `triangles` [t,3] over `n` vertices; every index must be below `n`.
    pub fn new(n: usize, triangles: &[u32]) -> Self {
        // Rows that stay sorted: a sort of all edges would add 3 kB to what a page downloads.
        let mut rows = vec![Vec::new(); n];
        let mut add = |from: u32, to: u32| {
            let row = &mut rows[from as usize];
            if let Err(place) = row.binary_search(&to)
                && from != to
            {
                row.insert(place, to);
            }
        };
        for [a, b, c] in triangles.as_chunks::<3>().0 {
            for (from, to) in [(*a, *b), (*b, *c), (*c, *a)] {
                add(from, to);
                add(to, from);
            }
        }
        let mut offsets = vec![0; n + 1];
        (0..n).for_each(|i| offsets[i + 1] = offsets[i] + rows[i].len() as u32);
        Self { offsets, neighbours: rows.concat() }
    }
}

impl<I: Deref<Target = [u32]>> Graph<I> {
    /// Neighbours of vertex `i`.
    pub fn of(&self, i: usize) -> &[u32] {
        &self.neighbours[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }
}

impl<I> Graph<I> {
    pub(crate) fn map<'a, J>(&'a self, indices: &mut impl FnMut(&'a I) -> J) -> Graph<J> {
        Graph { offsets: indices(&self.offsets), neighbours: indices(&self.neighbours) }
    }
}
