//! Isotropic remeshing: split, collapse, flip, relax, and project: onto a field's zero set, rims onto their planes, or
//! onto whatever a caller names.
//! Botsch & Kobbelt, A Remeshing Approach to Multiresolution Modeling (2004), §4.

use super::cut::Piece;
use super::field::Field;
use super::region::Region;
use ctsn_rig::mesh::triangle::{cross, least_angle};
use ctsn_rig::mesh::{DynamicMesh, around, ordered};
use glam::DVec3;
use std::collections::BTreeMap;

/// Where a vertex belongs that came to a point: by its rim, where it is on one, that point, and its unit normal.
pub(crate) type Onto<'a> = dyn Fn(Option<usize>, DVec3, DVec3) -> DVec3 + 'a;

/// Remeshes a field's zero set to an edge length that gives about `target` vertices; rims stay on the borders of their
/// regions.
pub(crate) fn remesh(piece: Piece, field: &Field, regions: &[Region], target: usize) -> Piece {
    let onto = |rim: Option<usize>, mut point: DVec3, _: DVec3| {
        let Some(region) = rim else { return field.project(point) };
        for _ in 0..3 {
            point = field.project(point);
            point = regions[region].project(point);
        }
        point
    };
    even(piece, &onto, target)
}

/// Remeshes to an edge length that gives about `target` vertices, which stay where `onto` puts them.
pub(crate) fn even(piece: Piece, onto: &Onto, target: usize) -> Piece {
    let area = piece.mesh.area();
    // An even triangulation has one vertex per two equilateral triangles, √3/2 L² of surface.
    let mut edge = (area / (target as f64 * 0.866)).sqrt();
    let Piece { mesh, rim } = piece;
    let mut sheet = Sheet { mesh: DynamicMesh::new(mesh), rim, onto };
    for round in 0..14 {
        sheet.split(4.0 / 3.0 * edge);
        sheet.collapse(0.8 * edge, 4.0 / 3.0 * edge);
        sheet.flip(Better::Valence);
        sheet.relax();
        if round >= 4 {
            edge *= (sheet.mesh.count() as f64 / target as f64).sqrt().clamp(0.9, 1.1);
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
    mesh: DynamicMesh,
    /// Region or loop per rim vertex.
    rim: Vec<Option<usize>>,
    onto: &'a Onto<'a>,
}

impl Sheet<'_> {
    fn into_piece(self) -> Piece {
        let (mesh, kept) = self.mesh.finish();
        Piece { mesh, rim: kept.into_iter().map(|v| self.rim[v]).collect() }
    }

    /// Edges (low, high), ascending.
    fn edges(&self) -> Vec<[u32; 2]> {
        let mut edges: Vec<_> = self.mesh.triangles().flat_map(around).map(ordered).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Splits every edge longer than `longest` at its middle, longest edges first.
    fn split(&mut self, longest: f64) {
        let mut edges = self.edges();
        edges.retain(|&edge| self.mesh.length(edge) > longest);
        edges.sort_by(|x, y| self.mesh.length(*y).total_cmp(&self.mesh.length(*x)));
        for [a, b] in edges {
            let beside = self.mesh.beside([a, b]);
            let middle = self.mesh.add_vertex(self.mesh.middle([a, b]));
            let on_rim = beside.len() == 1;
            self.rim.push(if on_rim { self.rim[a as usize].or(self.rim[b as usize]) } else { None });
            for t in beside {
                let Some(old) = self.mesh.triangle(t) else { continue };
                self.mesh.alter(t, old.map(|v| if v == b { middle } else { v }));
                self.mesh.add_triangle(old.map(|v| if v == a { middle } else { v }));
            }
        }
    }

    /// Collapses every edge shorter than `shortest` where the surface stays a manifold, no edge grows past `longest`
    /// and no triangle turns over.
    fn collapse(&mut self, shortest: f64, longest: f64) {
        for [a, b] in self.edges() {
            let mesh = &self.mesh;
            let alive = !mesh.fan(a).is_empty() && !mesh.fan(b).is_empty();
            if !alive || mesh.length([a, b]) >= shortest {
                continue;
            }
            let beside = mesh.beside([a, b]);
            let (ring_a, ring_b) = (mesh.ring(a), mesh.ring(b));
            let shared = ring_a.iter().filter(|v| ring_b.contains(v)).count();
            let (rim_a, rim_b) = (self.rim[a as usize], self.rim[b as usize]);
            let across = rim_a.is_some() && rim_b.is_some() && beside.len() == 2;
            if beside.is_empty() || shared != beside.len() || across {
                continue;
            }
            let (from, to) = if rim_b.is_some() && rim_a.is_none() { (a, b) } else { (b, a) };
            let point = match (rim_a, rim_b) {
                (Some(_), None) => mesh.positions[a as usize],
                (None, Some(_)) => mesh.positions[b as usize],
                _ => mesh.middle([a, b]),
            };
            let mut near = ring_a.iter().chain(&ring_b).filter(|&&v| v != a && v != b);
            let too_long = near.any(|&v| mesh.positions[v as usize].distance(point) > longest);
            if !too_long && !self.turns(from, to, point) && !self.turns(to, from, point) {
                self.merge(from, to, point, &beside);
            }
        }
    }

    /// Would moving `v` to `point` turn over one of its triangles that does not hold `other`?
    fn turns(&self, v: u32, other: u32, point: DVec3) -> bool {
        let fan = self.mesh.fan(v).iter().filter_map(|t| self.mesh.triangle(*t));
        fan.filter(|t| !t.contains(&other)).any(|t| {
            let moved = t.map(|w| if w == v { point } else { self.mesh.positions[w as usize] });
            let (before, after) = (self.mesh.cross(t), cross(moved));
            before.dot(after) < 0.2 * before.length() * after.length()
        })
    }

    /// Moves `to` to the point and gives it what `from` had.
    fn merge(&mut self, from: u32, to: u32, point: DVec3, beside: &[u32]) {
        beside.iter().for_each(|t| self.mesh.set(*t, None));
        for t in self.mesh.fan(from).to_vec() {
            let Some(old) = self.mesh.triangle(t) else { continue };
            self.mesh.alter(t, old.map(|v| if v == from { to } else { v }));
        }
        self.mesh.positions[to as usize] = point;
    }

    /// Flips inner edges where that is better and the surface does not fold.
    fn flip(&mut self, better: Better) {
        let mut valence: Vec<_> = (0..self.rim.len()).map(|v| self.mesh.ring(v as u32).len() as i64).collect();
        for [a, b] in self.edges() {
            let mesh = &self.mesh;
            let &[left, right] = &mesh.beside([a, b])[..] else { continue };
            let (Some(c), Some(d)) = (mesh.opposite(left, [a, b]), mesh.opposite(right, [a, b])) else { continue };
            if c == d || mesh.adjoins(c, d) {
                continue;
            }
            let excess = |v: u32, change: i64| {
                let wanted = if self.rim[v as usize].is_some() { 4 } else { 6 };
                (valence[v as usize] + change - wanted).pow(2)
            };
            let before: i64 = [a, b, c, d].iter().map(|&v| excess(v, 0)).sum();
            let after = excess(a, -1) + excess(b, -1) + excess(c, 1) + excess(d, 1);
            if better == Better::Valence && after >= before {
                continue;
            }
            // Which of the two triangles runs a -> b decides the winding of the new pair.
            let runs = |t: u32| mesh.triangle(t).is_some_and(|t| around(t).contains(&[a, b]));
            let (c, d, left, right) = if runs(left) { (c, d, left, right) } else { (d, c, right, left) };
            let (Some(first), Some(second)) = (mesh.triangle(left), mesh.triangle(right)) else { continue };
            let (new, normal) = ([[a, d, c], [b, c, d]], mesh.cross(first) + mesh.cross(second));
            let sound = |t: [u32; 3]| mesh.cross(t).dot(normal) > 0.5 * mesh.cross(t).length() * normal.length();
            let angle = |t: [u32; 3]| least_angle(t.map(|v| mesh.positions[v as usize]));
            let wider = || {
                let old = angle(first).min(angle(second));
                new.iter().all(|t| angle(*t) > old + 1.0)
            };
            if (better == Better::Valence || wider()) && new.into_iter().all(sound) {
                self.mesh.alter(left, new[0]);
                self.mesh.alter(right, new[1]);
                [a, b, c, d].into_iter().for_each(|v| valence[v as usize] = self.mesh.ring(v).len() as i64);
            }
        }
    }

    /// Moves vertices towards the mean of their neighbours, within the surface; rim vertices along the rim.
    fn relax(&mut self) {
        let mesh = &self.mesh;
        let mut along: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for [a, b] in self.edges() {
            if mesh.beside([a, b]).len() == 1 {
                along.entry(a).or_default().push(b);
                along.entry(b).or_default().push(a);
            }
        }
        let moved = (0..mesh.positions.len() as u32).map(|v| {
            if mesh.fan(v).is_empty() {
                return mesh.positions[v as usize];
            }
            let near = along.get(&v).cloned().unwrap_or_else(|| mesh.ring(v));
            let mean = near.iter().map(|&w| mesh.positions[w as usize]).sum::<DVec3>() / near.len() as f64;
            let normal = mesh.fan(v).iter().filter_map(|t| mesh.triangle(*t)).map(|t| mesh.cross(t)).sum::<DVec3>();
            (self.onto)(self.rim[v as usize], mesh.slid(v, mean), normal.normalize_or_zero())
        });
        self.mesh.positions = moved.collect();
    }
}
