//! A body one part of which lies inside another.

use crate::sphere::{RADIUS, length, model};
use ctsn_core::cpu::repair::collide::LANDMARKS;
use ctsn_core::model::HostModel;
use ctsn_core::suite::sphere;
use fastrand::Rng;
use std::ops::Range;

/// Vertices of the smaller sphere.
const INNER: Range<usize> = LANDMARKS..LANDMARKS + 62;
/// How far it is raised inside the other, metres.
const RAISED: f32 = 0.03;

/// A sphere of 100 mm and one of 50, raised by so much, whose vertices follow the landmarks: positions, triangles.
fn nested(raised: f32) -> (Vec<f32>, Vec<u32>) {
    let (outer, outer_faces) = sphere(0.1, 24, 13);
    let (inner, inner_faces) = sphere(0.05, 10, 7);
    let count = (inner.len() / 3) as u32;
    let raised = inner.chunks_exact(3).flat_map(|p| [p[0], p[1] + raised, p[2]]);
    let (first, rest) = outer.split_at(3 * LANDMARKS);
    let positions = first.iter().copied().chain(raised).chain(rest.iter().copied());
    let place = |i: &u32| if (*i as usize) < LANDMARKS { *i } else { *i + count };
    let triangles = outer_faces.iter().map(place).chain(inner_faces.iter().map(|i| i + LANDMARKS as u32));
    (positions.collect(), triangles.collect())
}

/// The cloth, just outside the smaller sphere and inside the other, has all its seeds on the smaller but the last.
pub fn buried(rng: &mut Rng) -> HostModel {
    let places = (0..300).flat_map(|_| {
        let way: [f32; 3] = std::array::from_fn(|_| rng.f32() - 0.5);
        let [x, y, z] = way.map(|c| c * 1.05 * RADIUS / length(&way));
        [x, y + RAISED, z]
    });
    let (places, (positions, triangles)) = (places.collect(), nested(RAISED));
    let mut model = model(rng, places, positions, triangles);
    let mut inner = || rng.u32(INNER.start as u32..INNER.end as u32);
    let seeds = (0..300).flat_map(|_| [inner(), inner(), inner(), 0]).collect();
    model.body.as_mut().expect("a body").seeds = seeds;
    model
}

/// How far the smaller sphere is raised to come half out of the other, metres.
pub const EMERGED: f32 = 2.2 * RADIUS;

/// Cloth a few millimetres inside the part that came out, each vertex beside one of the skin, which is its only seed.
pub fn emerged(rng: &mut Rng) -> HostModel {
    let (positions, triangles) = nested(EMERGED);
    let skin = positions.as_chunks::<3>().0;
    let out = INNER.filter(|vertex| length(&skin[*vertex]) > 2.0 * RADIUS + 0.005);
    let vertices: Vec<usize> = out.flat_map(|vertex| [vertex; 20]).collect();
    let beside = |vertex: &usize| {
        let [x, y, z] = skin[*vertex];
        let share = 1.0 - (0.004 + 0.006 * rng.f32()) / RADIUS;
        let by: [f32; 3] = std::array::from_fn(|_| 0.002 * (rng.f32() - 0.5));
        [share * x + by[0], EMERGED + share * (y - EMERGED) + by[1], share * z + by[2]]
    };
    let places = vertices.iter().flat_map(beside).collect();
    let mut model = model(rng, places, positions.clone(), triangles);
    model.body.as_mut().expect("a body").seeds = vertices.iter().flat_map(|vertex| [*vertex as u32; 4]).collect();
    model
}
