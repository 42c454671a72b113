//! Colour at p: the mean over joined lofts, weighted by exp(-(d - d_min)/τ), then each loft of paint in turn over it.
//! A border of paint is as wide as its blend. At blend zero it is crisp: vertices move onto it, and triangles on either
//! side get vertices of their own.

use super::loft::{Loft, Role};
use crate::motion::curve::smoothstep;
use ctsn_rig::{Mesh, Surface};
use glam::DVec3;
use std::collections::BTreeMap;

/// How fast a farther loft's colour fades, metres: about a third of a fine edge, so a seam is one edge wide.
const FADE: f64 = 0.002;

/// Linear RGB of the surface of `lofts` at `p`, without crisp paint.
fn soft(lofts: &[Loft], p: DVec3) -> DVec3 {
    let joined = || lofts.iter().filter(|loft| loft.role == Role::Join).map(|loft| (loft, loft.distance(p)));
    let nearest = joined().map(|(_, distance)| distance).fold(f64::INFINITY, f64::min);
    let blended = joined().fold((DVec3::ZERO, 0.0), |(sum, total), (loft, distance)| {
        let share = (-(distance - nearest) / FADE).exp();
        (sum + rgb(loft) * share, total + share)
    });
    let painted = lofts.iter().filter(|loft| loft.role == Role::Paint && loft.blend > 0.0);
    painted.fold(blended.0 / blended.1, |under, loft| {
        under.lerp(rgb(loft), smoothstep(0.5 - loft.distance(p) / loft.blend))
    })
}

fn rgb(loft: &Loft) -> DVec3 {
    DVec3::from(loft.colour.map(f64::from))
}

/// The last loft of crisp paint that holds `p`.
fn crisp(lofts: &[Loft], p: DVec3) -> Option<usize> {
    let holds = |loft: &Loft| loft.role == Role::Paint && loft.blend == 0.0 && loft.near(p) && loft.distance(p) < 0.0;
    lofts.iter().rposition(holds)
}

/// Moves vertices onto the borders of crisp paint. Where a border crosses an edge, the nearer end moves to the
/// crossing, by at most half the edge. A vertex with several crossings takes the nearest.
pub fn align(mesh: &mut Mesh, lofts: &[Loft], project: impl Fn(DVec3) -> DVec3) {
    let class: Vec<Option<usize>> = mesh.positions.iter().map(|&p| crisp(lofts, p)).collect();
    let mut nearest: BTreeMap<u32, (f64, DVec3)> = BTreeMap::new();
    for triangle in &mesh.triangles {
        for i in 0..3 {
            let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
            let (from, to) = (mesh.positions[a as usize], mesh.positions[b as usize]);
            if a > b || class[a as usize] == class[b as usize] {
                continue;
            }
            let (mut inside, mut outside) = (0.0, 1.0);
            for _ in 0..16 {
                let middle = 0.5 * (inside + outside);
                let same = crisp(lofts, from.lerp(to, middle)) == class[a as usize];
                *if same { &mut inside } else { &mut outside } = middle;
            }
            let (vertex, share) = if inside < 0.5 { (a, inside) } else { (b, 1.0 - inside) };
            let way = share * from.distance(to);
            if nearest.get(&vertex).is_none_or(|&(shortest, _)| way < shortest) {
                nearest.insert(vertex, (way, from.lerp(to, inside)));
            }
        }
    }
    for (vertex, (_, border)) in nearest {
        mesh.positions[vertex as usize] = project(border);
    }
}

/// Adds the drawn vertices and triangles of `mesh`, the shell made of `lofts`. `first`: body vertex of its vertex 0.
pub fn draw(surface: &mut Surface, mesh: &Mesh, lofts: &[Loft], first: u32) {
    let mut drawn: BTreeMap<(u32, Option<usize>), u32> = BTreeMap::new();
    for triangle in &mesh.triangles {
        let centre = triangle.iter().map(|&v| mesh.positions[v as usize]).sum::<DVec3>() / 3.0;
        let paint = crisp(lofts, centre);
        surface.triangles.push(triangle.map(|v| {
            *drawn.entry((v, paint)).or_insert_with(|| {
                let colour = paint.map_or_else(|| soft(lofts, mesh.positions[v as usize]), |loft| rgb(&lofts[loft]));
                surface.vertex.push(first + v);
                surface.colour.push(colour.to_array().map(|channel| channel as f32));
                surface.vertex.len() as u32 - 1
            })
        }));
    }
}
