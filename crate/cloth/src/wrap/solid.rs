//! The body on the voxel grid: exact triangle distances near the surface, and what is inside by flooding from outside,
//! so that open, multi-shell and self-intersecting bodies work.

use super::field::Field;
use ctsn_rig::Mesh;
use ctsn_rig::mesh::triangle::{self, closest_point};
use glam::DVec3;
use rayon::prelude::*;

/// What the field is made of. Triangles as corner positions.
pub(crate) struct Solid<'a> {
    /// Every triangle of the body.
    pub triangles: &'a [[DVec3; 3]],
    /// Per triangle: is it wrapped?
    pub covered: &'a [bool],
    /// Room around it for what hangs and widens, metres.
    pub room: f64,
    /// Distance of the shell from the body, metres.
    pub looseness: f64,
    /// Standard deviation of the smoothing, metres.
    pub smoothing: f64,
}

impl Solid<'_> {
    /// Values beyond this are no distances: the width of the field's band, for voxels of `cell` metres. Metres.
    pub fn band(&self, cell: f64) -> f64 {
        self.looseness.clamp(2.0 * cell, 4.0 * cell)
    }
}

/// Distance of one voxel: to the body, to the covered part, and whether the nearest triangle is covered.
#[derive(Clone, Copy)]
pub(super) struct Near {
    /// Distance to any triangle, metres, or the reach.
    pub body: f32,
    /// Distance to the covered triangles, metres, or the reach.
    pub covered: f32,
    /// Is the nearest triangle covered?
    pub is_covered: bool,
}

impl Field {
    /// Exact triangle distances up to `reach`; one slice of the grid per task.
    pub(super) fn distances(&self, triangles: &[[DVec3; 3]], covered: &[bool], reach: f64, wall: f64) -> Vec<Near> {
        let [nx, ny, nz] = self.size;
        let far = Near { body: reach as f32, covered: reach as f32, is_covered: false };
        let mut near = vec![far; nx * ny * nz];
        // The bare part only has to be a closed wall.
        let ranges: Vec<[(usize, usize); 3]> = triangles
            .iter()
            .zip(covered)
            .map(|([a, b, c], covered)| {
                (a.min(*b).min(*c), a.max(*b).max(*c), if *covered { reach } else { wall + self.cell })
            })
            .map(|(low, high, reach)| self.range(low - reach, high + reach))
            .collect();
        // Bounding spheres spare most of the exact distances.
        let spheres: Vec<(DVec3, f64)> = triangles
            .iter()
            .map(|t| (t[0] + t[1] + t[2]) / 3.0)
            .zip(triangles)
            .map(|(centre, t)| (centre, t.iter().fold(0.0, |radius: f64, p| radius.max(p.distance(centre)))))
            .collect();
        near.par_chunks_mut(nx * ny).enumerate().for_each(|(z, slice)| {
            for (index, [xs, ys, zs]) in ranges.iter().enumerate() {
                if z < zs.0 || z >= zs.1 {
                    continue;
                }
                let (triangle, covered) = (&triangles[index], covered[index]);
                let (centre, radius) = spheres[index];
                for y in ys.0..ys.1 {
                    for x in xs.0..xs.1 {
                        let cell = &mut slice[y * nx + x];
                        let point = self.point([x, y, z]);
                        let bound = if covered { cell.covered } else { cell.body } as f64 + radius;
                        if point.distance_squared(centre) >= bound * bound {
                            continue;
                        }
                        let distance = point.distance(closest_point(point, *triangle)) as f32;
                        if distance < cell.body {
                            (cell.body, cell.is_covered) = (distance, covered);
                        }
                        if covered && distance < cell.covered {
                            cell.covered = distance;
                        }
                    }
                }
            }
        });
        near
    }

    /// Voxels inside the covered part of the body: not reached from the grid's rim through voxels farther than `wall`
    /// from the body. Deep voxels take the label of the nearest one that has seen a triangle.
    pub(super) fn interior(&self, near: &mut [Near], wall: f64) -> Vec<bool> {
        let reach = near.iter().fold(0.0_f32, |reach, near| reach.max(near.body));
        let mut outside = vec![false; near.len()];
        let on_rim = |i: usize| self.place(i).iter().zip(&self.size).any(|(&at, &count)| at == 0 || at + 1 == count);
        let mut queue: Vec<usize> = (0..near.len()).filter(|&i| on_rim(i)).collect();
        queue.iter().for_each(|&i| outside[i] = true);
        while let Some(i) = queue.pop() {
            for j in self.neighbours(i) {
                if !outside[j] && near[j].body > wall as f32 {
                    outside[j] = true;
                    queue.push(j);
                }
            }
        }
        let mut queue: Vec<usize> = (0..near.len()).filter(|&i| !outside[i] && near[i].body < reach).collect();
        let mut known: Vec<bool> = near.iter().map(|near| near.body < reach).collect();
        let mut next = 0;
        while next < queue.len() {
            for j in self.neighbours(queue[next]) {
                if !known[j] && !outside[j] {
                    known[j] = true;
                    near[j].is_covered = near[queue[next]].is_covered;
                    queue.push(j);
                }
            }
            next += 1;
        }
        near.iter().zip(outside).map(|(near, outside)| !outside && near.is_covered && near.body > wall as f32).collect()
    }
}

/// Voxel edge for a body between two corners, metres: 7 mm on a human, and at most six million voxels on a bulky body.
pub(crate) fn cell(low: DVec3, high: DVec3) -> f64 {
    let extent = (high - low).max_element();
    (extent / 250.0).max(((high - low).max(DVec3::splat(0.1 * extent)).element_product() / 6e6).cbrt())
}

/// The body's triangles, split until no edge is longer than `longest` metres, and which of them are covered:
/// `is_covered` is asked with a triangle's vertices, barycentric coordinates of a part's centre and the centre itself.
pub(crate) fn split(
    body: &Mesh,
    longest: f64,
    is_covered: impl Fn([u32; 3], DVec3, DVec3) -> bool,
) -> (Vec<[DVec3; 3]>, Vec<bool>) {
    let (mut triangles, mut covered) = (Vec::new(), Vec::new());
    for triangle in &body.triangles {
        let corners = triangle.map(|v| body.positions[v as usize]);
        // Barycentric corners still to split.
        let mut queue = vec![[DVec3::X, DVec3::Y, DVec3::Z]];
        while let Some(part) = queue.pop() {
            let [a, b, c] = part.map(|w| corners[0] * w.x + corners[1] * w.y + corners[2] * w.z);
            let lengths = [a.distance(b), b.distance(c), c.distance(a)];
            let k = if lengths[0] >= lengths[1].max(lengths[2]) { 0 } else { 1 + (lengths[2] > lengths[1]) as usize };
            if lengths[k] > longest {
                let middle = (part[k] + part[(k + 1) % 3]) / 2.0;
                let (mut first, mut second) = (part, part);
                (first[(k + 1) % 3], second[k]) = (middle, middle);
                queue.extend([first, second]);
            } else if triangle::cross([a, b, c]).length() > 1e-9 * lengths[k] * lengths[k] {
                triangles.push([a, b, c]);
                covered.push(is_covered(*triangle, (part[0] + part[1] + part[2]) / 3.0, (a + b + c) / 3.0));
            }
        }
    }
    (triangles, covered)
}
