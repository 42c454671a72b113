//! Even triangles on an implicit surface: split, collapse, flip, relax, project (Botsch & Kobbelt 2004).
//! The wanted edge length varies over the surface; the mesh is closed and stays a manifold of the same topology.

use ctsn_rig::mesh::triangle::cross;
use ctsn_rig::mesh::{DynamicMesh, Mesh, around};
use glam::DVec3;

/// A closed mesh under change.
struct Remesher<'a> {
    mesh: DynamicMesh,
    /// Wanted edge length at each vertex, metres.
    wanted: Vec<f64>,
    edge: &'a dyn Fn(DVec3) -> f64,
    project: &'a dyn Fn(DVec3) -> DVec3,
}

/// Remeshes `mesh` to edges near `edge(p)` metres, vertices kept on the surface by `project`.
pub fn remesh(mesh: Mesh, edge: &dyn Fn(DVec3) -> f64, project: &dyn Fn(DVec3) -> DVec3, rounds: usize) -> Mesh {
    let wanted = mesh.positions.iter().map(|&p| edge(p)).collect();
    let mut work = Remesher { mesh: DynamicMesh::new(mesh), wanted, edge, project };
    for _ in 0..rounds {
        work.split_long();
        work.collapse_short();
        work.flip();
        work.relax();
    }
    work.mesh.finish().0
}

impl Remesher<'_> {
    /// Live edges (a < b), each once, in triangle order.
    fn edges(&self) -> Vec<[u32; 2]> {
        // On a closed oriented mesh each edge is seen once in either direction.
        self.mesh.triangles().flat_map(around).filter(|[a, b]| a < b).collect()
    }

    /// Length over wanted length.
    fn ratio(&self, [a, b]: [u32; 2]) -> f64 {
        self.mesh.length([a, b]) * 2.0 / (self.wanted[a as usize] + self.wanted[b as usize])
    }

    /// The two triangles at an edge, or `None` if it is no longer a manifold edge.
    fn sides(&self, edge: [u32; 2]) -> Option<[u32; 2]> {
        self.mesh.beside(edge).try_into().ok()
    }

    /// The middle of an edge on the surface, and the edge length wanted there, metres.
    fn middle(&self, [a, b]: [u32; 2]) -> (DVec3, f64) {
        ((self.project)(self.mesh.middle([a, b])), (self.wanted[a as usize] + self.wanted[b as usize]) * 0.5)
    }

    fn split_long(&mut self) {
        let mut long: Vec<(f64, [u32; 2])> = self.edges().into_iter().map(|e| (self.ratio(e), e)).collect();
        long.retain(|&(ratio, _)| ratio > 4.0 / 3.0);
        long.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
        for (_, edge) in long {
            let Some(pair) = self.sides(edge) else { continue };
            let (place, wanted) = self.middle(edge);
            let middle = self.mesh.add_vertex(place);
            self.wanted.push(wanted);
            for index in pair {
                let Some(triangle) = self.mesh.triangle(index) else { continue };
                let [first, second] = edge.map(|old| triangle.map(|v| if v == old { middle } else { v }));
                self.mesh.set(index, Some(first));
                self.mesh.add_triangle(second);
            }
        }
    }

    fn collapse_short(&mut self) {
        let mut short: Vec<(f64, [u32; 2])> = self.edges().into_iter().map(|e| (self.ratio(e), e)).collect();
        short.retain(|&(ratio, _)| ratio < 0.8);
        short.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        for (_, [a, b]) in short {
            // An earlier collapse may have stretched or removed this edge.
            if !self.mesh.fan(a).is_empty() && !self.mesh.fan(b).is_empty() && self.ratio([a, b]) < 0.8 {
                self.collapse(a, b);
            }
        }
    }

    /// Merges `b` into `a` at their projected midpoint, unless that would break the manifold, flip a triangle
    /// or leave an edge long enough to be split again.
    fn collapse(&mut self, a: u32, b: u32) {
        let Some(pair) = self.sides([a, b]) else { return };
        let mesh = &self.mesh;
        let (ring_a, ring_b) = (mesh.ring(a), mesh.ring(b));
        let shared: Vec<u32> = ring_a.iter().copied().filter(|v| ring_b.contains(v)).collect();
        let thin = shared.iter().any(|&v| mesh.fan(v).len() <= 3);
        if shared.len() != 2 || thin || ring_a.len() + ring_b.len() > 13 {
            return;
        }
        let (merged, wanted) = self.middle([a, b]);
        let far = |&v: &u32| {
            let allowed = 4.0 / 3.0 * (self.wanted[v as usize] + wanted) * 0.5;
            v != a && v != b && mesh.positions[v as usize].distance(merged) > allowed
        };
        if ring_a.iter().chain(&ring_b).any(far) {
            return;
        }
        let turned = |&index: &u32| {
            let Some(triangle) = mesh.triangle(index) else { return false };
            let new = triangle.map(|v| if v == a || v == b { merged } else { mesh.positions[v as usize] });
            let (n0, n1) = (mesh.cross(triangle), cross(new));
            n0.dot(n1) < 0.5 * n0.length() * n1.length() || n1.length() < 1e-12
        };
        if mesh.fan(a).iter().chain(mesh.fan(b)).filter(|t| !pair.contains(t)).any(turned) {
            return;
        }
        pair.iter().for_each(|&t| self.mesh.set(t, None));
        for index in self.mesh.fan(b).to_vec() {
            let moved = self.mesh.triangle(index).map(|t| t.map(|v| if v == b { a } else { v }));
            self.mesh.set(index, moved);
        }
        (self.mesh.positions[a as usize], self.wanted[a as usize]) = (merged, wanted);
    }

    /// Flips edges towards valence six.
    fn flip(&mut self) {
        for [a, b] in self.edges() {
            let mesh = &self.mesh;
            let Some([s, t]) = self.sides([a, b]) else { continue };
            let (Some(c), Some(d)) = (mesh.opposite(s, [a, b]), mesh.opposite(t, [a, b])) else { continue };
            let valence = |v: u32| mesh.fan(v).len() as i64;
            let miss = |v: u32, change: i64| (valence(v) + change - 6).pow(2);
            let before = miss(a, 0) + miss(b, 0) + miss(c, 0) + miss(d, 0);
            let after = miss(a, -1) + miss(b, -1) + miss(c, 1) + miss(d, 1);
            if after >= before || valence(a) <= 3 || valence(b) <= 3 || c == d || mesh.adjoins(c, d) {
                continue;
            }
            let (Some(first), Some(second)) = (mesh.triangle(s), mesh.triangle(t)) else { continue };
            let (new_first, new_second) =
                (first.map(|v| if v == b { d } else { v }), second.map(|v| if v == a { c } else { v }));
            let old = (mesh.cross(first) + mesh.cross(second)).normalize_or_zero();
            let flat = |t: [u32; 3]| mesh.cross(t).normalize_or_zero().dot(old) < 0.5;
            if flat(new_first) || flat(new_second) {
                continue;
            }
            self.mesh.set(s, Some(new_first));
            self.mesh.set(t, Some(new_second));
        }
    }

    /// Moves vertices towards their ring's centre within the tangent plane, then back onto the surface.
    fn relax(&mut self) {
        let mesh = &self.mesh;
        // Weighted so that a finer wanted edge length nearby draws vertices to it.
        let pull = |u: u32| (mesh.positions[u as usize], 1.0 / self.wanted[u as usize]);
        let moved = (0..mesh.positions.len() as u32).map(|v| {
            if mesh.fan(v).is_empty() {
                return mesh.positions[v as usize];
            }
            let ring = mesh.ring(v).into_iter().map(pull);
            let (sum, weight) = ring.fold((DVec3::ZERO, 0.0), |(s, w), (q, k)| (s + q * k, w + k));
            (self.project)(mesh.slid(v, sum / weight))
        });
        self.mesh.positions = moved.collect();
        for v in 0..self.wanted.len() {
            if !self.mesh.fan(v as u32).is_empty() {
                self.wanted[v] = (self.edge)(self.mesh.positions[v]);
            }
        }
    }
}
