//! A part of a garment: some of its vertices, which move, and around them all that these touch, which is held.

use super::cloth::Cloth;
use super::elastic::Elastic;
use super::neighbourhood::Elements;

/// Which vertices of a garment a part has.
pub(super) struct Part {
    /// Those that move, and after them those that are held.
    pub vertices: Vec<usize>,
    /// How many move.
    pub free: usize,
}

impl Cloth {
    /// Marks the neighbours of all marked vertices [n].
    pub(super) fn spread(&self, marked: &mut [bool]) {
        let before = marked.to_vec();
        for triangle in self.elastic.triangles.iter().filter(|t| t.vertices.iter().any(|&v| before[v])) {
            triangle.vertices.iter().for_each(|&v| marked[v] = true);
        }
    }

    /// The `free` vertices [n], those that share an element with them, and the triangles around what is `near` them
    /// [n].
    pub(super) fn part_around(&self, free: &[bool], mut near: Vec<bool>) -> Part {
        self.spread(&mut near);
        for clique in self.cliques().filter(|clique| clique.iter().any(|&v| free[v])) {
            clique.iter().for_each(|&v| near[v] = true);
        }
        let mut vertices: Vec<usize> = (0..free.len()).filter(|&v| free[v]).collect();
        let count = vertices.len();
        vertices.extend((0..free.len()).filter(|&v| near[v] && !free[v]));
        Part { vertices, free: count }
    }

    /// The part by itself, its vertices numbered in their order: the elements that pull at one that moves, and all that
    /// these may meet.
    pub(super) fn part(&self, Part { vertices, free }: &Part) -> Self {
        let mut local = vec![usize::MAX; self.elastic.masses.len()];
        vertices.iter().enumerate().for_each(|(at, &v)| local[v] = at);
        let pulls = |vertices: &[usize]| vertices.iter().any(|&v| local[v] < *free);
        let mut elastic = Elastic {
            masses: vertices.iter().map(|&v| self.elastic.masses[v]).collect(),
            triangles: self.elastic.triangles.iter().filter(|t| pulls(&t.vertices)).cloned().collect(),
            hinges: self.elastic.hinges.iter().filter(|h| pulls(&h.vertices)).cloned().collect(),
            membrane: self.elastic.membrane,
        };
        elastic.triangles.iter_mut().for_each(|t| t.vertices = t.vertices.map(|v| local[v]));
        elastic.hinges.iter_mut().for_each(|h| h.vertices = h.vertices.map(|v| local[v]));
        let mapped = self.elements.triangles.iter().map(|t| t.map(|v| local[v as usize] as u32));
        let whole: Vec<[u32; 3]> = mapped.filter(|t| t.iter().all(|&v| v != u32::MAX)).collect();
        let worn = vertices.iter().map(|&v| self.worn[v]).collect();
        Self { elements: Elements::new(&whole, vertices.len()), elastic, worn, ..*self }
    }
}
