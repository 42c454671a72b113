//! Texture coordinates: two panels, like front and back of a shirt, flattened as rigidly as possible; 1 UV unit =
//! 1 metre. Liu et al., A Local/Global Approach to Mesh Parameterization (2008), §4, unit weights as the triangles are
//! even.

use ctsn_rig::Surface;
use ctsn_rig::mesh::{Components, Edges, Mesh, triangle};
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use glam::{DMat3, DVec2, DVec3};
use std::collections::BTreeMap;

/// Gap between panels, metres.
const GAP: f64 = 0.02;

/// The drawn surface: every panel has vertices of its own.
pub(super) fn unwrap(mesh: &Mesh) -> Surface {
    let facing = facing(mesh);
    let panels = panels(mesh, facing);
    let mut surface = Surface::default();
    let mut left = 0.0;
    for panel in 0..=panels.iter().copied().max().unwrap_or(0) {
        let chosen: Vec<[u32; 3]> =
            mesh.triangles.iter().zip(&panels).filter(|(_, p)| **p == panel).map(|(t, _)| *t).collect();
        let mut number = BTreeMap::new();
        let mut vertices = Vec::new();
        let first = surface.vertex.len() as u32;
        let triangles: Vec<[u32; 3]> = chosen
            .iter()
            .map(|t| {
                t.map(|v| {
                    *number.entry(v).or_insert_with(|| {
                        vertices.push(v);
                        vertices.len() as u32 - 1
                    })
                })
            })
            .collect();
        let positions: Vec<DVec3> = vertices.iter().map(|&v| mesh.positions[v as usize]).collect();
        let mut uv = flatten(&positions, &triangles, project(&positions, &triangles, facing));
        let low = uv.iter().fold(DVec2::INFINITY, |low, p| low.min(*p));
        uv.iter_mut().for_each(|p| *p += DVec2::new(left, 0.0) - low);
        left = uv.iter().fold(left, |left, p| left.max(p.x)) + GAP;
        surface.vertex.extend(vertices);
        surface.uv.extend(uv);
        surface.triangles.extend(triangles.iter().map(|t| t.map(|v| v + first)));
    }
    surface
}

/// The direction most of the surface faces (either way): first axis of the normals, by power iteration.
fn facing(mesh: &Mesh) -> DVec3 {
    let mut spread = DMat3::ZERO;
    for corners in mesh.corners() {
        let normal = triangle::cross(corners);
        let unit = normal.normalize_or_zero();
        spread += DMat3::from_cols(normal * unit.x, normal * unit.y, normal * unit.z);
    }
    // Started off every axis, so that no body's symmetry makes it orthogonal to the answer.
    (0..200).fold(DVec3::new(0.51, 0.33, 0.79), |axis, _| (spread * axis).normalize_or(DVec3::Z))
}

/// Panel per triangle: connected pieces facing one way. Sides are smoothed first so that seams run straight, and small
/// islands join what surrounds them.
fn panels(mesh: &Mesh, facing: DVec3) -> Vec<usize> {
    let mut side: Vec<f64> = mesh.normals(&mesh.positions).iter().map(|normal| normal.dot(facing)).collect();
    for _ in 0..12 {
        let mut sums = vec![(0.0, 0.0); side.len()];
        for t in &mesh.triangles {
            let sum: f64 = t.iter().map(|&v| side[v as usize]).sum();
            t.iter().for_each(|&v| sums[v as usize] = (sums[v as usize].0 + sum, sums[v as usize].1 + 3.0));
        }
        side = sums.iter().map(|(sum, count)| sum / f64::max(*count, 1.0)).collect();
    }
    let mut front: Vec<bool> =
        mesh.triangles.iter().map(|t| t.iter().map(|&v| side[v as usize]).sum::<f64>() > 0.0).collect();
    let mut pieces = pieces(mesh, &front);
    for _ in 0..4 {
        let count = pieces.iter().max().map_or(0, |last| last + 1);
        let mut size = vec![0; count];
        pieces.iter().for_each(|&piece| size[piece] += 1);
        let small = |piece: usize| size[piece] * 50 < mesh.triangles.len();
        if !(0..count).any(small) {
            break;
        }
        front.iter_mut().zip(&pieces).for_each(|(front, &piece)| *front ^= small(piece));
        pieces = self::pieces(mesh, &front);
    }
    pieces
}

/// Connected pieces of triangles on the same side, numbered in triangle order.
fn pieces(mesh: &Mesh, front: &[bool]) -> Vec<usize> {
    let mut joined = Components::new(mesh.triangles.len());
    for (_, sides) in Edges::new(&mesh.triangles).iter() {
        for (a, b) in sides.iter().flat_map(|a| sides.iter().map(move |b| (a.triangle, b.triangle))) {
            if front[a] == front[b] {
                joined.join([a, b]);
            }
        }
    }
    let mut number = BTreeMap::new();
    (0..mesh.triangles.len())
        .map(|triangle| {
            let next = number.len();
            *number.entry(joined.of(triangle)).or_insert(next)
        })
        .collect()
}

/// Panel seen straight on from outside, +Y up where possible: positions [v] -> UV [v], metres.
fn project(positions: &[DVec3], triangles: &[[u32; 3]], facing: DVec3) -> Vec<DVec2> {
    let sum: DVec3 = triangles.iter().map(|t| triangle::cross(t.map(|v| positions[v as usize]))).sum();
    let towards = if sum.dot(facing) < 0.0 { -facing } else { facing };
    let right = DVec3::Y.cross(towards).try_normalize().unwrap_or(DVec3::X);
    let up = towards.cross(right);
    positions.iter().map(|p| DVec2::new(p.dot(right), p.dot(up))).collect()
}

/// As-rigid-as-possible flattening from a first guess; the guess comes back where the system cannot be solved.
fn flatten(positions: &[DVec3], triangles: &[[u32; 3]], mut uv: Vec<DVec2>) -> Vec<DVec2> {
    // Each triangle laid flat: its edges k -> k+1 as vectors of the plane.
    let flat: Vec<[DVec2; 3]> = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            let right = (b - a).normalize_or(DVec3::X);
            let up = triangle::cross([a, b, c]).cross(right).normalize_or(DVec3::Y);
            let [p, q, r] = [a, b, c].map(|x| DVec2::new((x - a).dot(right), (x - a).dot(up)));
            [q - p, r - q, p - r]
        })
        .collect();
    let count = positions.len();
    let mut entries = vec![Triplet::new(0, 0, 1.0)];
    for t in triangles {
        for k in 0..3 {
            let (a, b) = (t[k] as usize, t[(k + 1) % 3] as usize);
            entries
                .extend([(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)].map(|(i, j, w)| Triplet::new(i, j, w)));
        }
    }
    let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(count, count, &entries).ok();
    let Some(factor) = matrix.and_then(|matrix| matrix.sp_cholesky(Side::Lower).ok()) else { return uv };
    for _ in 0..30 {
        let mut right = Mat::<f64>::zeros(count, 2);
        (right[(0, 0)], right[(0, 1)]) = (uv[0].x, uv[0].y);
        for (t, edges) in triangles.iter().zip(&flat) {
            let (mut cos, mut sin) = (0.0, 0.0);
            for k in 0..3 {
                let now = uv[t[(k + 1) % 3] as usize] - uv[t[k] as usize];
                cos += edges[k].dot(now);
                sin += edges[k].perp_dot(now);
            }
            let turn = DVec2::new(cos, sin).normalize_or(DVec2::X);
            for k in 0..3 {
                let edge = turn.rotate(edges[k]);
                for (vertex, sign) in [(t[(k + 1) % 3] as usize, 1.0), (t[k] as usize, -1.0)] {
                    right[(vertex, 0)] += sign * edge.x;
                    right[(vertex, 1)] += sign * edge.y;
                }
            }
        }
        let solved = factor.solve(&right);
        (0..count).for_each(|v| uv[v] = DVec2::new(solved[(v, 0)], solved[(v, 1)]));
    }
    uv
}
