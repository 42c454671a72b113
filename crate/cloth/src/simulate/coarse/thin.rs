//! Thins a mesh to some of its own vertices: half-edge collapses, shortest edges first, then flips to wider angles
//! (Botsch & Kobbelt, A Remeshing Approach to Multiresolution Modeling, 2004, §4, without new or moved vertices). So a
//! state of the mesh is one of the thinned mesh, too, and pins and skins carry over.

use std::collections::BTreeSet;

use ctsn_rig::mesh::triangle::least_angle;
use ctsn_rig::mesh::{DynamicMesh, Edges, Mesh, around, ordered};

/// Edges that a collapse makes may be so much longer than those that it takes away.
const LONGEST: f64 = 2.2;
/// Growth of that length from round to round, and rounds.
const GROWTH: f64 = 1.1;
const ROUNDS: usize = 24;
/// Least cosine between a triangle's normals before and after.
const TURN: f64 = 0.7;
/// Least angle, degrees, that a collapse may make where it makes one smaller.
const LEAST_ANGLE: f64 = 18.0;

/// What is left of a mesh.
pub(super) struct Thinned {
    pub mesh: Mesh,
    /// The vertex of the mesh given that each is.
    pub kept: Vec<usize>,
    /// The kept one that each vertex of the mesh given went to, as a number of the new mesh.
    pub into: Vec<u32>,
}

/// Takes vertices away until `target` are left, or none more can go.
pub(super) fn thin(mesh: &Mesh, target: usize) -> Thinned {
    let mut sheet = Sheet::new(mesh);
    let even = (mesh.area() / (target as f64 * 0.866)).sqrt();
    let mut length = 0.5 * even;
    for _ in 0..ROUNDS {
        sheet.collapse(length, LONGEST * length, target);
        sheet.flip();
        if sheet.mesh.count() <= target {
            break;
        }
        length *= GROWTH;
    }
    let Sheet { mesh, into, .. } = sheet;
    let (mesh, kept) = mesh.finish();
    let mut number = vec![0; into.len()];
    kept.iter().zip(0..).for_each(|(v, new)| number[*v] = new);
    let last = |mut v: usize| {
        while into[v] as usize != v {
            v = into[v] as usize;
        }
        number[v]
    };
    Thinned { mesh, kept, into: (0..into.len()).map(last).collect() }
}

/// A mesh under edit.
struct Sheet {
    mesh: DynamicMesh,
    rim: Vec<bool>,
    into: Vec<u32>,
}

impl Sheet {
    fn new(mesh: &Mesh) -> Self {
        let mut rim = vec![false; mesh.positions.len()];
        for ([a, b], _) in Edges::new(&mesh.triangles).boundary() {
            (rim[a as usize], rim[b as usize]) = (true, true);
        }
        Self { into: (0..rim.len() as u32).collect(), mesh: DynamicMesh::new(mesh.clone()), rim }
    }

    fn edges(&self) -> Vec<[u32; 2]> {
        self.mesh.triangles().flat_map(around).map(ordered).collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Collapses edges shorter than `shortest`, the shortest first, while more than `target` vertices are left.
    fn collapse(&mut self, shortest: f64, longest: f64, target: usize) {
        let mut edges = self.edges();
        edges.retain(|&edge| self.mesh.length(edge) < shortest);
        edges.sort_by(|x, y| self.mesh.length(*x).total_cmp(&self.mesh.length(*y)));
        let mut left = self.mesh.count();
        for [a, b] in edges {
            if left <= target {
                return;
            }
            if self.merge(a, b, longest) || self.merge(b, a, longest) {
                left -= 1;
            }
        }
    }

    /// Collapses `from` into `to` where the surface stays a manifold that does not fold, rims stay where they are, and
    /// no triangle becomes a sliver.
    fn merge(&mut self, from: u32, to: u32, longest: f64) -> bool {
        let mesh = &self.mesh;
        let beside = mesh.beside([from, to]);
        let along = beside.len() == 1;
        if beside.is_empty() || beside.len() > 2 || self.rim[from as usize] && !along {
            return false;
        }
        let (ring, other) = (mesh.ring(from), mesh.ring(to));
        let shared = ring.iter().filter(|v| other.contains(v)).count();
        let too_long = ring.iter().any(|&v| v != to && mesh.length([v, to]) > longest);
        if shared != beside.len() || too_long || !self.sound(from, to) {
            return false;
        }
        beside.iter().for_each(|t| self.mesh.set(*t, None));
        for t in self.mesh.fan(from).to_vec() {
            let Some(old) = self.mesh.triangle(t) else { continue };
            self.mesh.alter(t, old.map(|v| if v == from { to } else { v }));
        }
        self.into[from as usize] = to;
        true
    }

    /// Whether the triangles around `from` keep their normals and angles when it goes to `to`.
    fn sound(&self, from: u32, to: u32) -> bool {
        let fan = self.mesh.fan(from).iter().filter_map(|t| self.mesh.triangle(*t));
        let angle = |t: [u32; 3]| least_angle(t.map(|v| self.mesh.positions[v as usize]));
        fan.filter(|t| !t.contains(&to)).all(|old| {
            let new = old.map(|v| if v == from { to } else { v });
            let (before, after) = (self.mesh.cross(old), self.mesh.cross(new));
            before.dot(after) > TURN * before.length() * after.length() && angle(new) > LEAST_ANGLE.min(angle(old))
        })
    }

    /// Flips inner edges where the least angle grows and the surface does not fold.
    fn flip(&mut self) {
        for [a, b] in self.edges() {
            let mesh = &self.mesh;
            let &[left, right] = &mesh.beside([a, b])[..] else { continue };
            let runs = |t: u32| mesh.triangle(t).is_some_and(|t| around(t).contains(&[a, b]));
            let (left, right) = if runs(left) { (left, right) } else { (right, left) };
            let (Some(c), Some(d)) = (mesh.opposite(left, [a, b]), mesh.opposite(right, [a, b])) else { continue };
            if c == d || mesh.ring(c).contains(&d) {
                continue;
            }
            let (Some(first), Some(second)) = (mesh.triangle(left), mesh.triangle(right)) else { continue };
            let (old, new) = ([first, second], [[a, d, c], [b, c, d]]);
            let normal = mesh.cross(first) + mesh.cross(second);
            let sound = |t: &[u32; 3]| mesh.cross(*t).dot(normal) > TURN * mesh.cross(*t).length() * normal.length();
            let least = |pair: [[u32; 3]; 2]| {
                let [p, q] = pair.map(|t| least_angle(t.map(|v| mesh.positions[v as usize])));
                p.min(q)
            };
            if new.iter().all(sound) && least(new) > least(old) + 0.5 {
                self.mesh.alter(left, new[0]);
                self.mesh.alter(right, new[1]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// A tube of 60 by 61 vertices thinned to 900: the same rims, every vertex one of the tube's, no sliver, no hole.
    #[test]
    fn a_thinned_tube_is_a_tube() {
        let place = |i: usize| {
            let (turn, height) = ((i % 60) as f64 / 60.0 * std::f64::consts::TAU, (i / 60) as f64);
            DVec3::new(turn.cos(), 0.1 * height, turn.sin())
        };
        let square = |i: u32| {
            let (row, next) = (i / 60 * 60, (i % 60 + 1) % 60);
            [[i, i + 60, row + next], [row + next, i + 60, row + 60 + next]]
        };
        let mesh = Mesh { positions: (0..3660).map(place).collect(), triangles: (0..3600).flat_map(square).collect() };
        let Thinned { mesh: thinned, kept, into } = thin(&mesh, 900);
        let count = thinned.positions.len();
        assert!((880..=900).contains(&count), "{count}");
        assert!(kept.iter().zip(&thinned.positions).all(|(v, p)| mesh.positions[*v] == *p));
        assert!(kept.iter().zip(0..).all(|(v, new)| into[*v] == new));
        let edges = Edges::new(&thinned.triangles);
        assert_eq!(edges.rims().len(), 2);
        assert_eq!(count + thinned.triangles.len(), edges.count(), "Euler's number of a tube is 0");
        let mut angles: Vec<f64> = thinned.corners().map(least_angle).collect();
        angles.sort_by(f64::total_cmp);
        assert!(angles[0] > 12.0 && angles[count / 10] > 25.0, "{} {}", angles[0], angles[count / 10]);
        let share = thinned.area() / mesh.area();
        assert!((0.97..1.001).contains(&share), "{share}");
    }
}
