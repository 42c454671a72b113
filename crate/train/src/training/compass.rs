//! The compass of a garment: from each vertex of the template the neighbour that lies upwards, downwards and to both
//! sides along the cloth. By it the mesh stream finds what is around a vertex. network.md §3.

use ctsn_core::topology::Graph;
use ctsn_rig::vertices;
use glam::DVec3;

/// A neighbour that lies further off its direction than 60° is none.
const LEAST_COSINE: f64 = 0.5;

/// Neighbours of each vertex of `template` [n, 3] in the four directions, itself where there is none [n, 4].
pub fn compass(template: &[f32], triangles: &[u32], graph: &Graph<Vec<u32>>) -> Vec<u32> {
    let points = vertices(template);
    let mut normals = vec![DVec3::ZERO; points.len()];
    for corners in triangles.as_chunks::<3>().0 {
        let [a, b, c] = corners.map(|i| points[i as usize]);
        corners.iter().for_each(|i| normals[*i as usize] += (b - a).cross(c - a));
    }
    let of = |i: usize| {
        let normal = normals[i].normalize_or(DVec3::Z);
        // Cloth that lies flat has a direction of its own.
        let up = DVec3::Y.reject_from_normalized(normal).try_normalize().unwrap_or(normal.any_orthonormal_vector());
        let side = normal.cross(up);
        let cosine = |j: u32, along: DVec3| (points[j as usize] - points[i]).normalize_or_zero().dot(along);
        [up, -up, side, -side].map(|along| {
            let cosines = graph.of(i).iter().map(|j| (*j, cosine(*j, along)));
            let nearest = cosines.max_by(|a, b| a.1.total_cmp(&b.1));
            nearest.filter(|(_, cosine)| *cosine > LEAST_COSINE).map_or(i as u32, |(j, _)| j)
        })
    };
    (0..points.len()).flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_lie_where_the_compass_points() {
        let (setup, _) = crate::synthetic::dataset(400, 2, 1);
        let (n, points) = (setup.template.len() / 3, vertices(&setup.template));
        let compass = compass(&setup.template, &setup.triangles, &Graph::new(n, &setup.triangles));
        let directions = compass.as_chunks::<4>().0;
        let top = points.iter().fold(f64::MIN, |top, point| top.max(point.y));
        for (i, [up, down, right, left]) in directions.iter().map(|row| row.map(|j| j as usize)).enumerate() {
            let at_rim = |height: f64| (points[i].y - height).abs() < 1e-6;
            assert!(points[up].y > points[i].y || (up == i && at_rim(top)), "up from {i} to {up}");
            assert!(points[down].y < points[i].y || (down == i && at_rim(0.0)), "down from {i} to {down}");
            // Around the tube, one to each side, seen from its axis.
            let turn = |j: usize| points[i].cross(points[j]).y;
            assert!(turn(right) * turn(left) < 0.0, "{right} and {left} beside {i}");
        }
        // All turn the same way.
        let turns = |(i, row): (usize, &[u32; 4])| points[i].cross(points[row[2] as usize]).y > 0.0;
        let right = directions.iter().enumerate().filter(|row| turns(*row)).count();
        assert!(right == 0 || right == n, "{right} of {n}");
    }

    #[test]
    fn cloth_that_lies_flat_has_a_compass_too() {
        let (template, triangles) = ([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0], [0, 2, 1, 1, 2, 3]);
        let compass = compass(&template, &triangles, &Graph::new(4, &triangles));
        assert!(compass.as_chunks::<4>().0.iter().enumerate().all(|(i, row)| row.iter().any(|j| *j != i as u32)));
    }
}
