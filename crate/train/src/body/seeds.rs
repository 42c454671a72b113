//! The places on the skin from which the one closest to a cloth vertex is searched.

use ctsn_core::topology::Graph;
use glam::DVec3;
use std::collections::BTreeMap;

/// Places per cloth vertex from which the closest one is searched.
pub(super) const SEEDS: usize = 4;

/// A search that ends so much too far has missed the closest place, metres.
const MISSED: f64 = 0.004;

/// The place seen most, then always the one that brings what was seen nearest to a seed; the last is left the first.
pub(super) fn spread(positions: &[DVec3], visits: &BTreeMap<u32, usize>) -> [u32; SEEDS] {
    let place = |vertex: &u32| positions[*vertex as usize];
    let first = most(visits).unwrap_or(0);
    let mut seeds = [first; SEEDS];
    let mut distances: Vec<f64> = visits.keys().map(|vertex| place(vertex).distance(place(&first))).collect();
    for seed in &mut seeds[1..SEEDS - 1] {
        let gain = |candidate: &u32| {
            let gain = |((vertex, count), before): ((&u32, &usize), &f64)| {
                (before - place(vertex).distance(place(candidate))).max(0.0) * *count as f64
            };
            visits.iter().zip(&distances).map(gain).sum::<f64>()
        };
        *seed = visits.keys().copied().max_by(|a, b| gain(a).total_cmp(&gain(b))).unwrap_or(first);
        let nearer = |(vertex, before): (&u32, &mut f64)| *before = before.min(place(vertex).distance(place(seed)));
        visits.keys().zip(&mut distances).for_each(nearer);
    }
    seeds
}

/// The place seen most, the first of equals.
fn most(visits: &BTreeMap<u32, usize>) -> Option<u32> {
    visits.iter().max_by(|a, b| a.1.cmp(b.1).then(b.0.cmp(a.0))).map(|most| *most.0)
}

/// The place of the posed skin closest to each vertex of `cloth`, where the way downhill from its seeds ends at
/// another, at least [`MISSED`] further away: on the other side of a crease as in an armpit, or on another limb.
pub(super) fn missed(
    posed: &[DVec3],
    around: &Graph<Vec<u32>>,
    seeds: &[[u32; SEEDS]],
    cloth: &[DVec3],
    seen: &[Option<u32>],
) -> Vec<Option<u32>> {
    let find = |((vertex, seeds), seen): ((&DVec3, &[u32; SEEDS]), &Option<u32>)| {
        let distance = |place: u32| posed[place as usize].distance(*vertex);
        let nearest = |places: &[u32], best: u32| {
            places.iter().fold(best, |best, place| if distance(*place) < distance(best) { *place } else { best })
        };
        let mut found = nearest(seeds, seeds[0]);
        loop {
            let next = nearest(around.of(found as usize), found);
            if next == found {
                break;
            }
            found = next;
        }
        seen.filter(|seen| distance(*seen) + MISSED < distance(found))
    };
    cloth.iter().zip(seeds).zip(seen).map(find).collect()
}

/// Makes the place that was missed most, by a vertex or its neighbours, its last seed.
pub(super) fn add_other_side(seeds: &mut [[u32; SEEDS]], missed: &[Vec<Option<u32>>], cloth: &Graph<Vec<u32>>) {
    for (vertex, seeds) in seeds.iter_mut().enumerate() {
        let mut visits = BTreeMap::new();
        for near in cloth.of(vertex).iter().map(|near| *near as usize).chain([vertex]) {
            missed.iter().filter_map(|missed| missed[near]).for_each(|place| *visits.entry(place).or_insert(0) += 1);
        }
        seeds[SEEDS - 1] = most(&visits).unwrap_or(seeds[0]);
    }
}
