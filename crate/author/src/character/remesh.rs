//! Even triangles on an implicit surface: split, collapse, flip, relax, project (Botsch & Kobbelt 2004).
//! The wanted edge length varies over the surface; the mesh is closed and stays a manifold of the same topology.

use crate::rig::Mesh;
use glam::DVec3;

/// A closed mesh under change: dead triangles are `None`, `fans` list the live triangles around each vertex.
struct Remesher<'a> {
    positions: Vec<DVec3>,
    triangles: Vec<Option<[u32; 3]>>,
    fans: Vec<Vec<u32>>,
    /// Wanted edge length at each vertex, metres.
    wanted: Vec<f64>,
    edge: &'a dyn Fn(DVec3) -> f64,
    project: &'a dyn Fn(DVec3) -> DVec3,
}

/// Remeshes `mesh` to edges near `edge(p)` metres, vertices kept on the surface by `project`.
pub fn remesh(mesh: &Mesh, edge: &dyn Fn(DVec3) -> f64, project: &dyn Fn(DVec3) -> DVec3, rounds: usize) -> Mesh {
    let mut fans = vec![vec![]; mesh.positions.len()];
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        triangle.iter().for_each(|&v| fans[v as usize].push(index as u32));
    }
    let triangles = mesh.triangles.iter().copied().map(Some).collect();
    let wanted = mesh.positions.iter().map(|&p| edge(p)).collect();
    let mut work = Remesher { positions: mesh.positions.clone(), triangles, fans, wanted, edge, project };
    for _ in 0..rounds {
        work.split_long();
        work.collapse_short();
        work.flip();
        work.relax();
    }
    work.finish()
}

impl Remesher<'_> {
    /// Live edges (a < b), each once, in triangle order.
    fn edges(&self) -> Vec<[u32; 2]> {
        let sides = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        // On a closed oriented mesh each edge is seen once in either direction.
        self.triangles.iter().flatten().flat_map(sides).filter(|[a, b]| a < b).collect()
    }

    /// Length over wanted length.
    fn ratio(&self, a: u32, b: u32) -> f64 {
        let (a, b) = (a as usize, b as usize);
        self.positions[a].distance(self.positions[b]) * 2.0 / (self.wanted[a] + self.wanted[b])
    }

    /// The two triangles at an edge, or `None` if it is no longer a manifold edge.
    fn sides(&self, a: u32, b: u32) -> Option<[u32; 2]> {
        let mut both = self.fans[a as usize].iter().filter(|t| self.fans[b as usize].contains(t));
        let pair = [*both.next()?, *both.next()?];
        both.next().is_none().then_some(pair)
    }

    /// The corner of `triangle` that is neither `a` nor `b`.
    fn opposite(&self, triangle: u32, a: u32, b: u32) -> Option<u32> {
        self.triangles[triangle as usize]?.into_iter().find(|&v| v != a && v != b)
    }

    fn neighbours(&self, v: u32) -> Vec<u32> {
        let live = self.fans[v as usize].iter().filter_map(|&t| self.triangles[t as usize]);
        let mut ring: Vec<u32> = live.flatten().filter(|&u| u != v).collect();
        ring.sort_unstable();
        ring.dedup();
        ring
    }

    fn set(&mut self, index: u32, triangle: Option<[u32; 3]>) {
        if let Some(old) = self.triangles[index as usize] {
            old.iter().for_each(|&v| self.fans[v as usize].retain(|&t| t != index));
        }
        if let Some(new) = triangle {
            new.iter().for_each(|&v| self.fans[v as usize].push(index));
        }
        self.triangles[index as usize] = triangle;
    }

    fn split_long(&mut self) {
        let mut long: Vec<(f64, [u32; 2])> = self.edges().into_iter().map(|e| (self.ratio(e[0], e[1]), e)).collect();
        long.retain(|&(ratio, _)| ratio > 4.0 / 3.0);
        long.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
        for (_, [a, b]) in long {
            let Some(pair) = self.sides(a, b) else { continue };
            let middle = self.positions.len() as u32;
            self.positions.push((self.project)((self.positions[a as usize] + self.positions[b as usize]) * 0.5));
            self.fans.push(vec![]);
            self.wanted.push((self.wanted[a as usize] + self.wanted[b as usize]) * 0.5);
            for index in pair {
                let Some(triangle) = self.triangles[index as usize] else { continue };
                let replace = |old: u32| triangle.map(|v| if v == old { middle } else { v });
                let (first, second) = (replace(a), replace(b));
                self.set(index, Some(first));
                self.triangles.push(None);
                self.set(self.triangles.len() as u32 - 1, Some(second));
            }
        }
    }

    fn collapse_short(&mut self) {
        let mut short: Vec<(f64, [u32; 2])> = self.edges().into_iter().map(|e| (self.ratio(e[0], e[1]), e)).collect();
        short.retain(|&(ratio, _)| ratio < 0.8);
        short.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        for (_, [a, b]) in short {
            // An earlier collapse may have stretched or removed this edge.
            if !self.fans[a as usize].is_empty() && !self.fans[b as usize].is_empty() && self.ratio(a, b) < 0.8 {
                self.collapse(a, b);
            }
        }
    }

    /// Merges `b` into `a` at their projected midpoint, unless that would break the manifold, flip a triangle
    /// or leave an edge long enough to be split again.
    fn collapse(&mut self, a: u32, b: u32) {
        let Some(pair) = self.sides(a, b) else { return };
        let (ring_a, ring_b) = (self.neighbours(a), self.neighbours(b));
        let shared: Vec<u32> = ring_a.iter().copied().filter(|v| ring_b.contains(v)).collect();
        let thin = shared.iter().any(|&v| self.fans[v as usize].len() <= 3);
        if shared.len() != 2 || thin || ring_a.len() + ring_b.len() > 13 {
            return;
        }
        let merged = (self.project)((self.positions[a as usize] + self.positions[b as usize]) * 0.5);
        let wanted = (self.wanted[a as usize] + self.wanted[b as usize]) * 0.5;
        let far = |&v: &u32| {
            let allowed = 4.0 / 3.0 * (self.wanted[v as usize] + wanted) * 0.5;
            v != a && v != b && self.positions[v as usize].distance(merged) > allowed
        };
        if ring_a.iter().chain(&ring_b).any(far) {
            return;
        }
        let touched: Vec<u32> =
            self.fans[a as usize].iter().chain(&self.fans[b as usize]).copied().filter(|t| !pair.contains(t)).collect();
        let turned = |&index: &u32| {
            let Some(triangle) = self.triangles[index as usize] else { return false };
            let old = triangle.map(|v| self.positions[v as usize]);
            let new = triangle.map(|v| if v == a || v == b { merged } else { self.positions[v as usize] });
            let (n0, n1) = (normal(old), normal(new));
            n0.dot(n1) < 0.5 * n0.length() * n1.length() || n1.length() < 1e-12
        };
        if touched.iter().any(turned) {
            return;
        }
        pair.iter().for_each(|&t| self.set(t, None));
        for index in self.fans[b as usize].clone() {
            let moved = self.triangles[index as usize].map(|t| t.map(|v| if v == b { a } else { v }));
            self.set(index, moved);
        }
        (self.positions[a as usize], self.wanted[a as usize]) = (merged, wanted);
    }

    /// Flips edges towards valence six.
    fn flip(&mut self) {
        for [a, b] in self.edges() {
            let Some([s, t]) = self.sides(a, b) else { continue };
            let (Some(c), Some(d)) = (self.opposite(s, a, b), self.opposite(t, a, b)) else { continue };
            let valence = |v: u32| self.fans[v as usize].len() as i64;
            let miss = |v: u32, change: i64| (valence(v) + change - 6).pow(2);
            let before = miss(a, 0) + miss(b, 0) + miss(c, 0) + miss(d, 0);
            let after = miss(a, -1) + miss(b, -1) + miss(c, 1) + miss(d, 1);
            if after >= before || valence(a) <= 3 || valence(b) <= 3 || c == d || self.neighbours(c).contains(&d) {
                continue;
            }
            let (Some(first), Some(second)) = (self.triangles[s as usize], self.triangles[t as usize]) else {
                continue;
            };
            let (new_first, new_second) =
                (first.map(|v| if v == b { d } else { v }), second.map(|v| if v == a { c } else { v }));
            let at = |t: [u32; 3]| normal(t.map(|v| self.positions[v as usize]));
            let old = (at(first) + at(second)).normalize_or_zero();
            let flat = |t: [u32; 3]| at(t).normalize_or_zero().dot(old) < 0.5;
            if flat(new_first) || flat(new_second) {
                continue;
            }
            self.set(s, Some(new_first));
            self.set(t, Some(new_second));
        }
    }

    /// Moves vertices towards their ring's centre within the tangent plane, then back onto the surface.
    fn relax(&mut self) {
        let mut moved = self.positions.clone();
        for v in 0..self.positions.len() as u32 {
            let live: Vec<[u32; 3]> =
                self.fans[v as usize].iter().filter_map(|&t| self.triangles[t as usize]).collect();
            if live.is_empty() {
                continue;
            }
            let ring = self.neighbours(v);
            let p = self.positions[v as usize];
            // Weighted so that a finer wanted edge length nearby draws vertices to it.
            let pull = |&u: &u32| (self.positions[u as usize], 1.0 / self.wanted[u as usize]);
            let (sum, weight) = ring.iter().map(pull).fold((DVec3::ZERO, 0.0), |(s, w), (q, k)| (s + q * k, w + k));
            let up: DVec3 =
                live.iter().map(|t| normal(t.map(|u| self.positions[u as usize]))).sum::<DVec3>().normalize_or_zero();
            let step = sum / weight - p;
            moved[v as usize] = (self.project)(p + 0.7 * (step - up * up.dot(step)));
        }
        self.positions = moved;
        for v in 0..self.positions.len() {
            if !self.fans[v].is_empty() {
                self.wanted[v] = (self.edge)(self.positions[v]);
            }
        }
    }

    fn finish(self) -> Mesh {
        let mut index = vec![u32::MAX; self.positions.len()];
        let mut mesh = Mesh::default();
        for (v, p) in self.positions.iter().enumerate() {
            if !self.fans[v].is_empty() {
                index[v] = mesh.positions.len() as u32;
                mesh.positions.push(*p);
            }
        }
        mesh.triangles = self.triangles.iter().flatten().map(|t| t.map(|v| index[v as usize])).collect();
        mesh
    }
}

/// Twice the area, along the outward normal.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}
