//! Each character is a closed manifold, its skin weights sum to one, and every run builds the same.

use super::*;
use ctsn_rig::Mesh;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

/// The figures with two arms and two legs.
pub(crate) const TWO_LEGGED: [&str; 5] = ["mannequin", "andy", "anna", "qman", "monster"];

/// Every figure with its clips, built once: each takes seconds.
static CAST: LazyLock<Vec<(&str, Character)>> =
    LazyLock::new(|| FIGURES.par_iter().map(|(name, _)| (*name, character(name).expect("a known name"))).collect());
static MANNEQUIN: LazyLock<&Character> = LazyLock::new(|| cast("mannequin"));

/// The figure of that name with its clips, for the tests here and in `motion`.
pub(crate) fn cast(name: &str) -> &'static Character {
    &CAST.iter().find(|(known, _)| *known == name).expect("a known name").1
}

/// For each vertex, the number of its connected piece.
fn pieces(body: &Mesh) -> Vec<usize> {
    let components = body.components();
    (0..body.positions.len()).map(|v| components.of(v)).collect()
}

#[test]
fn bodies_are_closed_oriented_spheres() {
    for (name, character) in CAST.iter() {
        let body = &character.body.mesh;
        let piece = pieces(body);
        let mut edges: BTreeMap<(u32, u32), usize> = BTreeMap::new();
        for triangle in &body.triangles {
            for i in 0..3 {
                *edges.entry((triangle[i], triangle[(i + 1) % 3])).or_default() += 1;
            }
        }
        // Of each piece: vertices - edges + triangles, and six times the volume.
        let mut euler: BTreeMap<usize, (i64, f64)> = BTreeMap::new();
        piece.iter().for_each(|&p| euler.entry(p).or_default().0 += 1);
        for (&(a, b), &count) in &edges {
            let back = edges.get(&(b, a));
            assert_eq!((count, back), (1, Some(&1)), "{name}: edge {a}-{b} is not shared by exactly two triangles");
            euler.entry(piece[a as usize]).or_default().0 -= i64::from(a < b);
        }
        for triangle in &body.triangles {
            let [a, b, c] = triangle.map(|v| body.positions[v as usize]);
            let entry = euler.entry(piece[triangle[0] as usize]).or_default();
            *entry = (entry.0 + 1, entry.1 + a.dot(b.cross(c)));
        }
        assert!(euler.values().all(|&(sum, volume)| sum == 2 && volume > 0.0), "{name}: {euler:?}");
        assert!((5_000..=15_000).contains(&body.triangles.len()), "{name}: {} triangles", body.triangles.len());
    }
}

#[test]
fn bodies_have_the_size_they_should() {
    // Height with horns and hair in metres, volume in cubic metres.
    let wanted = [
        ("mannequin", 1.76, 0.055),
        ("andy", 1.85, 0.075),
        ("anna", 1.72, 0.060),
        ("qman", 1.34, 0.102),
        ("monster", 1.76, 0.28),
    ];
    for (name, height, volume) in wanted {
        let body = &cast(name).body.mesh;
        let heights = body.positions.iter().map(|p| p.y);
        let (low, high) = heights.fold((f64::MAX, f64::MIN), |(l, h), y| (l.min(y), h.max(y)));
        assert!(low.abs() < 4e-3 && (high - height).abs() < 0.05, "{name}: from {low} to {high} m");
        let corners = body.triangles.iter().map(|t| t.map(|v| body.positions[v as usize]));
        let found: f64 = corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
        assert!((0.7..1.4).contains(&(found / volume)), "{name}: {found} m³");
    }
}

#[test]
fn each_vertex_has_one_fan() {
    for (name, character) in CAST.iter() {
        let body = &character.body.mesh;
        let mut next: Vec<BTreeMap<u32, u32>> = vec![BTreeMap::new(); body.positions.len()];
        for &[a, b, c] in &body.triangles {
            for (v, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
                let before = next[v as usize].insert(from, to);
                assert_eq!(before, None, "{name}: two triangles on one side of edge {v}-{from}");
            }
        }
        for (v, ring) in next.iter().enumerate() {
            let start = *ring.keys().next().expect("a vertex without triangles");
            let step = |at: &u32| ring.get(at).copied().filter(|&n| n != start);
            let walked = std::iter::successors(Some(start), step).take(100).count();
            assert_eq!(walked, ring.len(), "{name}: vertex {v} joins several fans");
        }
    }
}

#[test]
fn body_lies_on_the_surface() {
    let lofts = mannequin::MANNEQUIN.lofts(&MANNEQUIN.joints);
    let worst = MANNEQUIN.body.mesh.positions.iter().map(|&p| loft::distance(&lofts, p).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-4, "a vertex lies {worst} m off the surface");
}

#[test]
fn triangles_are_well_shaped() {
    for (name, character) in CAST.iter() {
        let body = &character.body.mesh;
        let quality = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| body.positions[v as usize]);
            let area = (b - a).cross(c - a).length();
            2.0 * 3f64.sqrt() * area / (a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a))
        };
        let qualities: Vec<f64> = body.triangles.iter().map(quality).collect();
        let mean = qualities.iter().sum::<f64>() / qualities.len() as f64;
        let poor = qualities.iter().filter(|&&q| q < 0.5).count();
        assert!(mean > 0.9 && poor * 50 < qualities.len(), "{name}: mean quality {mean}, {poor} poor triangles");
    }
}

#[test]
fn weights_are_a_partition_of_unity() {
    for (name, character) in CAST.iter() {
        for (v, row) in character.body.weights.iter().enumerate() {
            let sum: f64 = row.iter().map(|&(_, w)| w).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{name}: weights of vertex {v} sum to {sum}");
            assert!((1..=4).contains(&row.len()), "{name}: vertex {v} follows {} joints", row.len());
            let sorted = row.windows(2).all(|pair| pair[0].1 >= pair[1].1) && row.iter().all(|&(_, w)| w > 0.0);
            assert!(sorted, "{name}: vertex {v}: {row:?}");
        }
    }
}

#[test]
fn weights_change_smoothly() {
    for (name, Character { body, joints, .. }) in CAST.iter() {
        let SkinnedMesh { mesh: body, weights } = body;
        let dense = |v: u32| weights[v as usize].iter().copied().collect::<BTreeMap<usize, f64>>();
        let height = body.positions.iter().map(|p| p.y).fold(0.0, f64::max);
        let mut worst = 0f64;
        for triangle in &body.triangles {
            let (a, b) = (dense(triangle[0]), dense(triangle[1]));
            let length = body.positions[triangle[0] as usize].distance(body.positions[triangle[1] as usize]);
            for joint in 0..joints.len() {
                let change = a.get(&joint).unwrap_or(&0.0) - b.get(&joint).unwrap_or(&0.0);
                worst = worst.max(change.abs() / length.max(0.003 * height));
            }
        }
        // A transition over 3 cm has a slope of 33 per metre on a grown body; a torn seam has one over the edge length.
        assert!(worst * height < 75.0, "{name}: weight slope {worst} per metre");
    }
}

#[test]
fn canonical_pose_leaves_the_body_where_it_is() {
    let posed = MANNEQUIN.pose_body(&MANNEQUIN.canonical_pose());
    let worst = posed.iter().zip(&MANNEQUIN.body.mesh.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    assert!(worst < 1e-12, "moved by {worst} m");
}

#[test]
fn skeletons_are_ordered_unique_and_symmetric() {
    for (name, character) in CAST.iter() {
        let find = |name: &str| character.joint(name).map(|j| character.joints[j].inverse_bind.translation);
        let names: BTreeSet<&str> = character.joints.iter().map(|joint| joint.name.as_str()).collect();
        assert_eq!(names.len(), character.joints.len(), "{name}: two joints of one name");
        for (index, joint) in character.joints.iter().enumerate() {
            assert!(joint.parent.is_none_or(|parent| parent < index), "{name}: {} before its parent", joint.name);
            let other = joint.name.replace("Left", "Right");
            let mirrored = joint.inverse_bind.translation * DVec3::new(-1.0, 1.0, 1.0);
            assert!(
                joint.name == other || find(&other) == Some(mirrored),
                "{name}: {} has no mirror image",
                joint.name
            );
        }
    }
}

#[test]
fn crisp_paint_has_straight_borders() {
    let Character { body: SkinnedMesh { mesh: body, .. }, surface, .. } = cast("andy");
    // The waist of the briefs: vertices drawn twice there, in two colours.
    let mut colours: BTreeMap<u32, BTreeSet<[u32; 3]>> = BTreeMap::new();
    for (&vertex, colour) in surface.vertex.iter().zip(&surface.colour) {
        colours.entry(vertex).or_default().insert(colour.map(f32::to_bits));
    }
    let border: Vec<f64> = colours.iter().filter(|c| c.1.len() > 1).map(|c| body.positions[*c.0 as usize].y).collect();
    let waist: Vec<f64> = border.into_iter().filter(|&y| y > 0.95).collect();
    assert!(waist.len() > 20, "{} vertices around the waist", waist.len());
    let off = waist.iter().map(|y| (y - 1.010).abs()).fold(0.0, f64::max);
    assert!(off < 0.004, "the border leaves its height by {off} m");
}

#[test]
fn building_twice_gives_the_same_bytes() {
    let again = Character { clips: MANNEQUIN.clips.clone(), ..build(&mannequin::MANNEQUIN) };
    assert!(again == **MANNEQUIN);
}

#[test]
fn an_unknown_name_lists_the_known_ones() {
    let message = character("nobody").expect_err("no such character").to_string();
    assert!(message.contains("mannequin") && message.contains("nobody"), "{message}");
}
