//! Umbrella smoothing of a cloth: each step brings every vertex half of the way to the mean of its neighbours. A vertex
//! at a hem is averaged along the hem only, so that openings do not shrink.

use ctsn_core::topology::Graph;
use ctsn_rig::mesh::Edges;

/// The neighbours that count, of one cloth mesh.
pub(crate) struct Smoother {
    graph: Graph<Vec<u32>>,
}

impl Smoother {
    /// Of triangles [t, 3] over `n` vertices.
    pub fn new(n: usize, triangles: &[u32]) -> Self {
        let mut hem = vec![Vec::new(); n];
        for ([a, b], _) in Edges::new(triangles.as_chunks().0).boundary() {
            hem[a as usize].push(b);
            hem[b as usize].push(a);
        }
        let all = Graph::new(n, triangles);
        let (mut offsets, mut neighbours) = (vec![0], Vec::new());
        for (i, hem) in hem.iter().enumerate() {
            neighbours.extend_from_slice(if hem.is_empty() { all.of(i) } else { hem });
            offsets.push(neighbours.len() as u32);
        }
        Self { graph: Graph { offsets, neighbours } }
    }

    /// positions [n, 3] -> positions after `steps` [n, 3].
    pub fn smooth(&self, positions: &[f32], steps: usize) -> Vec<f32> {
        let mut current = positions.to_vec();
        for _ in 0..steps {
            let before = current.clone();
            for (i, position) in current.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                let neighbours = self.graph.of(i);
                for c in 0..3 {
                    let sum: f32 = neighbours.iter().map(|j| before[*j as usize * 3 + c]).sum();
                    if !neighbours.is_empty() {
                        position[c] = 0.5 * position[c] + 0.5 * sum / neighbours.len() as f32;
                    }
                }
            }
        }
        current
    }

    /// The gradient of a number of smoothed positions [n, 3] -> that towards the positions [n, 3]: the transpose.
    pub fn spread(&self, gradient: &[f32], steps: usize) -> Vec<f32> {
        let mut current = gradient.to_vec();
        for _ in 0..steps {
            let before = current.clone();
            for (i, gradient) in before.as_chunks::<3>().0.iter().enumerate() {
                let neighbours = self.graph.of(i);
                for c in 0..3 {
                    if !neighbours.is_empty() {
                        current[3 * i + c] -= 0.5 * gradient[c];
                        let share = 0.5 * gradient[c] / neighbours.len() as f32;
                        neighbours.iter().for_each(|j| current[*j as usize * 3 + c] += share);
                    }
                }
            }
        }
        current
    }
}
