//! Cloth that was pulled into the body is put out of it before a pose is given up.

use glam::{DAffine3, DVec3};

use super::pose::simulator;
use super::scene::{legs, skirt};
use crate::simulate::Simulator;
use ctsn_rig::Pose;

/// A skirt at rest on legs that stand.
struct Standing {
    simulator: Simulator,
    pose: Pose,
    rest: Vec<DVec3>,
    /// Of its vertices to the body, metres.
    distances: Vec<f64>,
    /// Its vertices below the hips, those nearest to the body first.
    near: Vec<usize>,
}

impl Standing {
    fn new() -> Self {
        let character = legs();
        let simulator = simulator(&character, skirt(30, 9), 30).unwrap();
        let pose = character.canonical_pose();
        let rest = simulator.simulate(&simulator.drape().unwrap(), &pose).positions;
        let distances = simulator.body.signed(&pose, &rest);
        let mut near: Vec<usize> = (90..rest.len()).collect();
        near.sort_by(|a, b| distances[*a].total_cmp(&distances[*b]));
        Self { simulator, pose, rest, distances, near }
    }

    /// From a vertex to the axis of the thigh beside it, unit length.
    fn inwards(&self, vertex: usize) -> DVec3 {
        let place = self.rest[vertex];
        (place.with_z(0.0).with_x(0.085 * place.x.signum()) - place).normalize()
    }

    /// The skirt with some vertices so deep in the thighs, metres.
    fn pushed(&self, vertices: &[usize], depth: f64) -> Vec<DVec3> {
        let mut start = self.rest.clone();
        vertices.iter().for_each(|&at| start[at] += self.inwards(at) * (self.distances[at] + depth));
        start
    }
}

#[test]
fn cloth_in_the_body_is_put_outside_and_the_rest_stays() {
    let standing = Standing::new();
    let Standing { simulator, pose, near, .. } = &standing;
    let pushed = &near[..3];
    let start = standing.pushed(pushed, 0.02);
    let mut inside = simulator.inside(pose, &start).free;
    inside.sort_unstable();
    let mut wanted = pushed.to_vec();
    wanted.sort_unstable();
    assert_eq!(inside, wanted);

    let solver = simulator.level.solver(&simulator.settings, start.clone());
    let (positions, _) = simulator.put_out(&solver, pose, DAffine3::IDENTITY).unwrap();
    assert!(simulator.inside(pose, &positions).free.is_empty());
    for (vertex, (place, before)) in positions.iter().zip(&start).enumerate() {
        assert_eq!(pushed.contains(&vertex), place.distance(*before) > 0.01, "vertex {vertex}");
    }
    // Relaxed from there it is a drape again, none of it inside.
    let outcome = simulator.relax(&simulator.drape().unwrap(), pose, &start);
    assert!(outcome.converged(), "{:?}", outcome.status);
    assert!(simulator.inside(pose, &outcome.positions).free.is_empty());
}

/// A triangle of elsewhere stands beside one of three vertices that are 3 mm inside: lifted, its cloth would cross it.
#[test]
fn what_would_cross_cloth_is_not_lifted_and_all_else_is() {
    let standing = Standing::new();
    let Standing { simulator, pose, rest, distances, near } = &standing;
    let mut pushed: Vec<usize> = Vec::new();
    for &vertex in near {
        if pushed.iter().all(|other| rest[*other].distance(rest[vertex]) > 0.08) {
            pushed.push(vertex);
        }
    }
    pushed.truncate(3);
    let mut start = standing.pushed(&pushed, 0.003);
    assert_eq!(simulator.lift(pose, &mut start.clone()), 3);

    let vertex = pushed[0];
    let triangles = skirt(30, 9).triangles;
    let beside = triangles.iter().find(|corners| corners.contains(&(vertex as u32))).unwrap();
    let neighbour = *beside.iter().find(|corner| **corner != vertex as u32).unwrap() as usize;
    let far = |corners: &&[u32; 3]| corners.iter().all(|corner| rest[*corner as usize].distance(rest[vertex]) > 0.2);
    let outwards = -standing.inwards(vertex);
    let surface = rest[vertex] - outwards * distances[vertex];
    let along = (rest[neighbour] - surface).reject_from(outwards).normalize();
    let across = along.cross(outwards);
    let blade: [DVec3; 3] = [(-0.004, 1e-4), (0.004, 1e-4), (0.0, 0.02)]
        .map(|(aside, height)| surface + along * 0.003 + across * aside + outwards * height);
    for (corner, place) in triangles.iter().find(far).unwrap().iter().zip(blade) {
        start[*corner as usize] = place;
    }
    let mut lifted = start.clone();
    assert_eq!(simulator.lift(pose, &mut lifted), 2);
    assert!(lifted[vertex] == start[vertex] && pushed[1..].iter().all(|other| lifted[*other] != start[*other]));
}
