//! The part of the skin that is kept, in the order the repair wants it in.

use super::seeds::SEEDS;
use ctsn_core::cpu::repair::collide::LANDMARKS;
use ctsn_core::model::{Body, Skinning};
use ctsn_rig::{Mesh, SkinnedMesh};
use glam::DVec3;

/// Puts places that lie evenly over the skin first in `list`, as cloth far from its seeds is searched from there:
/// always the one furthest from those before.
pub(super) fn landmarks_first(positions: &[DVec3], list: &mut [usize]) {
    let mut distances = vec![f64::INFINITY; list.len()];
    for next in 0..LANDMARKS.min(list.len()) {
        let furthest = (next..list.len()).max_by(|a, b| distances[*a].total_cmp(&distances[*b])).unwrap_or(next);
        list.swap(next, furthest);
        distances.swap(next, furthest);
        let landmark = positions[list[next]];
        let nearer =
            |(distance, place): (&mut f64, &usize)| *distance = distance.min(positions[*place].distance(landmark));
        distances.iter_mut().zip(list.iter()).for_each(nearer);
    }
}

/// The kept vertices of the skin, whose triangles are theirs: landmarks, then the others.
pub(super) fn cut(skin: &SkinnedMesh, kept: &[bool], seeds: &[[u32; SEEDS]]) -> Body<Vec<f32>, Vec<u32>> {
    let Mesh { positions, triangles } = &skin.mesh;
    let mut list: Vec<usize> = (0..kept.len()).filter(|i| kept[*i]).collect();
    landmarks_first(positions, &mut list);
    let mut place = vec![0; kept.len()];
    list.iter().enumerate().for_each(|(new, old)| place[*old] = new as u32);
    let triangles: Vec<u32> = triangles.iter().flatten().map(|i| place[*i as usize]).collect();
    let width = list.iter().map(|i| skin.weights[*i].len()).max().unwrap_or(1).max(1);
    let mut slots = Skinning { joints: Vec::new(), weights: Vec::new(), width };
    for (row, vertex) in list.iter().enumerate() {
        slots.joints.extend(skin.weights[*vertex].iter().map(|(joint, _)| *joint as u32));
        slots.weights.extend(skin.weights[*vertex].iter().map(|(_, weight)| *weight as f32));
        slots.joints.resize((row + 1) * width, 0);
        slots.weights.resize((row + 1) * width, 0.0);
    }
    let rest = list.iter().flat_map(|i| positions[*i].as_vec3().to_array()).collect();
    Body::new(rest, slots, triangles, seeds.as_flattened().iter().map(|seed| place[*seed as usize]).collect())
}
