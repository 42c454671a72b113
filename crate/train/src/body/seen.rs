//! What of the skin the cloth was seen at.

use super::seeds::SEEDS;
use super::skinning;
use crate::Result;
use crate::dataset::Sample;
use ctsn_rig::{Character, SkinnedMesh, vertices};
use glam::DVec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::collections::BTreeMap;

/// Cloth further from the skin says nothing about it, metres.
const REACH: f64 = 0.15;
/// Rings of vertices around what the cloth came near that are kept: repaired cloth must not meet the border.
const RINGS: usize = 3;

/// The skin vertex closest to each cloth vertex of a pose.
pub(super) fn nearest(skin: &SkinnedMesh, character: &Character, sample: &Sample) -> Result<Vec<Option<u32>>> {
    let posed = skin.pose(&skinning(character, sample));
    let points: Vec<[f64; 3]> = posed.iter().map(|point| point.to_array()).collect();
    let tree: ImmutableKdTree<f64, 3> = ImmutableKdTree::new_from_slice(&points)
        .map_err(|error| crate::Error::Character(format!("nearest-vertex search: {error:?}")))?;
    let place = |vertex: &DVec3| {
        let found = tree.query(&vertex.to_array()).nearest_one::<SquaredEuclidean<f64>>().execute();
        (found.distance < REACH * REACH).then_some(found.item as u32)
    };
    Ok(vertices(&sample.truth).iter().map(place).collect())
}

/// The part of the skin that was seen, [`RINGS`] rings around it included.
pub(super) fn kept(skin: &SkinnedMesh, visits: &[BTreeMap<u32, usize>], seeds: &[[u32; SEEDS]]) -> Vec<bool> {
    let rings = skin.mesh.rings();
    let mut kept = vec![false; skin.mesh.positions.len()];
    // Cloth that was never near has the first vertex for a seed.
    let places = visits.iter().flat_map(|visits| visits.keys()).chain(seeds.as_flattened());
    places.for_each(|place| kept[*place as usize] = true);
    for _ in 0..RINGS {
        let before = kept.clone();
        (0..kept.len()).for_each(|i| kept[i] |= rings.of(i).iter().any(|j| before[*j as usize]));
    }
    kept
}
