//! What each vertex of the drawn mesh rides on: the nearest triangle of its side of the cloth, the place on it from
//! which the normal between its corners' normals leads to the vertex, and how far. simulation.md §4.4.

use super::layers::Layer;
use super::split::Split;
use crate::wrap::Faces;
use ctsn_rig::mesh::triangle::{closest, cross, point};
use ctsn_rig::{Mesh, Rider};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// A vertex beyond the rim of the cloth rides on the plane of its triangle, up to such coordinates; farther away it
/// keeps its offset alone.
const BEYOND: f64 = 3.0;
/// Rounds of Newton's method: the fifth digit is there after three.
const ROUNDS: usize = 8;

/// The riders of `drawn`, whose faces are of these `layers`, on the `cloth`. A vertex that halves an edge is as far from
/// the cloth as the ends of the edge are: the cloth is round where the artist's faces were flat.
pub(super) fn bind(drawn: &Split, layers: &[Layer], cloth: &Mesh) -> Vec<Rider> {
    let layers: Vec<Layer> = drawn.faces.iter().map(|face| layers[*face]).collect();
    let mut riders = nearest(&drawn.mesh, &layers, cloth);
    let first = riders.len() - drawn.parents.len();
    for (vertex, ends) in (first..).zip(&drawn.parents) {
        riders[vertex].coordinates[3] = 0.5 * ends.iter().map(|&end| riders[end as usize].coordinates[3]).sum::<f64>();
    }
    riders
}

/// What each vertex is nearest to.
fn nearest(drawn: &Mesh, layers: &[Layer], cloth: &Mesh) -> Vec<Rider> {
    let faces = Faces::new(cloth);
    let looks: Vec<DVec3> = cloth.corners().map(cross).collect();
    let normals = cloth.normals(&cloth.positions);
    let sides = sides(drawn, layers);
    let rider = |(place, side): (&DVec3, &DVec3)| {
        let alike = faces.nearest_of(*place, |face| looks[face].dot(*side) >= 0.0);
        let Some((face, _)) = alike.or_else(|| faces.nearest(*place)) else {
            return Rider { corners: [0; 3], coordinates: [1.0, 0.0, 0.0, 0.0] };
        };
        let corners = cloth.triangles[face];
        let places = corners.map(|v| cloth.positions[v as usize]);
        Rider { corners, coordinates: coordinates(*place, places, corners.map(|v| normals[v as usize])) }
    };
    drawn.positions.par_iter().zip(&sides).map(rider).collect()
}

/// The way that the cloth under each drawn vertex looks: as its faces do, or against those of a lining; none where
/// they do not tell.
fn sides(drawn: &Mesh, layers: &[Layer]) -> Vec<DVec3> {
    let mut sides = vec![DVec3::ZERO; drawn.positions.len()];
    for ((face, corners), layer) in drawn.triangles.iter().zip(drawn.corners()).zip(layers) {
        let look = match layer {
            Layer::Sheet => cross(corners),
            Layer::Inner => -cross(corners),
            // A button has all sides.
            Layer::Trimming => continue,
        };
        face.iter().for_each(|&v| sides[v as usize] += look);
    }
    sides
}

/// Barycentric coordinates and offset of a place over a triangle with these unit normals at its corners.
fn coordinates(place: DVec3, corners: [DVec3; 3], normals: [DVec3; 3]) -> [f64; 4] {
    let nearest = closest(place, corners);
    let between = |weights: [f64; 3]| point(normals, weights).normalize_or(cross(corners).normalize_or_zero());
    let plain = (place - point(corners, nearest)).dot(between(nearest));
    let ([mut u, mut v, _], mut offset) = (nearest, plain);
    for _ in 0..ROUNDS {
        let weights = [u, v, 1.0 - u - v];
        let normal = between(weights);
        let missing = place - point(corners, weights) - offset * normal;
        let bent = point(normals, weights).length().max(0.1);
        let along = |k: usize| corners[k] - corners[2] + (offset / bent) * (normals[k] - normals[2]);
        let step = DMat3::from_cols(along(0), along(1), normal);
        if step.determinant().abs() < f64::MIN_POSITIVE {
            break;
        }
        let step = step.inverse() * missing;
        (u, v, offset) = (u + step.x, v + step.y, offset + step.z);
    }
    let found = [u, v, 1.0 - u - v];
    let there = point(corners, found) + offset * between(found);
    let sound = found.iter().all(|share| share.abs() <= BEYOND) && there.distance(place) < 1e-6;
    let ([a, b, c], offset) = if sound { (found, offset) } else { (nearest, plain) };
    [a, b, c, offset]
}
