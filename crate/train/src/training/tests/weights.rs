//! Initial skin weights: smooth where the cloth is far from the body, the body's own where it lies on it.

use super::super::weights;
use super::*;

/// A tube of cloth of radius `radius` around two legs, 20 cm apart, of one joint each.
fn skirt(radius: f32) -> Setup {
    let (mut setup, _) = crate::synthetic::dataset(1200, 2, 1);
    let scale = radius / 0.2;
    let widen = |vertex: &[f32]| [vertex[0] * scale, vertex[1], vertex[2] * scale];
    setup.template = setup.template.chunks_exact(3).flat_map(widen).collect();
    let leg = |side: f32| {
        let around = move |i: usize| (i as f32 * 0.1).sin_cos();
        (0..75)
            .flat_map(move |row| (0..63).map(move |i| (row as f32 * 0.02, around(i))))
            .map(move |(height, (sin, cos))| [side * 0.1 + 0.07 * cos, height, 0.07 * sin])
    };
    let legs: Vec<[f32; 3]> = leg(-1.0).chain(leg(1.0)).collect();
    setup.body_weights = legs.iter().map(|vertex| vec![(usize::from(vertex[0] > 0.0), 1.0)]).collect();
    setup.body = legs.as_flattened().to_vec();
    setup.body_triangles = Vec::new();
    setup
}

/// Greatest difference of neighbouring weights, and each vertex's weight of joint 0.
fn smoothed(setup: &Setup) -> (f64, Vec<f64>) {
    let graph = Graph::new(setup.template.len() / 3, &setup.triangles);
    let rows = weights::smooth(setup, &graph, &setup.nearest().unwrap()).unwrap();
    for row in &rows {
        assert!((row.iter().map(|entry| entry.1).sum::<f64>() - 1.0).abs() < 1e-9, "{row:?}");
        assert!(row.iter().all(|entry| entry.1 > 0.0), "{row:?}");
    }
    let first = |row: &Vec<(usize, f64)>| row.iter().find(|entry| entry.0 == 0).map_or(0.0, |entry| entry.1);
    let first: Vec<f64> = rows.iter().map(first).collect();
    let jumps = (0..first.len()).flat_map(|i| graph.of(i).iter().map(move |j| (i, *j as usize)));
    (jumps.map(|(i, j)| (first[i] - first[j]).abs()).fold(0.0, f64::max), first)
}

#[test]
fn a_skirt_hangs_between_the_legs() {
    let setup = skirt(0.3);
    let (jump, first) = smoothed(&setup);
    // By the nearest leg alone the weights jump from 0 to 1 along two lines.
    assert!(jump < 0.25, "neighbours differ by {jump}");
    for (vertex, weight) in setup.template.chunks_exact(3).zip(&first) {
        let side = if vertex[0] < 0.0 { *weight } else { 1.0 - weight };
        assert!(side > 0.49 || vertex[0].abs() < 0.02, "{vertex:?} follows the other leg: {weight}");
    }
}

#[test]
fn cloth_on_the_skin_keeps_its_weights() {
    let mut setup = skirt(0.2);
    setup.body.clone_from(&setup.template);
    setup.body_triangles.clone_from(&setup.triangles);
    let own = |vertex: &[f32]| vec![(usize::from(vertex[1] > 0.75), 1.0)];
    setup.body_weights = setup.template.chunks_exact(3).map(own).collect();
    let (_, first) = smoothed(&setup);
    for (vertex, weight) in setup.template.chunks_exact(3).zip(&first) {
        let wanted = if vertex[1] > 0.75 { 0.0 } else { 1.0 };
        // Two rows of vertices on either side of the border are blurred.
        assert!((weight - wanted).abs() < 0.05 || (vertex[1] - 0.75).abs() < 0.1, "{vertex:?}: {weight}");
    }
}

#[test]
fn joints_that_carry_no_cloth_are_not_heard_unless_they_are_obstacles() {
    let (_, mut setup, samples) = tiny();
    setup.body_weights.fill(vec![(0, 1.0)]);
    setup.description.joints[2] = "Obstacle".to_owned();
    let samples: Vec<&Sample> = samples.iter().collect();
    let rig = initial(&setup, &samples, Architecture::default(), 1).unwrap().rig;
    let told = rig.std.chunks(12).map(|std| std.iter().any(|std| *std < 10.0));
    assert_eq!(told.collect::<Vec<_>>(), [true, false, true]);
}
