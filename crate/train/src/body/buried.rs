//! Where the skin is inside another part of the body.

use super::skinning;
use crate::dataset::Sample;
use ctsn_core::cpu::repair::bury::{Dipoles, bury, is_away};
use ctsn_core::cpu::{Cpu, Level};
use ctsn_core::model::areas;
use ctsn_core::operation::Normals;
use ctsn_rig::{Character, SkinnedMesh, numbers, vertices};
use glam::DVec3;
use rayon::prelude::*;

/// Cloth that near to a vertex inside another part of the body would be kept out of it, metres.
const BESIDE: f64 = 0.03;

/// How many cloth vertices were beside each vertex of the skin while that was inside another part of the body.
pub(super) fn buried(skin: &SkinnedMesh, character: &Character, poses: &[&&Sample]) -> Vec<usize> {
    let count = skin.mesh.positions.len();
    let all = numbers(&skin.mesh.positions);
    let areas = areas(&all, skin.mesh.triangles.as_flattened());
    let beside = |sample: &&&Sample| {
        let places = skin.pose(&skinning(character, sample));
        let posed = numbers(&places);
        let (mut up, mut exposed) = (posed.clone(), posed.clone());
        let triangles = skin.mesh.triangles.as_flattened();
        Cpu::new().compute(Normals { positions: &posed[..], triangles, normals: &mut up[..] });
        bury(Level::new(), &posed, &up, &areas, 0..count, &mut Dipoles::default(), &mut exposed);
        let cloth = vertices(&sample.truth);
        let near = |(place, seen): (&DVec3, &[f32; 3])| match is_away(seen) {
            true => cloth.iter().filter(|vertex| vertex.distance(*place) < BESIDE).count(),
            false => 0,
        };
        places.iter().zip(exposed.as_chunks().0).map(near).collect()
    };
    let sum = |a: Vec<usize>, b: Vec<usize>| a.iter().zip(&b).map(|(a, b)| a + b).collect();
    poses.par_iter().map(beside).reduce(|| vec![0; count], sum)
}
