//! The body the cloth touches: the outer skin of the character's body, skinned by the body under it.
//! Against the body itself cloth was caught between the shells and joint balls of real characters, and on the sharp ridges of
//! coarse ones: no pose of a 49,000-triangle figure of two nested meshes converged.

use std::collections::BTreeMap;

use super::collider::{Collider, blend, check};
use super::cover::Cover;
use crate::garment;
use crate::rig::{Character, Mesh, Pose, SkinWeights};
use crate::triangle;
use crate::{Error, Result};
use glam::DAffine3;
use rayon::prelude::*;

/// What stays between the skin and the body, metres.
const GAP: f64 = 0.0015;
/// Rounds of averaging over the skin's neighbours, so that coarse bodies do not bend it in steps.
const ROUNDS: usize = 4;
/// How far the skin is raised for what comes out in some poses only, in mean edges: coarser triangles cut off more. (With 3 mm, X Bot's knees
/// stayed up to 2.7 mm inside, of edges of 30 mm; with 6 mm, the thin legs of a fox, of edges of 15 mm, made a cape tremble by half as
/// much again.)
const HIGHEST: f64 = 0.2;
/// Joints a vertex of the skin may follow.
const JOINTS: usize = 6;

/// Fewest vertices of the skin of a part.
const FEWEST: usize = 200;

/// The character with its outer skin, of about so many vertices, for a body: one closed mesh for the figure and one for each obstacle, so
/// that one far away does not coarsen the figure's and one in a hand stays stiff. Vertices are dealt by area;
/// each follows the body point under it. It is wrapped around the body in `pose` (world), and brought back to the canonical one.
pub fn hull(character: &Character, pose: &Pose, vertices: usize) -> Result<Character> {
    check(character)?;
    let joints = 0..character.joints.len();
    let figure = character.part(|joint| !character.is_obstacle(joint));
    let obstacles = joints.filter(|at| character.is_obstacle(*at)).map(|at| character.part(|joint| joint == at));
    let parts: Vec<Character> =
        std::iter::once(figure).chain(obstacles).filter(|part| !part.body.triangles.is_empty()).collect();
    let areas: Vec<f64> = parts.iter().map(|part| area(&part.body)).collect();
    let whole = areas.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let (mut body, mut weights) = (Mesh::default(), Vec::new());
    for (part, area) in parts.iter().zip(areas) {
        let skin = part_hull(part, pose, ((vertices as f64 * area / whole) as usize).max(FEWEST))?;
        let first = body.positions.len() as u32;
        body.triangles.extend(skin.body.triangles.iter().map(|triangle| triangle.map(|corner| first + corner)));
        body.positions.extend(skin.body.positions);
        weights.extend(skin.weights);
    }
    match body.triangles.is_empty() {
        true => Err(Error::Character("the body encloses nothing a garment could touch".into())),
        false => Ok(Character { body, weights, ..character.clone() }),
    }
}

/// `skin` raised over what of the body comes out through it: all of the canonical one (the triangles of a coarse skin cut off thumbs), and
/// [`HIGHEST`] in other poses, `A_j` [J] each, where knees come out. (Raised over all of it, the skin of a robot of loose shells threw a
/// skirt 40 mm off.)
pub fn covering(skin: Character, character: &Character, poses: &[Vec<DAffine3>]) -> Character {
    let all = vec![true; skin.joints.len()];
    let [body, collider] = [character, &skin].map(|character| Collider::of_joints(character, &all));
    let cover = Cover::new(&body, &collider, 0.0);
    let heights = |skinning: &Vec<DAffine3>| cover.heights(&body.pose(skinning), &collider, skinning);
    let canonical = vec![DAffine3::IDENTITY; all.len()];
    let higher = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(&b).map(|(a, b)| a.max(*b)).collect();
    let posed = poses.par_iter().map(heights).reduce(|| vec![0.0; collider.rest.len()], higher);
    let highest = HIGHEST * mean_edge(&skin.body);
    let raised: Vec<f64> =
        heights(&canonical).iter().zip(posed).map(|(own, posed)| own.max(posed.min(highest))).collect();
    let positions = collider.pose(&canonical).offset(&raised, 1.0);
    Character { body: Mesh { positions, triangles: collider.faces }, weights: collider.weights, ..skin }
}

/// Mean edge length of a mesh, metres.
fn mean_edge(mesh: &Mesh) -> f64 {
    let corners = mesh.triangles.iter().map(|triangle| triangle.map(|i| mesh.positions[i as usize]));
    let lengths = corners.flat_map(|[a, b, c]| [a.distance(b), b.distance(c), c.distance(a)]);
    lengths.sum::<f64>() / (3 * mesh.triangles.len()).max(1) as f64
}

/// Area of a mesh, square metres.
fn area(mesh: &Mesh) -> f64 {
    let corners = mesh.triangles.iter().map(|triangle| triangle.map(|i| mesh.positions[i as usize]));
    corners.map(triangle::area).sum()
}

/// The outer skin of all of a body.
fn part_hull(character: &Character, pose: &Pose, vertices: usize) -> Result<Character> {
    let positions = character.pose_body(pose);
    let body = Mesh { positions, triangles: character.body.triangles.clone() };
    let (mut mesh, distance) = garment::hull(&Character { body, ..character.clone() }, vertices)?;
    let collider = Collider::of_joints(character, &vec![true; character.joints.len()]);
    let skinning = character.skinning(pose);
    let body = collider.pose(&skinning);
    let mut weights: Vec<SkinWeights> = Vec::with_capacity(mesh.positions.len());
    for position in &mut mesh.positions {
        let Some(hit) = body.closest(*position, None, 10.0 * distance) else {
            weights.push(weights.last().cloned().unwrap_or_else(|| vec![(character.root, 1.0)]));
            continue;
        };
        weights.push(collider.skin(hit.face, hit.barycentric));
        *position -= hit.normal * (distance - GAP).min(hit.distance - GAP);
    }
    weights.iter_mut().for_each(keep_strongest);
    for (position, weights) in mesh.positions.iter_mut().zip(&weights) {
        *position = blend(weights, &skinning).inverse().transform_point3(*position);
    }
    Ok(Character { body: mesh, weights, ..character.clone() })
}

/// Keeps the weights of the strongest joints.
fn keep_strongest(row: &mut SkinWeights) {
    row.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    row.truncate(JOINTS);
    let total: f64 = row.iter().map(|(_, weight)| weight).sum();
    row.iter_mut().for_each(|(_, weight)| *weight /= total);
}

/// Averages the weights of a fine skin over its neighbours. On a coarse one that would reach so far that it no longer follows the body.
pub(super) fn smooth(skin: &mut Character) {
    let Character { body: mesh, weights, .. } = skin;
    let mut neighbours = vec![Vec::new(); mesh.positions.len()];
    for triangle in &mesh.triangles {
        for k in 0..3 {
            neighbours[triangle[k] as usize].push(triangle[(k + 1) % 3] as usize);
        }
    }
    for _ in 0..ROUNDS {
        let mean = |(own, neighbours): (&SkinWeights, &Vec<usize>)| {
            let mut sum = BTreeMap::new();
            let share = 0.5 / neighbours.len().max(1) as f64;
            let all = neighbours.iter().map(|j| (&weights[*j], share)).chain([(own, 0.5)]);
            for (row, share) in all {
                row.iter().for_each(|(joint, weight)| *sum.entry(*joint).or_insert(0.0) += share * weight);
            }
            let mut row: SkinWeights = sum.into_iter().collect();
            keep_strongest(&mut row);
            row
        };
        *weights = weights.iter().zip(&neighbours).map(mean).collect();
    }
}
