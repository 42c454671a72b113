//! Animals and props: closed oriented surfaces of a fair number of triangles, smooth weights, the size they claim.

use super::*;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

/// What is claimed of a figure: closed surfaces, triangles, height and length in metres.
struct Claim {
    name: &'static str,
    shells: i64,
    triangles: std::ops::RangeInclusive<usize>,
    height: std::ops::Range<f64>,
    length: std::ops::Range<f64>,
}

const CLAIMS: &[Claim] = &[
    // Body, nose, two eyes.
    Claim { name: "cat", shells: 4, triangles: 5_000..=15_000, height: 0.35..0.42, length: 0.60..0.72 },
    Claim { name: "fox", shells: 4, triangles: 5_000..=15_000, height: 0.52..0.62, length: 0.90..1.10 },
    // Body, two eyes.
    Claim { name: "dolphin", shells: 3, triangles: 5_000..=15_000, height: 0.60..0.85, length: 2.1..2.3 },
    Claim { name: "sphere", shells: 1, triangles: 1_000..=5_000, height: 0.59..0.61, length: 0.59..0.61 },
    Claim { name: "box", shells: 1, triangles: 1_000..=8_000, height: 0.38..0.42, length: 0.38..0.42 },
];

/// Built once: it takes seconds.
static ANIMALS: LazyLock<Vec<(&Claim, Character)>> = LazyLock::new(|| {
    let figure = |name: &str| FIGURES.iter().find(|(known, _)| *known == name).expect("a known figure").1;
    CLAIMS.iter().map(|claim| (claim, build(&figure(claim.name)))).collect()
});

#[test]
fn surfaces_are_closed_and_as_many_as_claimed() {
    for (claim, character) in ANIMALS.iter() {
        let body = &character.body;
        let mut edges: BTreeMap<(u32, u32), usize> = BTreeMap::new();
        for t in &body.triangles {
            [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])].iter().for_each(|&edge| *edges.entry(edge).or_default() += 1);
        }
        for (&(a, b), &count) in &edges {
            assert_eq!((count, edges.get(&(b, a))), (1, Some(&1)), "{}: edge {a}-{b} is open", claim.name);
        }
        // V - E + F = 2 of each surface without a handle.
        let euler = body.positions.len() as i64 - edges.len() as i64 / 2 + body.triangles.len() as i64;
        assert_eq!(euler, 2 * claim.shells, "{}", claim.name);
        let count = body.triangles.len();
        assert!(claim.triangles.contains(&count), "{}: {count} triangles", claim.name);
        assert_eq!(character.surface.colour.len(), body.positions.len(), "{}: every vertex has a colour", claim.name);
    }
}

#[test]
fn they_are_as_large_as_claimed_and_face_forward() {
    for (claim, character) in ANIMALS.iter() {
        let bounds = |axis: DVec3| {
            let along = character.body.positions.iter().map(|p| p.dot(axis));
            along.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)))
        };
        let ((low, high), (back, front)) = (bounds(DVec3::Y), bounds(DVec3::Z));
        assert!(claim.height.contains(&(high - low)), "{}: {} m high", claim.name, high - low);
        assert!(claim.length.contains(&(front - back)), "{}: {} m long", claim.name, front - back);
        if ["cat", "fox"].contains(&claim.name) {
            assert!(low.abs() < 2e-3, "{} stands at {low} m", claim.name);
        }
        if let Some(head) = character.joint("Head") {
            let head = character.canonical_pose()[head].translation;
            assert!(head.z > 0.1 && head.x == 0.0, "{}: head at {head}", claim.name);
        }
    }
}

#[test]
fn weights_sum_to_one_and_change_smoothly() {
    for (claim, character) in ANIMALS.iter() {
        for (v, row) in character.weights.iter().enumerate() {
            let sum: f64 = row.iter().map(|&(_, weight)| weight).sum();
            assert!((sum - 1.0).abs() < 1e-12 && row.len() <= 4, "{}: vertex {v}: {row:?}", claim.name);
        }
        let weight = |v: u32, joint: usize| {
            character.weights[v as usize].iter().find(|&&(j, _)| j == joint).map_or(0.0, |&(_, weight)| weight)
        };
        let mut worst = 0f64;
        for t in &character.body.triangles {
            let length = character.body.positions[t[0] as usize].distance(character.body.positions[t[1] as usize]);
            let steepest =
                (0..character.joints.len()).map(|j| (weight(t[0], j) - weight(t[1], j)).abs()).fold(0.0, f64::max);
            worst = worst.max(steepest / length.max(0.004));
        }
        // The narrowest transition, over 16 mm at a cat's toes, has slope 94 per metre; a torn seam has the inverse of the
        // shortest edge, 250.
        assert!(worst < 110.0, "{}: weight slope {worst} per metre", claim.name);
    }
}

#[test]
fn joints_have_names_of_their_own_and_mirror_images() {
    for (claim, character) in ANIMALS.iter() {
        let names: BTreeSet<&str> = character.joints.iter().map(|joint| joint.name.as_str()).collect();
        assert_eq!(names.len(), character.joints.len(), "{}", claim.name);
        let place = |name: &str| character.joint(name).map(|j| character.joints[j].inverse_bind.translation);
        for (index, joint) in character.joints.iter().enumerate() {
            assert!(joint.parent.is_none_or(|parent| parent < index), "{} stands before its parent", joint.name);
            let mirrored = joint.inverse_bind.translation * DVec3::new(-1.0, 1.0, 1.0);
            let other = joint.name.replace("Left", "Right");
            assert!(joint.name == other || place(&other) == Some(mirrored), "{} has no mirror image", joint.name);
        }
    }
}
