//! Voxel field whose zero set is the shell: f = distance to the covered body - looseness, hollows bridged, smoothed,
//! never closer than [`CLOSEST`] of the looseness. simulation.md §4.2.

use super::solid::{Near, Solid};
use ctsn_rig::mesh::bounds;
use glam::DVec3;
use rayon::prelude::*;

/// Share of the looseness that smoothing may not take away where the body is convex.
const CLOSEST: f64 = 0.9;

/// Rounds of smoothing that may only grow the solid: cloth bridges hollows, it does not follow them.
const FILLS: usize = 4;

/// Scalar field on a regular grid, trilinear in between; x runs fastest.
pub(crate) struct Field {
    /// Position of voxel (0, 0, 0), metres.
    pub origin: DVec3,
    /// Voxel edge, metres.
    pub cell: f64,
    /// Voxels along x, y, z.
    pub size: [usize; 3],
    /// Values, metres; negative inside.
    pub values: Vec<f32>,
}

impl Field {
    /// The closed shell around what `solid` covers, on voxels of `cell` metres.
    pub fn new(solid: &Solid, cell: f64) -> Field {
        let mut field = Field::around(solid, cell, &[]);
        field.values = field.offset(solid, solid.covered);
        field.crop(field.bounds(solid));
        field.bridge(solid);
        field
    }

    /// An empty grid around the body and balls (centre, radius; metres), voxels of `cell` metres.
    pub fn around(solid: &Solid, cell: f64, balls: &[(DVec3, f64)]) -> Field {
        let margin = solid.looseness + 6.0 * cell + 3.0 * solid.smoothing + solid.room;
        let corners = solid.triangles.iter().flatten().flat_map(|p| [*p - margin, *p + margin]);
        let balls = balls.iter().flat_map(|(p, radius)| [*p - *radius - margin, *p + *radius + margin]);
        let [low, high] = bounds(corners.chain(balls));
        let size = ((high - low) / cell).to_array().map(|n| n.ceil() as usize + 1);
        Field { origin: low, cell, size, values: Vec::new() }
    }

    /// Bridges hollows and smooths, never closer than [`CLOSEST`] of the looseness.
    pub fn bridge(&mut self, solid: &Solid) {
        let closest: Vec<f32> = self.values.iter().map(|v| v + ((1.0 - CLOSEST) * solid.looseness) as f32).collect();
        for round in 0..=FILLS {
            let before = if round < FILLS { self.values.clone() } else { closest.clone() };
            self.smooth(solid.smoothing);
            self.values.iter_mut().zip(before).for_each(|(value, before)| *value = value.min(before));
        }
    }

    /// Distance to the `covered` triangles of the body less the looseness, within the band, metres.
    pub fn offset(&self, solid: &Solid, covered: &[bool]) -> Vec<f32> {
        let wall = solid.looseness.max(0.6 * self.cell);
        let mut near = self.distances(solid.triangles, covered, solid.looseness + 4.0 * self.cell, wall);
        let inside = self.interior(&mut near, wall);
        let clamp = solid.band(self.cell) as f32;
        let value = |(near, inside): (&Near, &bool)| {
            if *inside { -clamp } else { (near.covered - solid.looseness as f32).clamp(-clamp, clamp) }
        };
        near.iter().zip(&inside).map(value).collect()
    }

    /// Position of a voxel.
    pub fn point(&self, [x, y, z]: [usize; 3]) -> DVec3 {
        self.origin + DVec3::new(x as f64, y as f64, z as f64) * self.cell
    }

    /// Voxel index ranges (first, past the last) around a box, per axis.
    pub fn range(&self, low: DVec3, high: DVec3) -> [(usize, usize); 3] {
        let low = ((low - self.origin) / self.cell).to_array();
        let high = ((high - self.origin) / self.cell).to_array();
        [0, 1, 2].map(|k| {
            let first = low[k].ceil().max(0.0) as usize;
            (first, ((high[k].floor() + 1.0).max(0.0) as usize).min(self.size[k]))
        })
    }

    /// First and last voxel, per axis, of what is inside and as much around it as smoothing and what hangs need.
    pub fn bounds(&self, solid: &Solid) -> [[usize; 3]; 2] {
        let margin = 2 + ((3.0 * solid.smoothing + solid.room) / self.cell) as usize;
        let (mut low, mut high) = (self.size, [0; 3]);
        for i in (0..self.values.len()).filter(|&i| self.values[i] < 0.0) {
            let place = self.place(i);
            (low, high) = ([0, 1, 2].map(|k| low[k].min(place[k])), [0, 1, 2].map(|k| high[k].max(place[k])));
        }
        let low = [0, 1, 2].map(|k| low[k].min(high[k]).saturating_sub(margin));
        [low, [0, 1, 2].map(|k| (high[k] + margin).min(self.size[k] - 1))]
    }

    /// The values within bounds.
    pub fn cropped(&self, values: &[f32], [low, high]: [[usize; 3]; 2]) -> Vec<f32> {
        let [nx, ny, _] = self.size;
        let row = |z: usize, y: usize| &values[(z * ny + y) * nx..][low[0]..=high[0]];
        let rows = (low[2]..=high[2]).flat_map(|z| (low[1]..=high[1]).map(move |y| (z, y)));
        rows.flat_map(|(z, y)| row(z, y)).copied().collect()
    }

    /// Keeps the voxels within bounds.
    pub fn crop(&mut self, bounds: [[usize; 3]; 2]) {
        self.values = self.cropped(&self.values, bounds);
        (self.origin, self.size) = (self.point(bounds[0]), [0, 1, 2].map(|k| bounds[1][k] - bounds[0][k] + 1));
    }

    /// Where voxel `i` is on the grid. (In 32 bits, a robe and a cape took as long to make: 22 and 23 s.)
    pub fn place(&self, i: usize) -> [usize; 3] {
        let [nx, ny, _] = self.size;
        [i % nx, i / nx % ny, i / (nx * ny)]
    }

    /// The up to six voxels next to voxel `i`.
    pub fn neighbours(&self, i: usize) -> impl Iterator<Item = usize> {
        let ([nx, ny, nz], [x, y, z]) = (self.size, self.place(i));
        let steps = [
            (x > 0).then(|| i - 1),
            (x + 1 < nx).then(|| i + 1),
            (y > 0).then(|| i - nx),
            (y + 1 < ny).then(|| i + nx),
            (z > 0).then(|| i - nx * ny),
            (z + 1 < nz).then(|| i + nx * ny),
        ];
        steps.into_iter().flatten()
    }

    /// Gaussian of standard deviation `sigma` metres, as three box filters per axis.
    pub(super) fn smooth(&mut self, sigma: f64) {
        // Three boxes of half-width r voxels have variance r(r+1).
        let variance = (sigma / self.cell).powi(2);
        let half = (((1.0 + 4.0 * variance).sqrt() - 1.0) / 2.0).round() as usize;
        let [nx, ny, nz] = self.size;
        for (count, stride) in [(nx, 1), (ny, nx), (nz, nx * ny)] {
            let blocks = (0..self.values.len()).step_by(count * stride);
            let starts: Vec<usize> = blocks.flat_map(|block| block..block + stride).collect();
            let values = &self.values;
            let lines: Vec<Vec<f32>> = starts
                .par_iter()
                .map(|start| {
                    let line: Vec<f32> = (0..count).map(|k| values[start + k * stride]).collect();
                    (0..3).fold(line, |line, _| box_filter(&line, half))
                })
                .collect();
            for (start, line) in starts.iter().zip(lines) {
                line.iter().enumerate().for_each(|(k, value)| self.values[start + k * stride] = *value);
            }
        }
    }

    /// Value at a point, metres; the grid's rim continues outside.
    pub fn value(&self, point: DVec3) -> f64 {
        let [nx, ny, _] = self.size;
        let local = ((point - self.origin) / self.cell).to_array();
        let mut base = [0; 3];
        let mut part = [0.0; 3];
        for k in 0..3 {
            let clamped = local[k].clamp(0.0, (self.size[k] - 1) as f64 - 1e-9);
            base[k] = clamped as usize;
            part[k] = clamped - base[k] as f64;
        }
        let mut sum = 0.0;
        for corner in 0..8 {
            let [dx, dy, dz] = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight = |k: usize, d: usize| if d == 1 { part[k] } else { 1.0 - part[k] };
            let index = ((base[2] + dz) * ny + base[1] + dy) * nx + base[0] + dx;
            sum += weight(0, dx) * weight(1, dy) * weight(2, dz) * self.values[index] as f64;
        }
        sum
    }

    /// Gradient by central differences over one voxel.
    pub fn gradient(&self, point: DVec3) -> DVec3 {
        let slope = |axis: DVec3| {
            let step = axis * (0.5 * self.cell);
            (self.value(point + step) - self.value(point - step)) / self.cell
        };
        DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z))
    }

    /// The point moved onto the zero set by Newton steps along the gradient, at most one voxel each.
    pub fn project(&self, mut point: DVec3) -> DVec3 {
        for _ in 0..4 {
            let gradient = self.gradient(point);
            let step = gradient * (self.value(point) / gradient.length_squared().max(0.01));
            point -= step.clamp_length_max(self.cell);
        }
        point
    }
}

/// Mean over 2·half+1 samples; the ends repeat.
fn box_filter(line: &[f32], half: usize) -> Vec<f32> {
    let last = line.len() - 1;
    let at = |k: isize| line[k.clamp(0, last as isize) as usize] as f64;
    let half = half as isize;
    let mut sum: f64 = (-half..=half).map(at).sum();
    let mut out = Vec::with_capacity(line.len());
    for k in 0..line.len() as isize {
        out.push((sum / (2 * half + 1) as f64) as f32);
        sum += at(k + half + 1) - at(k - half);
    }
    out
}
