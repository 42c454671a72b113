//! One view being drawn: an orthographic z-buffer, smooth shading, several samples a pixel.
//! Own rasteriser: the crate `euc` 0.5.3 was weighed, but it brings a second maths library, and its pipeline traits
//! ask for about as many lines as the triangle loop they save.

use super::Layer;
use glam::{DMat3, DVec2, DVec3};
use image::RgbImage;

/// Samples per pixel along each axis.
const SUPERSAMPLING: usize = 2;
/// Depth of the shadow on the ground: behind everything.
const GROUND: f64 = -1e6;
/// Size of the folds that are brought out, metres; directions in which they are looked for; strength.
const CARVING: f64 = 0.03;
const DIRECTIONS: usize = 8;
const CARVED: f64 = 3.0;
/// Directions to the lights in view space (right, up, towards the viewer), and their strength.
const KEY: (DVec3, f64) = (DVec3::new(-0.45, 0.75, 0.6), 0.75);
const FILL: (DVec3, f64) = (DVec3::new(0.8, 0.1, 0.5), 0.22);
/// Light from the sky above and from the ground below.
const AMBIENT: (f64, f64) = (0.34, 0.16);
/// Brightness of the back of a cloth, as a share of that of its front.
const BACK: f64 = 0.6;
/// Linear grey of the background at the top and the bottom of the picture, and of the shadow on the ground.
const BACKGROUND: (f64, f64) = (0.90, 0.72);
const SHADOW: f64 = 0.48;
/// Direction to the light that casts the shadow: steep, so that the shadow stays in the picture.
const SUN: DVec3 = DVec3::new(-0.12, 1.0, 0.1);

/// One view being drawn.
pub(super) struct Canvas {
    /// Samples, width and height.
    size: [usize; 2],
    axes: DMat3,
    centre: DVec3,
    samples_per_metre: f64,
    /// Distance towards the viewer, metres.
    depth: Vec<f64>,
    /// Linear RGB.
    colour: Vec<DVec3>,
}

impl Canvas {
    /// `size`: pixels, width and height. `centre`: the middle of the picture, in view space.
    pub fn new(size: [usize; 2], axes: DMat3, centre: DVec3, pixels_per_metre: f64) -> Canvas {
        let size = size.map(|pixels| pixels * SUPERSAMPLING);
        let samples_per_metre = pixels_per_metre * SUPERSAMPLING as f64;
        let (top, bottom) = BACKGROUND;
        let grey = |at: usize| DVec3::splat(top + (bottom - top) * (at / size[0]) as f64 / size[1] as f64);
        let depth = vec![f64::NEG_INFINITY; size[0] * size[1]];
        Canvas { size, axes, centre, samples_per_metre, depth, colour: (0..size[0] * size[1]).map(grey).collect() }
    }

    /// Draws all layers, and their shadow on the ground at height `ground`, metres.
    pub fn paint(mut self, layers: &[Layer], ground: f64) -> Canvas {
        layers.iter().for_each(|layer| self.draw_shadow(layer, ground));
        layers.iter().for_each(|layer| self.draw(layer));
        self.carve();
        self
    }

    /// Darkens hollows and lightens ridges: nothing else shows folds that face the light. A hollow is a sample that
    /// lies behind the mean of two others on opposite sides of it. Pairs across a step in depth, as at an outline, are
    /// left out.
    fn carve(&mut self) {
        let [width, height] = self.size.map(|samples| samples as isize);
        let radius = CARVING * self.samples_per_metre;
        let offsets: Vec<(isize, isize)> = (0..2 * DIRECTIONS)
            .map(|i| {
                let (sine, cosine) = (i as f64 * std::f64::consts::PI / DIRECTIONS as f64).sin_cos();
                let reach = if i < DIRECTIONS { radius } else { 0.5 * radius };
                ((reach * cosine).round() as isize, (reach * sine).round() as isize)
            })
            .collect();
        let depth = |x: isize, y: isize| {
            let inside = (0..width).contains(&x) && (0..height).contains(&y);
            inside.then(|| self.depth[(y * width + x) as usize])
        };
        let hollow = |at: usize| {
            let (x, y, own) = (at as isize % width, at as isize / width, self.depth[at]);
            let rise = |&(dx, dy): &(isize, isize)| {
                let pair = [depth(x + dx, y + dy)? - own, depth(x - dx, y - dy)? - own];
                pair.iter().all(|rise| rise.abs() < 2.0 * CARVING).then_some((pair[0] + pair[1]) / (2.0 * CARVING))
            };
            let (count, sum) =
                offsets.iter().filter_map(rise).fold((0, 0.0), |(count, sum), rise| (count + 1, sum + rise));
            sum / f64::from(count.max(DIRECTIONS as u32))
        };
        let drawn = (0..self.depth.len()).map(|at| if self.depth[at] > GROUND { hollow(at) } else { 0.0 });
        let light: Vec<f64> = drawn.map(|hollow| (1.0 - CARVED * hollow).clamp(0.45, 1.3)).collect();
        self.colour.iter_mut().zip(light).for_each(|(colour, light)| *colour *= light);
    }

    /// World to samples (x right, y down) and metres towards the viewer.
    fn project(&self, point: DVec3) -> DVec3 {
        let seen = self.axes * point - self.centre;
        let middle = DVec2::new(self.size[0] as f64, self.size[1] as f64) / 2.0;
        let at = middle + DVec2::new(seen.x, -seen.y) * self.samples_per_metre;
        at.extend(seen.z)
    }

    fn draw(&mut self, layer: &Layer) {
        for triangle in layer.triangles {
            let corners = triangle.map(|corner| self.project(layer.positions[corner as usize]));
            let normals = triangle.map(|corner| self.axes * layer.normals[corner as usize]);
            let painted = |corner: u32| layer.colour.get(corner as usize).or(layer.colour.last()).unwrap_or(&[0.5; 3]);
            let colours = triangle.map(|corner| DVec3::from(painted(corner).map(f64::from)));
            let two_sided = layer.two_sided;
            self.fill(corners, |share, front| {
                let normal = normals[0] * share.x + normals[1] * share.y + normals[2] * share.z;
                let light = match (front, two_sided) {
                    (true, _) => shade(normal),
                    (false, true) => shade(-normal) * BACK,
                    (false, false) => return None,
                };
                Some((colours[0] * share.x + colours[1] * share.y + colours[2] * share.z) * light)
            });
        }
    }

    /// The layer flattened onto the ground: dark, behind everything.
    fn draw_shadow(&mut self, layer: &Layer, ground: f64) {
        let light = self.axes.transpose() * DVec3::new(SUN.x, 0.0, SUN.z) + DVec3::Y * SUN.y;
        for triangle in layer.triangles {
            let corners = triangle.map(|corner| {
                let point = layer.positions[corner as usize];
                let flat = point - light * ((point.y - ground) / light.y);
                self.project(flat).truncate().extend(GROUND)
            });
            self.fill(corners, |_, _| Some(DVec3::splat(SHADOW)));
        }
    }

    /// Paints the samples at which the triangle is nearer than all that was drawn before. `paint` gets the barycentric
    /// coordinates and whether the front is seen.
    fn fill(&mut self, [a, b, c]: [DVec3; 3], paint: impl Fn(DVec3, bool) -> Option<DVec3>) {
        let cross = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
        let [p, q, r] = [a, b, c].map(DVec3::truncate);
        let area = cross(p, q, r);
        if !area.is_normal() || !(a + b + c).is_finite() {
            return;
        }
        let limit = DVec2::new(self.size[0] as f64, self.size[1] as f64);
        let low = p.min(q).min(r).clamp(DVec2::ZERO, limit).floor();
        let high = p.max(q).max(r).clamp(DVec2::ZERO, limit).ceil();
        for row in low.y as usize..high.y as usize {
            for column in low.x as usize..high.x as usize {
                let sample = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
                let share = DVec3::new(cross(q, r, sample), cross(r, p, sample), cross(p, q, sample)) / area;
                let depth = share.dot(DVec3::new(a.z, b.z, c.z));
                let at = row * self.size[0] + column;
                if share.min_element() < 0.0 || depth <= self.depth[at] {
                    continue;
                }
                // Rows run downwards, so a counter-clockwise triangle has a negative area here.
                if let Some(colour) = paint(share, area < 0.0) {
                    self.depth[at] = depth;
                    self.colour[at] = colour;
                }
            }
        }
    }

    /// Averages the samples of each pixel and encodes sRGB, at pixel `corner` (x, y) of the sheet.
    pub fn resolve(&self, sheet: &mut RgbImage, corner: [usize; 2]) {
        let [width, height] = self.size.map(|samples| samples / SUPERSAMPLING);
        for (column, row) in (0..width).flat_map(|column| (0..height).map(move |row| (column, row))) {
            let samples = (0..SUPERSAMPLING * SUPERSAMPLING).map(|i| {
                let (x, y) = (column * SUPERSAMPLING + i % SUPERSAMPLING, row * SUPERSAMPLING + i / SUPERSAMPLING);
                self.colour[y * self.size[0] + x]
            });
            let mean = samples.sum::<DVec3>() / (SUPERSAMPLING * SUPERSAMPLING) as f64;
            sheet.put_pixel(
                (corner[0] + column) as u32,
                (corner[1] + row) as u32,
                image::Rgb(mean.to_array().map(encode)),
            );
        }
    }
}

/// Light on a surface of that normal (view space, any length).
fn shade(normal: DVec3) -> f64 {
    let normal = normal.normalize_or(DVec3::Z);
    let lamp = |(direction, strength): (DVec3, f64)| normal.dot(direction.normalize()).max(0.0) * strength;
    let (sky, earth) = AMBIENT;
    earth + (sky - earth) * (0.5 + 0.5 * normal.y) + lamp(KEY) + lamp(FILL)
}

/// Linear light to an sRGB byte. IEC 61966-2-1.
fn encode(linear: f64) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let coded = if linear <= 0.0031308 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (coded * 255.0).round() as u8
}
