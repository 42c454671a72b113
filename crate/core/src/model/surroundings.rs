//! Where the mesh stream looks around each vertex. Optional; without it the mesh stream sees the body under the cloth,
//! as in the paper. network.md §3. The file's tensor: `graph.compass` [n, 4], the neighbour of each vertex upwards,
//! downwards and to both sides, itself where there is none. Further away are those that a walk in one of these
//! directions comes to.

use super::write::Writer;
use crate::Result;
use crate::file::Tensors;

/// Directions of the compass.
pub const DIRECTIONS: usize = 4;
/// Steps of the walks, in edges: from an edge to a quarter of a metre on a garment of 4,000 vertices.
pub const STEPS: [u32; 4] = [1, 3, 8, 20];
/// Vertices around each.
pub const AROUND: usize = DIRECTIONS * STEPS.len();
/// Numbers that the first graph layer sees of a vertex: its place, which way is up, and those around it.
pub const INPUTS: usize = 6 + 3 * AROUND;

/// The vertices around each by a compass [n, 4] -> [n, 16], nearest first.
pub fn surroundings(compass: &[u32]) -> Vec<u32> {
    let walk = |start: u32, direction: usize, steps: u32| {
        (0..steps).fold(start, |at, _| compass[at as usize * DIRECTIONS + direction])
    };
    let around = |start| STEPS.iter().flat_map(move |steps| (0..DIRECTIONS).map(move |d| walk(start, d, *steps)));
    (0..(compass.len() / DIRECTIONS) as u32).flat_map(around).collect()
}

/// Those of a file for `n` cloth vertices; `None` where it has none.
pub(super) fn read(file: &Tensors, n: usize) -> Result<Option<Vec<u32>>> {
    if !file.tensors.contains_key("graph.compass") {
        return Ok(None);
    }
    Ok(Some(surroundings(&file.u32("graph.compass", &[Some(n), Some(DIRECTIONS)], n)?)))
}

/// Adds them to the file of a model: the nearest tell all others.
pub(super) fn write(around: &[u32], writer: &mut Writer) {
    let compass: Vec<u32> = around.chunks_exact(AROUND).flat_map(|row| &row[..DIRECTIONS]).copied().collect();
    writer.indices("graph.compass", &[around.len() / AROUND, DIRECTIONS], &compass);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walks_end_at_the_rim() {
        // A row of 30 vertices: up leads to the next, down to the one before, sideways there is none.
        let compass: Vec<u32> = (0..30_u32).flat_map(|i| [(i + 1).min(29), i.saturating_sub(1), i, i]).collect();
        let around = surroundings(&compass);
        assert_eq!(around.len(), 30 * AROUND);
        assert_eq!(around[5 * AROUND..6 * AROUND], [6, 4, 5, 5, 8, 2, 5, 5, 13, 0, 5, 5, 25, 0, 5, 5]);
        assert_eq!(around[25 * AROUND..26 * AROUND], [26, 24, 25, 25, 28, 22, 25, 25, 29, 17, 25, 25, 29, 5, 25, 25]);
    }
}
