//! Bases that vary slowly over the cloth. A pose that nobody simulated mixes them anew; what each vertex has learned by
//! itself then crinkles it from vertex to vertex. So bases begin smooth, and every step of them is averaged over
//! neighbours: any shape can still be learned, long waves first.
//!
//! Bending over the truth's, unseen motion, with and without: a dress of 6,016 vertices (53 poses, 20 epochs; 8 rounds)
//! 1.37 and 1.67; a T-shirt of 2,993 (50 poses, 25 epochs; 5 rounds) 1.08 and 1.22; a sheet of 1,202 (50 poses, 40
//! epochs; 3 rounds) 2.00 and 2.49. E_dist 22.5 and 22.5 mm, 9.7 and 9.6, 18.7 and 18.6; E_norm 13.3° and 13.4, 11.1
//! and 10.9, 10.6 and 10.6. The skeleton stream's basis alone, 4 rounds: the T-shirt's bending 1.20. A tenth of the
//! first values alone: 1.23.

use ctsn_core::model::{MESH_BASIS, SKELETON_BASIS};
use ctsn_core::topology::Graph;
use rayon::prelude::*;

/// Each round brings every vertex half of the way to the mean of its neighbours. What repeats every six edges keeps
/// half.
const ROUNDS: usize = 5;

/// Whether the array of that name is averaged: a basis, of a row for each vertex.
pub(super) fn is_blurred(array: &str) -> bool {
    [SKELETON_BASIS, MESH_BASIS].contains(&array)
}

/// Averages `rows` [n, any], one for each vertex of the cloth, over its neighbours.
pub(super) fn blur(graph: &Graph<Vec<u32>>, rows: &mut [f32]) {
    let width = rows.len() / (graph.offsets.len() - 1).max(1);
    let mut before = rows.to_vec();
    for round in 0..ROUNDS {
        if round > 0 {
            before.copy_from_slice(rows);
        }
        rows.par_chunks_mut(width.max(1)).enumerate().for_each(|(i, row)| {
            let neighbours = graph.of(i);
            if neighbours.is_empty() {
                return;
            }
            let share = 0.5 / neighbours.len() as f32;
            row.iter_mut().for_each(|number| *number *= 0.5);
            for j in neighbours {
                let other = &before[*j as usize * width..][..width];
                row.iter_mut().zip(other).for_each(|(number, other)| *number += share * other);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_even_stays_and_what_alternates_is_lost() {
        // A strip of triangles, whose first vertex belongs to none.
        let triangles: Vec<u32> = (1..40).flat_map(|i| [i, i + 1 + i % 2, i + 2 - i % 2]).collect();
        let graph = Graph::new(42, &triangles);
        let rows = |value: fn(usize) -> f32| (0..42).flat_map(|i| [value(i), 2.0]).collect::<Vec<f32>>();
        let mut even = rows(|_| 3.0);
        blur(&graph, &mut even);
        assert!(even.iter().zip(&rows(|_| 3.0)).all(|(a, b)| (a - b).abs() < 1e-5), "{even:?}");
        let mut rough = rows(|i| if i % 3 == 0 { 1.0 } else { -0.5 });
        blur(&graph, &mut rough);
        assert_eq!(rough[0], 1.0, "nobody is beside it");
        let greatest = rough[20..60].iter().step_by(2).fold(0.0_f32, |most, number| most.max(number.abs()));
        assert!(greatest < 0.1, "{greatest}");
        assert!(rough.iter().skip(1).step_by(2).all(|number| (number - 2.0).abs() < 1e-5), "axes do not mix");
    }
}
