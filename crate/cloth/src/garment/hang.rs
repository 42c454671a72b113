//! Cloth that falls free of the body: layer by layer along the fall, the solid never narrows by more than a slope, or
//! widens. Beyond the field's narrow band a layer's distances are solved again, or flares would grow by the band's
//! width at once.

use crate::wrap::{Field, Plane};
use glam::{DVec2, DVec3};

/// Distance where a layer holds nothing, metres.
const FAR: f32 = 1e3;

/// Past its start, along the fall, the shell never narrows.
#[derive(Clone, Debug)]
pub(super) struct Hang {
    /// Where cloth starts to fall, metres.
    pub start: DVec3,
    /// Unit direction.
    pub fall: DVec3,
    /// How far, metres.
    pub length: f64,
    /// Metres it widens on every side per metre.
    pub flare: f64,
    /// Only on the near side of this plane.
    pub within: Option<Plane>,
}

impl Hang {
    /// From the far end back to the start.
    pub fn reversed(&self) -> Hang {
        Hang { start: self.start + self.fall * self.length, fall: -self.fall, ..self.clone() }
    }
}

impl Field {
    /// Past the start, the solid narrows by at most `slope` metres per metre (negative: it widens by at least as much).
    /// `band`: values at or above are no distances, metres.
    pub(super) fn hang(&mut self, hang: &Hang, slope: f64, band: f64) {
        let Hang { start, fall, length, within, .. } = hang;
        let axis = fall.abs().max_position();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let (width, height, count) = (self.size[u], self.size[v], self.size[axis]);
        // From one layer to the next: cells sideways, metres of change.
        let shift = DVec2::new(fall[u], fall[v]) / fall[axis].abs();
        let change = (slope * self.cell / fall[axis].abs()) as f32;
        let mut before = vec![FAR; width * height];
        for layer in 0..count {
            let layer = if fall[axis] > 0.0 { layer } else { count - 1 - layer };
            let mut own = vec![0.0; width * height];
            for (i, own) in own.iter_mut().enumerate() {
                let mut index = [0; 3];
                (index[axis], index[u], index[v]) = (layer, i % width, i / width);
                let slot = (index[2] * self.size[1] + index[1]) * self.size[0] + index[0];
                let point = self.point(index);
                let past = (point - start).dot(*fall);
                if past > 0.0 && past < *length && within.is_none_or(|plane| plane.past(point) <= 0.0) {
                    let from = DVec2::new(index[u] as f64, index[v] as f64) - shift;
                    self.values[slot] = self.values[slot].min(interpolate(&before, width, from) + change);
                }
                *own = self.values[slot];
            }
            spread(&mut own, width, self.cell as f32, 0.999 * band as f32);
            before = own;
        }
    }
}

/// Bilinear value of a layer at a place in cells; its rim continues outside.
fn interpolate(layer: &[f32], width: usize, place: DVec2) -> f32 {
    let most = DVec2::new(width as f64, (layer.len() / width) as f64) - 1.0;
    let place = place.clamp(DVec2::ZERO, most);
    let (low, part) = (place.floor(), place.fract());
    let high = (low + 1.0).min(most);
    let at = |x: f64, y: f64| f64::from(layer[y as usize * width + x as usize]);
    let row = |y: f64| at(low.x, y) * (1.0 - part.x) + at(high.x, y) * part.x;
    (row(low.y) * (1.0 - part.y) + row(high.y) * part.y) as f32
}

/// Replaces what is not below `band` by the distance within the layer: |∇d| = 1 by fast sweeping (Zhao 2005).
fn spread(layer: &mut [f32], width: usize, cell: f32, band: f32) {
    let height = layer.len() / width;
    let open: Vec<bool> = layer.iter().map(|value| *value >= band).collect();
    layer.iter_mut().filter(|value| **value >= band).for_each(|value| *value = FAR);
    for sweep in 0..4 {
        for i in 0..layer.len() {
            let (x, y) = (i % width, i / width);
            let x = if sweep & 1 == 0 { x } else { width - 1 - x };
            let y = if sweep & 2 == 0 { y } else { height - 1 - y };
            let i = y * width + x;
            if !open[i] {
                continue;
            }
            let a = layer[if x > 0 { i - 1 } else { i }].min(layer[if x + 1 < width { i + 1 } else { i }]);
            let b = layer[if y > 0 { i - width } else { i }].min(layer[if y + 1 < height { i + width } else { i }]);
            let apart = a - b;
            let reached = match apart.abs() < cell {
                true => (a + b + (2.0 * cell * cell - apart * apart).sqrt()) / 2.0,
                false => a.min(b) + cell,
            };
            layer[i] = layer[i].min(reached);
        }
    }
}
