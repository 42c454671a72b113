//! A character must be a closed manifold skinned by a partition of unity, the same on every run.

use super::*;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Built once: it takes seconds.
static MANNEQUIN: LazyLock<Character> = LazyLock::new(|| build(&mannequin::MANNEQUIN));

#[test]
fn body_is_a_closed_oriented_sphere() {
    let body = &MANNEQUIN.body;
    let mut edges: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for triangle in &body.triangles {
        for i in 0..3 {
            *edges.entry((triangle[i], triangle[(i + 1) % 3])).or_default() += 1;
        }
    }
    for (&(a, b), &count) in &edges {
        assert_eq!((count, edges.get(&(b, a))), (1, Some(&1)), "edge {a}-{b} is not shared by exactly two triangles");
    }
    let euler = body.positions.len() as i64 - edges.len() as i64 / 2 + body.triangles.len() as i64;
    assert_eq!(euler, 2);
    let volume: f64 = body
        .triangles
        .iter()
        .map(|t| t.map(|v| body.positions[v as usize]))
        .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
        .sum();
    assert!((0.04..0.08).contains(&volume), "a slender adult holds 40 to 80 litres, found {volume} m³");
    assert!((5_000..=12_000).contains(&body.triangles.len()), "{} triangles", body.triangles.len());
}

#[test]
fn each_vertex_has_one_fan() {
    let body = &MANNEQUIN.body;
    let mut next: Vec<BTreeMap<u32, u32>> = vec![BTreeMap::new(); body.positions.len()];
    for &[a, b, c] in &body.triangles {
        for (v, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
            assert_eq!(next[v as usize].insert(from, to), None, "two triangles on one side of edge {v}-{from}");
        }
    }
    for (v, ring) in next.iter().enumerate() {
        let start = *ring.keys().next().expect("a vertex without triangles");
        let walked =
            std::iter::successors(Some(start), |at| ring.get(at).copied().filter(|&n| n != start)).take(100).count();
        assert_eq!(walked, ring.len(), "vertex {v} joins several fans");
    }
}

#[test]
fn body_lies_on_the_surface_and_stands_on_the_floor() {
    let lofts = mannequin::MANNEQUIN.lofts(&MANNEQUIN.joints);
    let worst = MANNEQUIN.body.positions.iter().map(|&p| loft::distance(&lofts, p).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-4, "a vertex lies {worst} m off the surface");
    let heights = MANNEQUIN.body.positions.iter().map(|p| p.y);
    let (low, high) = heights.fold((f64::MAX, f64::MIN), |(l, h), y| (l.min(y), h.max(y)));
    assert!(low.abs() < 2e-3 && (1.7..1.8).contains(&high), "from {low} to {high} m");
}

#[test]
fn triangles_are_well_shaped() {
    let body = &MANNEQUIN.body;
    let quality = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| body.positions[v as usize]);
        let area = (b - a).cross(c - a).length();
        2.0 * 3f64.sqrt() * area / (a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a))
    };
    let qualities: Vec<f64> = body.triangles.iter().map(quality).collect();
    let mean = qualities.iter().sum::<f64>() / qualities.len() as f64;
    let poor = qualities.iter().filter(|&&q| q < 0.5).count();
    assert!(mean > 0.9 && poor * 100 < qualities.len(), "mean quality {mean}, {poor} poor triangles");
}

#[test]
fn weights_are_a_partition_of_unity() {
    for (v, row) in MANNEQUIN.weights.iter().enumerate() {
        let sum: f64 = row.iter().map(|&(_, w)| w).sum();
        assert!((sum - 1.0).abs() < 1e-12, "weights of vertex {v} sum to {sum}");
        assert!((1..=4).contains(&row.len()), "vertex {v} follows {} joints", row.len());
        assert!(
            row.windows(2).all(|pair| pair[0].1 >= pair[1].1) && row.iter().all(|&(_, w)| w > 0.0),
            "vertex {v}: {row:?}"
        );
    }
}

#[test]
fn weights_change_smoothly() {
    let dense = |v: u32| MANNEQUIN.weights[v as usize].iter().copied().collect::<BTreeMap<usize, f64>>();
    let mut worst = 0f64;
    for triangle in &MANNEQUIN.body.triangles {
        let (a, b) = (dense(triangle[0]), dense(triangle[1]));
        let length =
            MANNEQUIN.body.positions[triangle[0] as usize].distance(MANNEQUIN.body.positions[triangle[1] as usize]);
        for joint in 0..MANNEQUIN.joints.len() {
            let change = a.get(&joint).unwrap_or(&0.0) - b.get(&joint).unwrap_or(&0.0);
            worst = worst.max(change.abs() / length.max(0.005));
        }
    }
    // A transition over 3 cm has slope 33 per metre; a torn seam would have the inverse edge length, 50 to 200.
    assert!(worst < 40.0, "weight slope {worst} per metre");
}

#[test]
fn canonical_pose_leaves_the_body_where_it_is() {
    let posed = MANNEQUIN.pose_body(&MANNEQUIN.canonical_pose());
    let worst = posed.iter().zip(&MANNEQUIN.body.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    assert!(worst < 1e-12, "moved by {worst} m");
}

#[test]
fn both_sides_have_the_same_skeleton() {
    let find = |name: &str| MANNEQUIN.joint(name).map(|j| MANNEQUIN.joints[j].inverse_bind.translation);
    assert_eq!(MANNEQUIN.joints.len(), 22);
    for (index, joint) in MANNEQUIN.joints.iter().enumerate() {
        assert!(joint.parent.is_none_or(|parent| parent < index), "{} stands before its parent", joint.name);
        let other = joint.name.replace("Left", "Right");
        let mirrored = joint.inverse_bind.translation * DVec3::new(-1.0, 1.0, 1.0);
        assert!(joint.name == other || find(&other) == Some(mirrored), "{} has no mirror image", joint.name);
    }
}

#[test]
fn building_twice_gives_the_same_bytes() {
    assert!(build(&mannequin::MANNEQUIN) == *MANNEQUIN);
}

#[test]
fn an_unknown_name_lists_the_known_ones() {
    let message = character("nobody").expect_err("no such character").to_string();
    assert!(message.contains("mannequin") && message.contains("nobody"), "{message}");
}
