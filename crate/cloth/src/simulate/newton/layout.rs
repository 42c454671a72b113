//! Where each element's blocks lie in the Hessian: one analysis for the elastic elements, and a new one whenever cloth
//! comes near cloth that it was not near before. At 2,500 vertices that takes 8 ms, a third of the factorisation after
//! it.

use std::sync::Arc;

use crate::Result;
use crate::simulate::cloth::Cloth;
use crate::simulate::matrix::{Address, Pattern};

/// Hessian layout of a cloth: the pattern and where each element's blocks lie.
pub(in crate::simulate) struct Layout {
    pub pattern: Arc<Pattern>,
    pub triangles: Vec<[Address; 6]>,
    pub hinges: Vec<[Address; 10]>,
    pub diagonal: Vec<Address>,
}

/// Place of the pair `a >= b` in a packed lower triangle.
pub(super) fn packed(a: usize, b: usize) -> usize {
    a * (a + 1) / 2 + b
}

impl Layout {
    /// Analyses the coupling of the cloth's elements and of the `touching` groups of vertices.
    pub fn new(cloth: &Cloth, touching: &[[usize; 4]]) -> Result<Self> {
        let cliques = cloth.cliques().chain(touching.iter().map(|group| group.as_slice()));
        let pattern = Pattern::new(cloth.elastic.masses.len(), cliques)?;
        fn addresses<const P: usize>(pattern: &Pattern, vertices: &[usize]) -> [Address; P] {
            let mut list = [pattern.address(0, 0); P];
            for a in 0..vertices.len() {
                for b in 0..=a {
                    list[packed(a, b)] = pattern.address(vertices[a], vertices[b]);
                }
            }
            list
        }
        let triangles = cloth.elastic.triangles.iter().map(|t| addresses(&pattern, &t.vertices)).collect();
        let hinges = cloth.elastic.hinges.iter().map(|h| addresses(&pattern, &h.vertices)).collect();
        let diagonal = (0..cloth.elastic.masses.len()).map(|i| pattern.address(i, i)).collect();
        Ok(Self { pattern: Arc::new(pattern), triangles, hinges, diagonal })
    }
}
