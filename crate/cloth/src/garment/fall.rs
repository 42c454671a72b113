//! The field of a garment: the shell around what its pattern covers, with wide sleeves, cloth that falls free and
//! parted legs.

use super::draft::{Pattern, Sleeve};
use crate::wrap::{Field, Plane, Solid};
use glam::DVec3;

/// Slope (metres inwards per metre) at which cloth bridges from the thighs up to the waist.
const RISE: f64 = 0.3;

/// Half the gap between trouser legs, in voxels.
const HALF_GAP: f64 = 0.7;

/// The field of a pattern on a body, voxels of `cell` metres. `falling`: what of the body falls with the trunk, where
/// the pattern's hangs would drag other limbs along.
pub(super) fn field(solid: &Solid, falling: Option<&[bool]>, pattern: &Pattern, cell: f64) -> Field {
    let Pattern { hangs, sleeves, gap, .. } = pattern;
    let tubes = sleeves.iter().flat_map(|sleeve| sleeve.path.iter().zip(&sleeve.radii));
    let tubes: Vec<(DVec3, f64)> = tubes.map(|(point, radius)| (*point, *radius)).collect();
    let mut field = Field::around(solid, cell, &tubes);
    let band = solid.band(cell);
    let falling = falling.map(|falling| field.offset(solid, falling));
    field.values = field.offset(solid, solid.covered);
    field.unite(sleeves, band);
    let bounds = field.bounds(solid);
    let falling = falling.map(|values| field.cropped(&values, bounds));
    field.crop(bounds);
    if !hangs.is_empty() {
        let whole = field.values.clone();
        field.values = falling.unwrap_or_else(|| whole.clone());
        for hang in hangs {
            field.hang(hang, -hang.flare, band);
            field.hang(&hang.reversed(), RISE.max(hang.flare + 0.1), band);
        }
        field.values.iter_mut().zip(whole).for_each(|(value, whole)| *value = value.min(whole));
    }
    field.bridge(solid);
    if let Some(gap) = gap {
        field.part(gap);
    }
    field
}

impl Field {
    /// Keeps the solid off a plane, past another.
    fn part(&mut self, [middle, start]: &[Plane; 2]) {
        let [nx, ny, _] = self.size;
        for i in 0..self.values.len() {
            let point = self.point([i % nx, i / nx % ny, i / (nx * ny)]);
            let off = (HALF_GAP * self.cell - middle.past(point).abs()).min(start.past(point));
            self.values[i] = self.values[i].max(off as f32);
        }
    }

    /// Adds tubes around limbs.
    fn unite(&mut self, sleeves: &[Sleeve], band: f64) {
        for (sleeve, k) in sleeves.iter().flat_map(|sleeve| (1..sleeve.path.len()).map(move |k| (sleeve, k))) {
            let ([a, b], [ra, rb]) = ([k - 1, k].map(|k| sleeve.path[k]), [k - 1, k].map(|k| sleeve.radii[k] + band));
            let [xs, ys, zs] = self.range((a - ra).min(b - rb), (a + ra).max(b + rb));
            for (z, y, x) in (zs.0..zs.1)
                .flat_map(|z| (ys.0..ys.1).map(move |y| (z, y)))
                .flat_map(|(z, y)| (xs.0..xs.1).map(move |x| (z, y, x)))
            {
                let point = self.point([x, y, z]);
                let t = ((point - a).dot(b - a) / (b - a).length_squared().max(1e-18)).clamp(0.0, 1.0);
                let tube = point.distance(a.lerp(b, t)) - (ra + (rb - ra) * t) + band;
                let slot = (z * self.size[1] + y) * self.size[0] + x;
                let value = tube.max(sleeve.end.past(point)).clamp(-band, band) as f32;
                self.values[slot] = self.values[slot].min(value);
            }
        }
    }
}
