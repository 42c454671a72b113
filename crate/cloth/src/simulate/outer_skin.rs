//! The body the cloth touches: the outer skin of the character's body, skinned by the body under it.
//! Against the body itself cloth was caught between the shells and joint balls of real characters, and on the sharp
//! ridges of coarse ones: no pose of a 49,000-triangle figure of two nested meshes converged.

use std::collections::BTreeMap;

use super::collider::{Collider, blend, check};
use super::cover::Cover;
use crate::wrap;
use crate::{Error, Result};
use ctsn_rig::{Character, Mesh, Pose, SkinWeights, SkinnedMesh};
use glam::DAffine3;
use rayon::prelude::*;

/// What stays between the skin and the body, metres.
const GAP: f64 = 0.0015;
/// Rounds of averaging over the skin's neighbours, so that coarse bodies do not bend it in steps.
const ROUNDS: usize = 4;
/// How far the skin is raised for what comes out in some poses only, in mean edges: coarser triangles cut off more.
/// (With 3 mm, X Bot's knees stayed up to 2.7 mm inside, of edges of 30 mm; with 6 mm, the thin legs of a fox, of edges
/// of 15 mm, made a cape tremble by half as much again.)
const HIGHEST: f64 = 0.2;
/// Joints a vertex of the skin may follow.
const JOINTS: usize = 6;

/// Fewest vertices of the skin of a part.
const FEWEST: usize = 200;

/// The character's outer skin, of about so many vertices: one closed mesh for the figure and one for each obstacle, so
/// that one far away does not coarsen the figure's and one in a hand stays stiff. Vertices are dealt by area;
/// each follows the body point under it. It is wrapped around the body in `pose` (world), and brought back to the
/// canonical one.
pub fn outer_skin(character: &Character, pose: &Pose, vertices: usize) -> Result<SkinnedMesh> {
    let body = &character.body;
    check(character, body)?;
    let joints = 0..character.joints.len();
    let figure = body.part(|joint| !character.is_obstacle(joint));
    let obstacles = joints.filter(|at| character.is_obstacle(*at)).map(|at| body.part(|joint| joint == at));
    let parts: Vec<SkinnedMesh> =
        std::iter::once(figure).chain(obstacles).filter(|part| !part.mesh.triangles.is_empty()).collect();
    let areas: Vec<f64> = parts.iter().map(|part| part.mesh.area()).collect();
    let whole = areas.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let mut skin = SkinnedMesh::default();
    for (part, area) in parts.iter().zip(areas) {
        skin.extend(part_skin(character, part, pose, ((vertices as f64 * area / whole) as usize).max(FEWEST))?);
    }
    match skin.mesh.triangles.is_empty() {
        true => Err(Error::Character("the body encloses nothing a garment could touch".into())),
        false => Ok(skin),
    }
}

/// `skin` raised over what of the body comes out through it: all of the canonical one (the triangles of a coarse skin
/// cut off thumbs), and [`HIGHEST`] in other poses, `A_j` [J] each, where knees come out. (Raised over all of it, the
/// skin of a robot of loose shells threw a skirt 40 mm off.)
pub fn covering(skin: SkinnedMesh, character: &Character, poses: &[Vec<DAffine3>]) -> SkinnedMesh {
    let all = vec![true; character.joints.len()];
    let [body, collider] = [&character.body, &skin].map(|mesh| Collider::of_joints(mesh, &all));
    let cover = Cover::new(&body, &collider, 0.0);
    let heights = |skinning: &Vec<DAffine3>| cover.heights(&body.pose(skinning), &collider, skinning);
    let canonical = vec![DAffine3::IDENTITY; all.len()];
    let higher = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(&b).map(|(a, b)| a.max(*b)).collect();
    let posed = poses.par_iter().map(heights).reduce(|| vec![0.0; collider.body.weights.len()], higher);
    let highest = HIGHEST * mean_edge(&skin.mesh);
    let raised: Vec<f64> =
        heights(&canonical).iter().zip(posed).map(|(own, posed)| own.max(posed.min(highest))).collect();
    collider.reshaped(&raised)
}

/// Mean edge length of a mesh, metres.
fn mean_edge(mesh: &Mesh) -> f64 {
    let lengths = mesh.corners().flat_map(|[a, b, c]| [a.distance(b), b.distance(c), c.distance(a)]);
    lengths.sum::<f64>() / (3 * mesh.triangles.len()).max(1) as f64
}

/// The outer skin of all of a part of the character's body.
fn part_skin(character: &Character, part: &SkinnedMesh, pose: &Pose, vertices: usize) -> Result<SkinnedMesh> {
    let skinning = character.skinning(pose);
    let posed = Mesh { positions: part.pose(&skinning), triangles: part.mesh.triangles.clone() };
    let (mut mesh, distance) = wrap::outer_skin(&posed, vertices)?;
    let collider = Collider::of_joints(part, &vec![true; character.joints.len()]);
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
    Ok(SkinnedMesh { mesh, weights })
}

/// Keeps the weights of the strongest joints.
fn keep_strongest(row: &mut SkinWeights) {
    row.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    row.truncate(JOINTS);
    let total: f64 = row.iter().map(|(_, weight)| weight).sum();
    row.iter_mut().for_each(|(_, weight)| *weight /= total);
}

/// Averages the weights of a fine skin over its neighbours. On a coarse one that would reach so far that it no longer
/// follows the body.
pub(super) fn smooth(skin: &mut SkinnedMesh) {
    let SkinnedMesh { mesh, weights } = skin;
    let neighbours = mesh.successors();
    for _ in 0..ROUNDS {
        let mean = |(own, neighbours): (&SkinWeights, &Vec<u32>)| {
            let mut sum = BTreeMap::new();
            let share = 0.5 / neighbours.len().max(1) as f64;
            let all = neighbours.iter().map(|j| (&weights[*j as usize], share)).chain([(own, 0.5)]);
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
