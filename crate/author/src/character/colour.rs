//! c(p) = Σ_joined exp(-(d - d_min)/τ) c_loft / Σ, then each painted loft in turn over it, its border as soft as its blend.

use super::loft::{Loft, Role, smoothstep};
use glam::DVec3;

/// How fast a farther loft's colour fades, metres: about a third of a fine edge, so a seam is one edge wide.
const FADE: f64 = 0.002;

/// Linear RGB of the surface of `lofts` at `p`.
pub fn colour(lofts: &[Loft], p: DVec3) -> [f32; 3] {
    let of = |loft: &Loft| DVec3::from(loft.colour.map(f64::from));
    let joined = || lofts.iter().filter(|loft| loft.role == Role::Join).map(|loft| (loft, loft.distance(p)));
    let nearest = joined().map(|(_, distance)| distance).fold(f64::INFINITY, f64::min);
    let blended = joined().fold((DVec3::ZERO, 0.0), |(sum, total), (loft, distance)| {
        let share = (-(distance - nearest) / FADE).exp();
        (sum + of(loft) * share, total + share)
    });
    let painted = lofts.iter().filter(|loft| loft.role == Role::Paint).fold(blended.0 / blended.1, |under, loft| {
        under.lerp(of(loft), smoothstep(0.5 - loft.distance(p) / loft.blend))
    });
    painted.to_array().map(|channel| channel as f32)
}
