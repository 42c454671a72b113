//! The body a model carries for the repair of penetration: the character's outer skin, as much of it as the cloth comes near, and for
//! every cloth vertex the places where it was seen. ARCHITECTURE.md, "Penetration".

use crate::Result;
use crate::dataset::{Sample, Setup};
use crate::garment::apart;
use crate::rig::{Character, Mesh, Pose, numbers, pose, vertices};
use crate::simulate::{covering, felt, hull, to_body_frame};
use ctsn_core::cpu::Level;
use ctsn_core::cpu::bury::{Dipoles, bury, is_away};
use ctsn_core::cpu::collide::LANDMARKS;
use ctsn_core::cpu::normals::normals;
use ctsn_core::model::{Body, Skin, areas};
use ctsn_core::topology::Graph;
use glam::DVec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// Vertices of the whole skin, about: twice as many triangles.
const VERTICES: usize = 2600;
/// Poses looked at, spread over the samples. With 200 of 2,093 a robe's deepest unseen vertex stayed 20.6 mm inside, with 600 and with all
/// of them 8.7 mm.
const POSES: usize = 600;
/// Poses that the skin is raised for, spread over the samples.
const BENT: usize = 60;
/// Poses that are searched for skin inside another part of the body, spread over the samples.
const CREASED: usize = 150;
/// Cloth that near to a vertex inside another part of the body would be kept out of it, metres.
const BESIDE: f64 = 0.03;
/// Cloth further from the skin says nothing about it, metres.
const REACH: f64 = 0.15;
/// Rings of vertices around what the cloth came near that are kept: repaired cloth must not meet the border.
const RINGS: usize = 3;
/// Places per cloth vertex from which the closest one is searched.
const SEEDS: usize = 4;
/// A triangle drawn to so many times its length is none of the body.
const TORN: f64 = 6.0;
/// A search that ends so much too far has missed the closest place, metres.
const MISSED: f64 = 0.004;

/// The body for the cloth of `setup`, as `samples` wear it.
pub fn body(setup: &Setup, samples: &[&Sample]) -> Result<Body<Vec<f32>, Vec<u32>>> {
    let character = setup.character()?;
    // What the simulated cloth did not feel is in its way nowhere: a figure's hands sank into its skirt, and trembled there.
    let felt = felt(&character, &setup.cloth())?;
    let every = |count: usize| samples.iter().step_by(samples.len().div_ceil(count).max(1));
    let bent: Vec<_> = every(BENT).map(|sample| character.skinning(&framed(&character, sample))).collect();
    let skin = hull(&character, &apart(&character), VERTICES)?;
    let mut skin = covering(skin, &character, &bent).part(|joint| felt[joint]);
    let poses: Vec<&&Sample> = every(POSES).collect();
    tear(&mut skin, &poses);
    let nearest = |sample: &&&Sample| nearest(&skin, sample);
    let seen: Vec<Vec<Option<u32>>> = poses.par_iter().map(nearest).collect::<Result<_>>()?;
    let mut visits = vec![BTreeMap::new(); setup.template.len() / 3];
    for (vertex, place) in seen.iter().flat_map(|seen| seen.iter().enumerate()) {
        place.iter().for_each(|place| *visits[vertex].entry(*place).or_insert(0) += 1);
    }
    let mut seeds: Vec<[u32; SEEDS]> = visits.iter().map(|visits| spread(&skin.body.positions, visits)).collect();
    let around = Graph::new(skin.body.positions.len(), skin.body.triangles.as_flattened());
    let missed = |(sample, seen): (&&&Sample, &Vec<_>)| missed(&skin, &around, &seeds, sample, seen);
    let missed: Vec<Vec<Option<u32>>> = poses.par_iter().zip(&seen).map(missed).collect();
    add_other_side(&mut seeds, &missed, &Graph::new(setup.template.len() / 3, &setup.triangles));
    let kept = kept(&skin, &visits, &seeds);
    skin.body.triangles.retain(|triangle| triangle.iter().all(|i| kept[*i as usize]));
    let buried = buried(&skin, &every(CREASED).collect::<Vec<_>>());
    Ok(cut(&skin, &kept, &seeds, &buried))
}

/// How many cloth vertices were beside each vertex of the skin while that was inside another part of the body.
fn buried(skin: &Character, poses: &[&&Sample]) -> Vec<usize> {
    let count = skin.body.positions.len();
    let all = numbers(&skin.body.positions);
    let areas = areas(&all, skin.body.triangles.as_flattened());
    let beside = |sample: &&&Sample| {
        let places = skin.pose_body(&framed(skin, sample));
        let posed = numbers(&places);
        let (mut up, mut exposed) = (posed.clone(), posed.clone());
        normals(&posed, skin.body.triangles.as_flattened(), &mut up);
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

/// Drops triangles that some pose draws long: a coarse skin joins legs that nearly touch in the canonical pose, and spans what is between
/// them when they part. (A skirt's hem was thrown 79 mm off by such a web, and trembled twice as much.)
fn tear(skin: &mut Character, poses: &[&&Sample]) {
    let longest = |corners: [DVec3; 3]| (0..3).map(|k| corners[k].distance(corners[(k + 1) % 3])).fold(0.0, f64::max);
    let lengths = |positions: &[DVec3]| -> Vec<f64> {
        skin.body.triangles.iter().map(|triangle| longest(triangle.map(|i| positions[i as usize]))).collect()
    };
    let rest = lengths(&skin.body.positions);
    let whole = |sample: &&&Sample| -> Vec<bool> {
        let posed = lengths(&skin.pose_body(&framed(skin, sample)));
        posed.iter().zip(&rest).map(|(posed, rest)| *posed < TORN * rest).collect()
    };
    let all = |a: Vec<bool>, b: Vec<bool>| a.iter().zip(&b).map(|(a, b)| *a && *b).collect();
    let whole = poses.par_iter().map(whole).reduce(|| vec![true; rest.len()], all);
    let mut whole = whole.iter();
    skin.body.triangles.retain(|_| whole.next() == Some(&true));
}

/// The pose of a sample in its body frame.
fn framed(character: &Character, sample: &Sample) -> Pose {
    to_body_frame(character, &pose(&sample.joints))
}

/// The skin vertex closest to each cloth vertex of a pose.
fn nearest(skin: &Character, sample: &Sample) -> Result<Vec<Option<u32>>> {
    let posed = skin.pose_body(&framed(skin, sample));
    let points: Vec<[f64; 3]> = posed.iter().map(|point| point.to_array()).collect();
    let tree: ImmutableKdTree<f64, 3> = ImmutableKdTree::new_from_slice(&points)
        .map_err(|error| crate::Error::Character(format!("nearest-vertex search: {error:?}")))?;
    let place = |vertex: &DVec3| {
        let found = tree.query(&vertex.to_array()).nearest_one::<SquaredEuclidean<f64>>().execute();
        (found.distance < REACH * REACH).then_some(found.item as u32)
    };
    Ok(vertices(&sample.truth).iter().map(place).collect())
}

/// The place seen most, then always the one that brings what was seen nearest to a seed; the last is left the first.
fn spread(positions: &[DVec3], visits: &BTreeMap<u32, usize>) -> [u32; SEEDS] {
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

/// The place closest to each cloth vertex of a pose, where the way downhill from its seeds ends at another, at least [`MISSED`] further
/// away: on the other side of a crease as in an armpit, or on another limb.
fn missed(
    skin: &Character,
    around: &Graph<Vec<u32>>,
    seeds: &[[u32; SEEDS]],
    sample: &Sample,
    seen: &[Option<u32>],
) -> Vec<Option<u32>> {
    let posed = skin.pose_body(&framed(skin, sample));
    let find = |((vertex, seeds), seen): ((DVec3, &[u32; SEEDS]), &Option<u32>)| {
        let distance = |place: u32| posed[place as usize].distance(vertex);
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
    vertices(&sample.truth).into_iter().zip(seeds).zip(seen).map(find).collect()
}

/// Makes the place that was missed most, by a vertex or its neighbours, its last seed.
fn add_other_side(seeds: &mut [[u32; SEEDS]], missed: &[Vec<Option<u32>>], cloth: &Graph<Vec<u32>>) {
    for (vertex, seeds) in seeds.iter_mut().enumerate() {
        let mut visits = BTreeMap::new();
        for near in cloth.of(vertex).iter().map(|near| *near as usize).chain([vertex]) {
            missed.iter().filter_map(|missed| missed[near]).for_each(|place| *visits.entry(place).or_insert(0) += 1);
        }
        seeds[SEEDS - 1] = most(&visits).unwrap_or(seeds[0]);
    }
}

/// Puts places that lie evenly over the skin first in `list`, as cloth far from its seeds is searched from there: always the one
/// furthest from those before.
fn landmarks_first(positions: &[DVec3], list: &mut [usize]) {
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

/// The part of the skin that was seen, [`RINGS`] rings around it included.
fn kept(skin: &Character, visits: &[BTreeMap<u32, usize>], seeds: &[[u32; SEEDS]]) -> Vec<bool> {
    let Mesh { positions, triangles } = &skin.body;
    let graph = Graph::new(positions.len(), triangles.as_flattened());
    let mut kept = vec![false; positions.len()];
    // Cloth that was never near has the first vertex for a seed.
    let places = visits.iter().flat_map(|visits| visits.keys()).chain(seeds.as_flattened());
    places.for_each(|place| kept[*place as usize] = true);
    for _ in 0..RINGS {
        let before = kept.clone();
        (0..kept.len()).for_each(|i| kept[i] |= graph.of(i).iter().any(|j| before[*j as usize]));
    }
    kept
}

/// The kept vertices of the skin, whose triangles are theirs: landmarks, which no pose looked at buries beside cloth, then what is buried
/// most, then the others.
fn cut(skin: &Character, kept: &[bool], seeds: &[[u32; SEEDS]], buried: &[usize]) -> Body<Vec<f32>, Vec<u32>> {
    let Mesh { positions, triangles } = &skin.body;
    let (mut list, inside): (Vec<usize>, Vec<usize>) =
        (0..kept.len()).filter(|i| kept[*i]).partition(|i| buried[*i] == 0);
    landmarks_first(positions, &mut list);
    list.extend(inside);
    let others = LANDMARKS.min(list.len());
    // What is pressed into the figure pushes its cloth, not the other way round.
    let is_obstacle = |vertex: usize| skin.weights[vertex].iter().any(|(joint, _)| skin.is_obstacle(*joint));
    list[others..].sort_by_cached_key(|vertex| (is_obstacle(*vertex), Reverse(buried[*vertex])));
    let mut place = vec![0; kept.len()];
    list.iter().enumerate().for_each(|(new, old)| place[*old] = new as u32);
    let triangles: Vec<u32> = triangles.iter().flatten().map(|i| place[*i as usize]).collect();
    let width = list.iter().map(|i| skin.weights[*i].len()).max().unwrap_or(1).max(1);
    let mut slots = Skin { joints: Vec::new(), weights: Vec::new(), width };
    for (row, vertex) in list.iter().enumerate() {
        slots.joints.extend(skin.weights[*vertex].iter().map(|(joint, _)| *joint as u32));
        slots.weights.extend(skin.weights[*vertex].iter().map(|(_, weight)| *weight as f32));
        slots.joints.resize((row + 1) * width, 0);
        slots.weights.resize((row + 1) * width, 0.0);
    }
    let rest = list.iter().flat_map(|i| positions[*i].as_vec3().to_array()).collect();
    Body::new(rest, slots, triangles, seeds.as_flattened().iter().map(|seed| place[*seed as usize]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;

    #[test]
    fn what_spans_two_limbs_is_dropped() {
        let (setup, mut samples) = synthetic::dataset(120, 2, 2);
        let mut skin = setup.character().unwrap();
        let half = skin.weights.len() / 2;
        (0..skin.weights.len()).for_each(|i| skin.weights[i] = vec![(usize::from(i >= half), 1.0)]);
        let torn = |samples: &[Sample]| {
            let mut skin = skin.clone();
            tear(&mut skin, &samples.iter().collect::<Vec<_>>().iter().collect::<Vec<_>>());
            skin.body.triangles
        };
        assert_eq!(torn(&samples), skin.body.triangles);
        // The second joint leaves by five metres, in one pose of two.
        samples[1].joints[12 + 7] += 5.0;
        let one =
            |triangle: &&[u32; 3]| triangle.iter().all(|i| (*i as usize >= half) == (triangle[0] as usize >= half));
        let kept: Vec<[u32; 3]> = skin.body.triangles.iter().filter(one).copied().collect();
        assert!(kept.len() < skin.body.triangles.len());
        assert_eq!(torn(&samples), kept);
    }

    #[test]
    fn what_the_cloth_does_not_feel_is_no_obstacle() {
        let (mut setup, samples) = synthetic::dataset(400, 6, 2);
        // Cloth around the lowest 0.45 m of 1.5.
        setup.template.iter_mut().skip(1).step_by(3).for_each(|height| *height *= 0.3);
        let body = body(&setup, &samples.iter().collect::<Vec<_>>()).unwrap();
        let top = body.rest.iter().skip(1).step_by(3).fold(0.0, |top: f32, height| top.max(*height));
        assert!((0.7..1.1).contains(&top), "kept up to {top} m");
    }

    #[test]
    fn landmarks_lie_evenly() {
        let line: Vec<DVec3> = (0..1000).map(|i| DVec3::X * f64::from(i)).collect();
        let mut list: Vec<usize> = (0..line.len()).collect();
        landmarks_first(&line, &mut list);
        let mut landmarks = list[..LANDMARKS].to_vec();
        landmarks.sort_unstable();
        let widest = landmarks.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap();
        // 1000 / 64, at most twice that after halving and halving.
        assert!((landmarks[0], landmarks[LANDMARKS - 1]) == (0, 999) && widest <= 32, "{landmarks:?}");
        list.sort_unstable();
        assert!(list.into_iter().eq(0..line.len()));
    }
}
