//! Webs between parts of the body that part.

use super::skinning;
use crate::dataset::Sample;
use ctsn_rig::{Character, SkinnedMesh};
use glam::DVec3;
use rayon::prelude::*;

/// A triangle drawn to so many times its length is none of the body.
const TORN: f64 = 6.0;

/// Drops triangles that some pose draws long: a coarse skin joins legs that nearly touch in the canonical pose, and
/// spans what is between them when they part. (A skirt's hem was thrown 79 mm off by such a web, and trembled twice as
/// much.)
pub(super) fn tear(skin: &mut SkinnedMesh, character: &Character, poses: &[&&Sample]) {
    let longest = |corners: [DVec3; 3]| (0..3).map(|k| corners[k].distance(corners[(k + 1) % 3])).fold(0.0, f64::max);
    let lengths = |positions: &[DVec3]| -> Vec<f64> {
        skin.mesh.triangles.iter().map(|triangle| longest(triangle.map(|i| positions[i as usize]))).collect()
    };
    let rest = lengths(&skin.mesh.positions);
    let whole = |sample: &&&Sample| -> Vec<bool> {
        let posed = lengths(&skin.pose(&skinning(character, sample)));
        posed.iter().zip(&rest).map(|(posed, rest)| *posed < TORN * rest).collect()
    };
    let all = |a: Vec<bool>, b: Vec<bool>| a.iter().zip(&b).map(|(a, b)| *a && *b).collect();
    let whole = poses.par_iter().map(whole).reduce(|| vec![true; rest.len()], all);
    let mut whole = whole.iter();
    skin.mesh.triangles.retain(|_| whole.next() == Some(&true));
}
