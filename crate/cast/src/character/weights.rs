//! W0_j(v) ∝ Σ_lofts exp(-(d - d_min)/τ) · influence_j, then heat flow over the mesh; simulation.md §4.1.
//! The lofts know their joints, so the flow only has to round the seams between them.

use super::loft::{Loft, Role};
use ctsn_rig::{Mesh, SkinWeights};
use glam::DVec3;

/// How fast a farther loft's influence fades, metres.
const FADE: f64 = 0.012;
/// Heat flow time as a length squared: influence spreads about this far, metres.
const SPREAD: f64 = 0.035;
/// Most joints per vertex.
const MOST: usize = 4;

/// Skin weights of each vertex of `mesh` for `joints` joints.
pub fn weights(mesh: &Mesh, lofts: &[Loft], joints: usize) -> Vec<SkinWeights> {
    let dense: Vec<Vec<f64>> = mesh.positions.iter().map(|&p| seed(lofts, p, joints)).collect();
    diffuse(mesh, dense).iter().map(|row| strongest(row)).collect()
}

/// Weights from the lofts around `p` alone, summing to one.
fn seed(lofts: &[Loft], p: DVec3, joints: usize) -> Vec<f64> {
    let lofts = || lofts.iter().filter(|loft| loft.role == Role::Join);
    let distances: Vec<f64> = lofts().map(|loft| loft.distance(p)).collect();
    let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let mut row = vec![0.0; joints];
    for (loft, distance) in lofts().zip(distances) {
        let share = (-(distance - nearest) / FADE).exp();
        loft.influence(p).for_each(|(joint, influence)| row[joint] += share * influence);
    }
    normalise(row)
}

/// Explicit heat flow with inverse-length weights. Its rate grows as edges shrink: weights spread as far on fine parts.
fn diffuse(mesh: &Mesh, mut rows: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut rings = vec![vec![]; rows.len()];
    for triangle in &mesh.triangles {
        for i in 0..3 {
            let (a, b) = (triangle[i] as usize, triangle[(i + 1) % 3] as usize);
            let length = mesh.positions[a].distance(mesh.positions[b]);
            rings[a].push((b, length));
        }
    }
    const STEPS: usize = 24;
    let time = SPREAD * SPREAD / STEPS as f64;
    for _ in 0..STEPS {
        let flow = |(v, row): (usize, &Vec<f64>)| {
            let mean = rings[v].iter().map(|&(_, length)| length).sum::<f64>() / rings[v].len().max(1) as f64;
            let weight: f64 = rings[v].iter().map(|&(_, length)| 1.0 / length).sum();
            let rate = (2.0 * time / (mean * mean)).min(0.5);
            let mut next: Vec<f64> = row.iter().map(|w| w * (1.0 - rate)).collect();
            for &(u, length) in &rings[v] {
                next.iter_mut().zip(&rows[u]).for_each(|(w, other)| *w += rate * other / (length * weight));
            }
            next
        };
        rows = rows.iter().enumerate().map(flow).collect();
    }
    rows
}

/// The `MOST` strongest weights, summing to one. All are lowered by the first one left out, so that a joint fades out
/// from vertex to vertex instead of being cut off.
fn strongest(row: &[f64]) -> SkinWeights {
    let mut sorted: Vec<(usize, f64)> = row.iter().copied().enumerate().filter(|&(_, w)| w > 0.0).collect();
    sorted.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let floor = sorted.get(MOST).map_or(0.0, |&(_, w)| w).max(2e-3);
    let mut kept: SkinWeights =
        sorted.into_iter().take(MOST).map(|(j, w)| (j, w - floor)).filter(|&(_, w)| w > 0.0).collect();
    let sum: f64 = kept.iter().map(|&(_, w)| w).sum();
    kept.iter_mut().for_each(|(_, w)| *w /= sum);
    kept
}

fn normalise(mut row: Vec<f64>) -> Vec<f64> {
    let sum: f64 = row.iter().sum();
    row.iter_mut().for_each(|w| *w /= sum);
    row
}
