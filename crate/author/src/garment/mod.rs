//! Dresses any rigged character: an offset shell of its body, cut at neck, sleeves and hem, evenly remeshed, with texture
//! coordinates. f = |x - body| - looseness, smoothed; garment = {f = 0} between the openings. simulation.md §4.2.

mod anatomy;
mod cut;
mod field;
mod hull;
mod opening;
mod quality;
mod remesh;
mod solid;
mod unwrap;

use crate::rig::{Character, Garment};
use crate::{Error, Result};
use field::Field;
use glam::DVec3;
use opening::{Opening, openings};
use solid::Solid;

#[cfg(test)]
mod test;

pub use hull::hull;
pub use quality::{Quality, quality};

/// How a garment is cut. Fractions run along a limb from where it leaves the trunk (0) to its tip (1).
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// Distance from the body, metres; `None`: 1/150 of the body's largest extent, 12 mm on a human.
    pub looseness: Option<f64>,
    /// Wanted number of vertices, 500 to 10000; the result is within a few per cent.
    pub vertices: usize,
    /// Names of the covered joints; `None`: trunk and the fractions below. With a list, the garment ends where it ends.
    pub joints: Option<Vec<String>>,
    /// Sleeves and leg holes: fraction of a paired limb that is covered.
    pub sleeve: f64,
    /// Hem around two legs that continue the trunk downwards: fraction of the legs that is covered.
    pub hem: f64,
    /// Neck and tail: fraction of an unpaired limb that is covered.
    pub collar: f64,
}

impl Default for Cut {
    fn default() -> Cut {
        Cut { looseness: None, vertices: 2500, joints: None, sleeve: 0.2, hem: 0.1, collar: 0.05 }
    }
}

/// A garment for the character in its canonical pose: one connected manifold, open only at neck, sleeves, hem and tail.
///
/// The body may be open, of several shells and self-intersecting. Characters without mirrored limbs get a band around
/// the middle of their longest axis.
pub fn shell(character: &Character, cut: &Cut) -> Result<Garment> {
    check(character, cut)?;
    let low = character.body.positions.iter().fold(DVec3::INFINITY, |low, p| low.min(*p));
    let high = character.body.positions.iter().fold(DVec3::NEG_INFINITY, |high, p| high.max(*p));
    let extent = (high - low).max_element();
    let cell = cell(low, high);
    let looseness = cut.looseness.unwrap_or(extent / 150.0);
    if !(looseness >= cell && looseness <= 0.1 * extent) {
        let (least, most) = (cell, 0.1 * extent);
        return Err(Error::Garment(format!("looseness: wanted {least:.4} to {most:.4} m, found {looseness}")));
    }
    let openings = openings(character, cut, extent)?;
    // The shell runs on past each opening, so that its end does not bend the cut.
    let past = 3.0 * looseness + 0.01 * extent;
    let (triangles, covered) = split_body(character, &openings, extent / 60.0, past);
    if !covered.contains(&true) {
        return Err(Error::Garment("no triangle of the body lies on the covered joints".into()));
    }
    let hang = |opening: &Opening| opening.hangs_from.map(|start| (start, opening.normal, past - opening.past(start)));
    let hangs: Vec<_> = openings.iter().filter_map(hang).collect();
    let smoothing = extent / 130.0;
    let solid = Solid { triangles: &triangles, covered: &covered, hangs: &hangs, looseness, smoothing };
    let field = Field::new(&solid, cell);
    let piece = cut::cut(cut::extract(&field), &openings, past);
    if piece.mesh.triangles.is_empty() {
        return Err(Error::Garment("nothing is left of the shell between the openings".into()));
    }
    let piece = remesh::remesh(piece, &field, &openings, cut.vertices);
    let quality = quality(&piece.mesh);
    if !quality.manifold || quality.loops == 0 {
        let found = format!("{} vertices, {} loops, manifold: {}", quality.vertices, quality.loops, quality.manifold);
        return Err(Error::Garment(format!("wanted an open manifold sheet, found {found}")));
    }
    Ok(Garment { surface: unwrap::unwrap(&piece.mesh), mesh: piece.mesh })
}

/// Voxel edge for a body between two corners, metres: 7 mm on a human, and at most six million voxels on a bulky body.
fn cell(low: DVec3, high: DVec3) -> f64 {
    let extent = (high - low).max_element();
    (extent / 250.0).max(((high - low).max(DVec3::splat(0.1 * extent)).element_product() / 6e6).cbrt())
}

/// Rejects what cannot be dressed.
fn check(character: &Character, cut: &Cut) -> Result<()> {
    let fail = |message: String| Err(Error::Garment(message));
    if !(500..=10_000).contains(&cut.vertices) {
        return fail(format!("vertex count: wanted 500 to 10000, found {}", cut.vertices));
    }
    for (name, fraction) in [("sleeve", cut.sleeve), ("hem", cut.hem), ("collar", cut.collar)] {
        if !(0.0..=0.9).contains(&fraction) {
            return fail(format!("{name}: wanted a fraction from 0 to 0.9, found {fraction}"));
        }
    }
    let body = &character.body;
    if body.triangles.is_empty() || character.joints.is_empty() {
        let (triangles, joints) = (body.triangles.len(), character.joints.len());
        return fail(format!("wanted a body with triangles and joints, found {triangles} and {joints}"));
    }
    if let Some(index) = body.positions.iter().position(|p| !p.is_finite()) {
        return fail(format!("body vertex {index}: wanted finite coordinates, found {}", body.positions[index]));
    }
    if body.positions.len() != character.weights.len() {
        return fail(format!("wanted {} skin weights, found {}", body.positions.len(), character.weights.len()));
    }
    Ok(())
}

/// The body's triangles, split until no edge is longer than `longest`, and which of them the garment, run on by `past`
/// metres, covers.
fn split_body(character: &Character, openings: &[Opening], longest: f64, past: f64) -> (Vec<[DVec3; 3]>, Vec<bool>) {
    let (mut triangles, mut covered) = (Vec::new(), Vec::new());
    let positions = &character.body.positions;
    for triangle in &character.body.triangles {
        let corners = triangle.map(|v| positions[v as usize]);
        // Barycentric corners still to split.
        let mut queue = vec![[DVec3::X, DVec3::Y, DVec3::Z]];
        while let Some(part) = queue.pop() {
            let [a, b, c] = part.map(|w| corners[0] * w.x + corners[1] * w.y + corners[2] * w.z);
            let lengths = [a.distance(b), b.distance(c), c.distance(a)];
            let k = if lengths[0] >= lengths[1].max(lengths[2]) { 0 } else { 1 + (lengths[2] > lengths[1]) as usize };
            if lengths[k] > longest {
                let middle = (part[k] + part[(k + 1) % 3]) / 2.0;
                let (mut first, mut second) = (part, part);
                (first[(k + 1) % 3], second[k]) = (middle, middle);
                queue.extend([first, second]);
            } else if (b - a).cross(c - a).length() > 1e-9 * lengths[k] * lengths[k] {
                let centre = (part[0] + part[1] + part[2]) / 3.0;
                let point = (a + b + c) / 3.0;
                let bare = |opening: &Opening| {
                    let [p, q, r] = triangle.map(|v| opening.beyond[v as usize]);
                    DVec3::new(p, q, r).dot(centre) > 0.5 && opening.past(point) > past
                };
                triangles.push([a, b, c]);
                covered.push(!openings.iter().any(bare));
            }
        }
    }
    (triangles, covered)
}
