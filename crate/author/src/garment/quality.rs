//! What makes a mesh fit for cloth: a manifold with few rims, even edges, no thin triangles, clear of the body.

use crate::rig::Mesh;
use glam::DVec3;
use std::collections::BTreeMap;

/// Measured quality of a cloth mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// Vertices.
    pub vertices: usize,
    /// Every edge has one or two triangles, of opposite directions, and every vertex one fan of triangles.
    pub manifold: bool,
    /// Connected components.
    pub components: usize,
    /// Boundary loops.
    pub loops: usize,
    /// Euler characteristic V - E + F; 2 - loops for a sphere with holes.
    pub euler: i64,
    /// Mean edge length, metres.
    pub edge: f64,
    /// Edge lengths over their mean: smallest, 5th, 95th percentile, largest.
    pub spread: [f64; 4],
    /// Smallest angle per triangle, degrees: least, 1st, 5th, 50th percentile.
    pub angles: [f64; 4],
}

/// Measures a mesh; all zero for an empty one.
pub fn quality(mesh: &Mesh) -> Quality {
    let mut edges: BTreeMap<(u32, u32), Vec<bool>> = BTreeMap::new();
    for t in &mesh.triangles {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            edges.entry((a.min(b), a.max(b))).or_default().push(a < b);
        }
    }
    let sound = edges.values().all(|sides| sides.len() == 1 || (sides.len() == 2 && sides[0] != sides[1]));
    let rim = edges.iter().filter(|(_, sides)| sides.len() == 1).map(|(edge, _)| *edge);
    let rim: Vec<(u32, u32)> = rim.collect();
    let mut used = vec![false; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    let count = used.iter().filter(|used| **used).count();

    let mut lengths: Vec<f64> =
        edges.keys().map(|&(a, b)| mesh.positions[a as usize].distance(mesh.positions[b as usize])).collect();
    let mean = lengths.iter().sum::<f64>() / lengths.len().max(1) as f64;
    lengths.iter_mut().for_each(|length| *length /= mean);
    let mut angles: Vec<f64> = mesh.triangles.iter().map(|t| least_angle(&mesh.positions, *t)).collect();
    lengths.sort_by(f64::total_cmp);
    angles.sort_by(f64::total_cmp);
    let at = |values: &[f64], share: f64| {
        if values.is_empty() { 0.0 } else { values[((values.len() - 1) as f64 * share).round() as usize] }
    };
    Quality {
        vertices: mesh.positions.len(),
        manifold: sound && count == mesh.positions.len() && fans(mesh),
        components: groups(mesh.positions.len(), edges.keys().copied(), &used),
        loops: groups(mesh.positions.len(), rim.iter().copied(), &on(&rim, mesh.positions.len())),
        euler: count as i64 - edges.len() as i64 + mesh.triangles.len() as i64,
        edge: mean,
        spread: [0.0, 0.05, 0.95, 1.0].map(|share| at(&lengths, share)),
        angles: [0.0, 0.01, 0.05, 0.5].map(|share| at(&angles, share)),
    }
}

/// Which vertices the edges touch.
fn on(edges: &[(u32, u32)], count: usize) -> Vec<bool> {
    let mut on = vec![false; count];
    edges.iter().for_each(|&(a, b)| (on[a as usize], on[b as usize]) = (true, true));
    on
}

/// Number of connected groups among the marked vertices.
fn groups(count: usize, edges: impl Iterator<Item = (u32, u32)>, marked: &[bool]) -> usize {
    let mut leader: Vec<usize> = (0..count).collect();
    fn find(leader: &mut [usize], mut v: usize) -> usize {
        while leader[v] != v {
            leader[v] = leader[leader[v]];
            v = leader[v];
        }
        v
    }
    for (a, b) in edges {
        let (a, b) = (find(&mut leader, a as usize), find(&mut leader, b as usize));
        leader[a.max(b)] = a.min(b);
    }
    (0..count).filter(|&v| marked[v] && leader[v] == v).count()
}

/// Do the triangles at every vertex form one fan? Each is a step around the vertex: one chain or one cycle.
fn fans(mesh: &Mesh) -> bool {
    let mut steps = vec![BTreeMap::new(); mesh.positions.len()];
    for t in &mesh.triangles {
        for k in 0..3 {
            if steps[t[k] as usize].insert(t[(k + 1) % 3], t[(k + 2) % 3]).is_some() {
                return false;
            }
        }
    }
    steps.iter().all(|next: &BTreeMap<u32, u32>| {
        let entered: Vec<u32> = next.values().copied().collect();
        let Some(first) = next.keys().find(|v| !entered.contains(v)).or(next.keys().next()) else { return true };
        let (mut v, mut walked) = (*first, 0);
        while let Some(&after) = next.get(&v) {
            (v, walked) = (after, walked + 1);
            if v == *first || walked > next.len() {
                break;
            }
        }
        walked == next.len()
    })
}

/// Smallest angle of a triangle, degrees.
pub(super) fn least_angle(positions: &[DVec3], triangle: [u32; 3]) -> f64 {
    let p = triangle.map(|v| positions[v as usize]);
    let angle = |k: usize| (p[(k + 1) % 3] - p[k]).angle_between(p[(k + 2) % 3] - p[k]).to_degrees();
    angle(0).min(angle(1)).min(angle(2))
}
