//! Isotropic remeshing: split, collapse, flip, relax, and project onto the field's zero set; rims stay on their planes.
//! Botsch & Kobbelt, A Remeshing Approach to Multiresolution Modeling (2004), §4.

use super::cut::{Piece, compact};
use super::field::Field;
use super::opening::Opening;
use super::quality::least_angle;
use crate::triangle;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Triangle removed.
const GONE: [u32; 3] = [u32::MAX; 3];

/// Remeshes to an edge length that gives about `target` vertices.
pub(super) fn remesh(piece: Piece, field: &Field, openings: &[Opening], target: usize) -> Piece {
    let area: f64 =
        piece.mesh.triangles.iter().map(|t| triangle::area(t.map(|v| piece.mesh.positions[v as usize]))).sum();
    // An even triangulation has one vertex per two equilateral triangles, √3/2 L² of surface.
    let mut edge = (area / (target as f64 * 0.866)).sqrt();
    let mut sheet = Sheet::new(piece, field, openings);
    for round in 0..14 {
        sheet.split(4.0 / 3.0 * edge);
        sheet.collapse(0.8 * edge, 4.0 / 3.0 * edge);
        sheet.flip(Better::Valence);
        sheet.relax();
        if round >= 4 {
            edge *= (sheet.count() as f64 / target as f64).sqrt().clamp(0.9, 1.1);
        }
    }
    (0..6).for_each(|_| {
        sheet.flip(Better::Valence);
        sheet.relax();
    });
    // Slivers that creases leave: valence does not see them.
    (0..3).for_each(|_| sheet.flip(Better::Angle));
    sheet.into_piece()
}

/// What an edge is flipped for.
#[derive(Clone, Copy, PartialEq)]
enum Better {
    /// Valences nearer to six, four on the rim.
    Valence,
    /// A larger smallest angle.
    Angle,
}

/// A mesh under edit.
struct Sheet<'a> {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// Triangles at each vertex.
    around: Vec<Vec<u32>>,
    /// Opening per rim vertex.
    rim: Vec<Option<usize>>,
    field: &'a Field,
    openings: &'a [Opening],
}

impl<'a> Sheet<'a> {
    fn new(piece: Piece, field: &'a Field, openings: &'a [Opening]) -> Sheet<'a> {
        let mut around = vec![Vec::new(); piece.mesh.positions.len()];
        for (index, triangle) in piece.mesh.triangles.iter().enumerate() {
            triangle.iter().for_each(|&v| around[v as usize].push(index as u32));
        }
        let Piece { mesh, rim } = piece;
        Sheet { positions: mesh.positions, triangles: mesh.triangles, around, rim, field, openings }
    }

    fn into_piece(self) -> Piece {
        let kept = self.triangles.iter().copied().filter(|t| *t != GONE).collect();
        compact(&self.positions, &self.rim, kept)
    }

    /// Vertices in use.
    fn count(&self) -> usize {
        self.around.iter().filter(|around| !around.is_empty()).count()
    }

    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize])
    }

    /// Edges (low, high) in a fixed order.
    fn edges(&self) -> Vec<(u32, u32)> {
        let edges = self
            .triangles
            .iter()
            .filter(|t| **t != GONE)
            .flat_map(|t| (0..3).map(|k| (t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3]))));
        edges.collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Triangles on an edge.
    fn beside(&self, a: u32, b: u32) -> Vec<u32> {
        let shares = |t: &&u32| self.triangles[**t as usize].contains(&b);
        self.around[a as usize].iter().filter(shares).copied().collect()
    }

    /// Vertices next to a vertex, ascending.
    fn ring(&self, v: u32) -> Vec<u32> {
        let near = self.around[v as usize].iter().flat_map(|&t| self.triangles[t as usize]).filter(|&w| w != v);
        near.collect::<BTreeSet<_>>().into_iter().collect()
    }

    fn length(&self, a: u32, b: u32) -> f64 {
        self.positions[a as usize].distance(self.positions[b as usize])
    }

    /// Onto the zero set; rim vertices onto their opening's border as well.
    fn project(&self, v: u32, mut point: DVec3) -> DVec3 {
        let Some(opening) = self.rim[v as usize] else { return self.field.project(point) };
        let opening = &self.openings[opening];
        for _ in 0..3 {
            point = self.field.project(point);
            point = opening.project(point);
        }
        point
    }

    /// Splits every edge longer than `longest` at its middle, longest edges first.
    fn split(&mut self, longest: f64) {
        let mut edges = self.edges();
        edges.retain(|&(a, b)| self.length(a, b) > longest);
        edges.sort_by(|x, y| self.length(y.0, y.1).total_cmp(&self.length(x.0, x.1)));
        for (a, b) in edges {
            let beside = self.beside(a, b);
            let middle = self.positions.len() as u32;
            self.positions.push((self.positions[a as usize] + self.positions[b as usize]) / 2.0);
            let on_rim = beside.len() == 1;
            self.rim.push(if on_rim { self.rim[a as usize].or(self.rim[b as usize]) } else { None });
            self.around.push(Vec::new());
            for t in beside {
                let old = self.triangles[t as usize];
                self.triangles[t as usize] = old.map(|v| if v == b { middle } else { v });
                let new = self.triangles.len() as u32;
                self.triangles.push(old.map(|v| if v == a { middle } else { v }));
                self.around[b as usize].retain(|&other| other != t);
                self.around[b as usize].push(new);
                self.around[middle as usize].extend([t, new]);
                let Some(&opposite) = old.iter().find(|&&v| v != a && v != b) else { continue };
                self.around[opposite as usize].push(new);
            }
        }
    }

    /// Collapses every edge shorter than `shortest` where the surface stays a manifold, no edge grows past `longest` and
    /// no triangle turns over.
    fn collapse(&mut self, shortest: f64, longest: f64) {
        for (a, b) in self.edges() {
            let alive = !self.around[a as usize].is_empty() && !self.around[b as usize].is_empty();
            if !alive || self.length(a, b) >= shortest {
                continue;
            }
            let beside = self.beside(a, b);
            let (ring_a, ring_b) = (self.ring(a), self.ring(b));
            let shared = ring_a.iter().filter(|v| ring_b.contains(v)).count();
            let (rim_a, rim_b) = (self.rim[a as usize], self.rim[b as usize]);
            let across = rim_a.is_some() && rim_b.is_some() && beside.len() == 2;
            if beside.is_empty() || shared != beside.len() || across {
                continue;
            }
            let (from, to) = if rim_b.is_some() && rim_a.is_none() { (a, b) } else { (b, a) };
            let point = match (rim_a, rim_b) {
                (Some(_), None) => self.positions[a as usize],
                (None, Some(_)) => self.positions[b as usize],
                _ => (self.positions[a as usize] + self.positions[b as usize]) / 2.0,
            };
            let near = ring_a.iter().chain(&ring_b).filter(|&&v| v != a && v != b);
            let too_long = near.clone().any(|&v| self.positions[v as usize].distance(point) > longest);
            if !too_long && !self.turns(from, to, point) && !self.turns(to, from, point) {
                self.merge(from, to, point, &beside);
            }
        }
    }

    /// Would moving `v` to `point` turn over one of its triangles that does not hold `other`?
    fn turns(&self, v: u32, other: u32, point: DVec3) -> bool {
        self.around[v as usize].iter().filter(|&&t| !self.triangles[t as usize].contains(&other)).any(|&t| {
            let [a, b, c] = self.corners(t);
            let [p, q, r] = self.triangles[t as usize].map(|w| if w == v { point } else { self.positions[w as usize] });
            let (before, after) = ((b - a).cross(c - a), (q - p).cross(r - p));
            before.dot(after) < 0.2 * before.length() * after.length()
        })
    }

    /// Moves `to` to the point and gives it what `from` had.
    fn merge(&mut self, from: u32, to: u32, point: DVec3, beside: &[u32]) {
        for &t in beside {
            for v in self.triangles[t as usize] {
                self.around[v as usize].retain(|&other| other != t);
            }
            self.triangles[t as usize] = GONE;
        }
        let moved = std::mem::take(&mut self.around[from as usize]);
        for &t in &moved {
            self.triangles[t as usize] = self.triangles[t as usize].map(|v| if v == from { to } else { v });
        }
        self.around[to as usize].extend(moved);
        self.positions[to as usize] = point;
    }

    /// Flips inner edges where that is better and the surface does not fold.
    fn flip(&mut self, better: Better) {
        for (a, b) in self.edges() {
            let beside = self.beside(a, b);
            let &[left, right] = &beside[..] else { continue };
            let opposite = |t: u32| self.triangles[t as usize].into_iter().find(|&v| v != a && v != b);
            let (Some(c), Some(d)) = (opposite(left), opposite(right)) else { continue };
            if c == d || self.ring(c).contains(&d) {
                continue;
            }
            let excess = |v: u32, change: i64| {
                let wanted = if self.rim[v as usize].is_some() { 4 } else { 6 };
                (self.ring(v).len() as i64 + change - wanted).pow(2)
            };
            let before: i64 = [a, b, c, d].iter().map(|&v| excess(v, 0)).sum();
            let after = excess(a, -1) + excess(b, -1) + excess(c, 1) + excess(d, 1);
            // Which of the two triangles runs a -> b decides the winding of the new pair.
            let runs = |t: u32| {
                (0..3).any(|k| self.triangles[t as usize][k] == a && self.triangles[t as usize][(k + 1) % 3] == b)
            };
            let (c, d, left, right) = if runs(left) { (c, d, left, right) } else { (d, c, right, left) };
            let new = [[a, d, c], [b, c, d]];
            let normal = |t: [u32; 3]| {
                let [p, q, r] = t.map(|v| self.positions[v as usize]);
                (q - p).cross(r - p)
            };
            let old = normal(self.triangles[left as usize]) + normal(self.triangles[right as usize]);
            let sound = new.iter().all(|t| normal(*t).dot(old) > 0.5 * normal(*t).length() * old.length());
            let angle = |t: [u32; 3]| least_angle(&self.positions, t);
            let old = [left, right].map(|t| angle(self.triangles[t as usize]));
            let wins = match better {
                Better::Valence => after < before,
                Better::Angle => new.iter().all(|t| angle(*t) > old[0].min(old[1]) + 1.0),
            };
            if wins && sound {
                self.triangles[left as usize] = new[0];
                self.triangles[right as usize] = new[1];
                self.around[b as usize].retain(|&t| t != left);
                self.around[a as usize].retain(|&t| t != right);
                self.around[c as usize].push(right);
                self.around[d as usize].push(left);
            }
        }
    }

    /// Moves vertices towards the mean of their neighbours, within the surface; rim vertices along the rim.
    fn relax(&mut self) {
        let normals = self.normals();
        let mut along: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (a, b) in self.edges() {
            if self.beside(a, b).len() == 1 {
                along.entry(a).or_default().push(b);
                along.entry(b).or_default().push(a);
            }
        }
        let moved: Vec<DVec3> = (0..self.positions.len() as u32)
            .map(|v| {
                let here = self.positions[v as usize];
                if self.around[v as usize].is_empty() {
                    return here;
                }
                let near = along.get(&v).cloned().unwrap_or_else(|| self.ring(v));
                let mean = near.iter().map(|&w| self.positions[w as usize]).sum::<DVec3>() / near.len() as f64;
                let normal = normals[v as usize];
                let step = mean - here;
                self.project(v, here + 0.7 * (step - normal * step.dot(normal)))
            })
            .collect();
        self.positions = moved;
    }

    /// Area-weighted vertex normals.
    fn normals(&self) -> Vec<DVec3> {
        let normal = |t: &u32| {
            let [a, b, c] = self.corners(*t);
            (b - a).cross(c - a)
        };
        self.around.iter().map(|around| around.iter().map(normal).sum::<DVec3>().normalize_or_zero()).collect()
    }
}
