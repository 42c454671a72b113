//! Pictures of results for people: views side by side from a z-buffer with smooth shading, off-screen, no GPU.
//! Own rasteriser: the crate `euc` 0.5.3 was weighed, but it brings a second maths library, and its pipeline traits
//! ask for about as many lines as the triangle loop they save.

use crate::rig::{Character, Mesh, Pose};
use crate::{Error, Result};
use glam::{DMat3, DVec2, DVec3};
use image::RgbImage;
use std::path::Path;

/// Pixels of one view: width, and the greatest height; content that is wide rather than tall gets a lower picture.
const VIEW_SIZE: [usize; 2] = [400, 560];
/// Samples per pixel along each axis.
const SUPERSAMPLING: usize = 2;
/// Empty share of the view on either side of the content.
const MARGIN: f64 = 0.06;
/// Directions to the lights in view space (right, up, towards the viewer), and their strength.
const KEY: (DVec3, f64) = (DVec3::new(-0.45, 0.75, 0.6), 0.75);
const FILL: (DVec3, f64) = (DVec3::new(0.8, 0.1, 0.5), 0.22);
/// Light from the sky above and from the ground below.
const AMBIENT: (f64, f64) = (0.34, 0.16);
/// What is left of the light on the back of a cloth.
const BACK: f64 = 0.6;
/// Linear grey of the background at the top and the bottom of the picture, and of the shadow on the ground.
const BACKGROUND: (f64, f64) = (0.90, 0.72);
const SHADOW: f64 = 0.48;
/// Direction to the light that casts the shadow: steep, so that the shadow stays in the picture.
const SUN: DVec3 = DVec3::new(-0.12, 1.0, 0.1);
/// Cloth of [`render_dressed`], linear RGB.
const CLOTH: [f32; 3] = [0.06, 0.20, 0.42];
/// Body without colours of its own, linear RGB.
const BODY: [f32; 3] = [0.55, 0.45, 0.38];

/// Triangles to draw, in metres.
pub struct Layer<'a> {
    /// [v] positions.
    pub positions: &'a [DVec3],
    /// [v] unit normals.
    pub normals: &'a [DVec3],
    /// Vertex indices.
    pub triangles: &'a [[u32; 3]],
    /// Linear RGB per vertex; the last one serves all further vertices, so one colour paints all.
    pub colour: &'a [[f32; 3]],
    /// Draw the backs of triangles, darker: cloth is open, bodies are closed.
    pub two_sided: bool,
}

/// From where to look: an orthographic camera that circles the upright axis.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Radians about +Y from the front (the viewer stands on +Z) towards the content's left (+X).
    pub yaw: f64,
    /// Radians the viewer looks down.
    pub pitch: f64,
}

impl View {
    /// Front, side and back, slightly from above.
    pub const THREE: [View; 3] = {
        let pitch = 0.14;
        let right_angle = std::f64::consts::FRAC_PI_2;
        [View { yaw: 0.0, pitch }, View { yaw: right_angle, pitch }, View { yaw: 2.0 * right_angle, pitch }]
    };

    /// Rows: right, up, towards the viewer.
    fn axes(&self) -> DMat3 {
        (DMat3::from_rotation_y(self.yaw) * DMat3::from_rotation_x(-self.pitch)).transpose()
    }
}

/// The layers from each view, side by side at one scale, framed to their bounds.
pub fn contact_sheet(layers: &[Layer], views: &[View]) -> RgbImage {
    let [width, tallest] = VIEW_SIZE;
    let points = || layers.iter().flat_map(|layer| layer.positions).filter(|point| point.is_finite());
    let infinite = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let bounds = |axes: DMat3| points().map(|&p| axes * p).fold(infinite, |(low, high), p| (low.min(p), high.max(p)));
    let extent = |view: &View| {
        let (low, high) = bounds(view.axes());
        (high - low).truncate()
    };
    let extent = views.iter().map(extent).fold(DVec2::splat(1e-9), DVec2::max);
    let share = 1.0 - 2.0 * MARGIN;
    let pixels_per_metre = (DVec2::new(width as f64, tallest as f64) * share / extent).min_element();
    let height = ((extent.y * pixels_per_metre / share).ceil() as usize).clamp(width / 2, tallest);
    let ground = points().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let mut sheet = RgbImage::new((width * views.len()) as u32, height as u32);
    for (column, view) in views.iter().enumerate() {
        let axes = view.axes();
        let (low, high) = bounds(axes);
        let mut canvas =
            Canvas::new([width, height], axes, (low + high) / 2.0, pixels_per_metre * SUPERSAMPLING as f64);
        layers.iter().for_each(|layer| canvas.draw_shadow(layer, ground));
        layers.iter().for_each(|layer| canvas.draw(layer));
        canvas.resolve(&mut sheet, (column * width) as u32);
    }
    sheet
}

/// Writes front, side and back view of a posed character, and of cloth (positions in the same world, triangles) on it.
pub fn render_dressed(
    character: &Character,
    pose: &Pose,
    cloth: Option<(&[DVec3], &[[u32; 3]])>,
    path: &Path,
) -> Result<()> {
    let body = character.pose_body(pose);
    let normals = character.body.normals(&body);
    let surface = &character.surface;
    let plain = surface.triangles.is_empty();
    let vertex = if plain { (0..body.len() as u32).collect() } else { surface.vertex.clone() };
    let at_drawn = |of_body: &[DVec3]| vertex.iter().map(|&at| of_body[at as usize]).collect::<Vec<_>>();
    let (body, normals) = (at_drawn(&body), at_drawn(&normals));
    let triangles = if plain { &character.body.triangles } else { &surface.triangles };
    let colour = if surface.colour.is_empty() { &[BODY][..] } else { &surface.colour };
    let mut layers = vec![Layer { positions: &body, normals: &normals, triangles, colour, two_sided: false }];
    let cloth_normals = cloth.map_or(Vec::new(), |(positions, triangles)| {
        Mesh { positions: Vec::new(), triangles: triangles.to_vec() }.normals(positions)
    });
    if let Some((positions, triangles)) = cloth {
        layers.push(Layer { positions, normals: &cloth_normals, triangles, colour: &[CLOTH], two_sided: true });
    }
    let saved = contact_sheet(&layers, &View::THREE).save_with_format(path, image::ImageFormat::Png);
    saved.map_err(|error| Error::File { path: path.into(), reason: error.to_string() })
}

/// One view being drawn.
struct Canvas {
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
    /// `size`: pixels, width and height.
    fn new(size: [usize; 2], axes: DMat3, centre: DVec3, samples_per_metre: f64) -> Canvas {
        let size = size.map(|pixels| pixels * SUPERSAMPLING);
        let (top, bottom) = BACKGROUND;
        let grey = |at: usize| DVec3::splat(top + (bottom - top) * (at / size[0]) as f64 / size[1] as f64);
        let depth = vec![f64::NEG_INFINITY; size[0] * size[1]];
        Canvas { size, axes, centre, samples_per_metre, depth, colour: (0..size[0] * size[1]).map(grey).collect() }
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
            let painted = |corner: u32| layer.colour.get(corner as usize).or(layer.colour.last()).unwrap_or(&BODY);
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
                self.project(flat).truncate().extend(-1e6)
            });
            self.fill(corners, |_, _| Some(DVec3::splat(SHADOW)));
        }
    }

    /// Visits the samples of a triangle nearer than what is drawn there. `paint` gets the shares of the three corners and
    /// whether the front is seen.
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

    /// Averages the samples of each pixel and encodes sRGB, from column `left` of the sheet.
    fn resolve(&self, sheet: &mut RgbImage, left: u32) {
        let [width, height] = self.size.map(|samples| samples / SUPERSAMPLING);
        for (column, row) in (0..width).flat_map(|column| (0..height).map(move |row| (column, row))) {
            let samples = (0..SUPERSAMPLING * SUPERSAMPLING).map(|i| {
                let (x, y) = (column * SUPERSAMPLING + i % SUPERSAMPLING, row * SUPERSAMPLING + i / SUPERSAMPLING);
                self.colour[y * self.size[0] + x]
            });
            let mean = samples.sum::<DVec3>() / (SUPERSAMPLING * SUPERSAMPLING) as f64;
            sheet.put_pixel(left + column as u32, row as u32, image::Rgb(mean.to_array().map(encode)));
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners of a square at that z, counter-clockwise seen from +Z.
    fn square(z: f64) -> [DVec3; 4] {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, z))
    }

    fn middle(layers: &[Layer], yaw: f64) -> [u8; 3] {
        let sheet = contact_sheet(layers, &[View { yaw, pitch: 0.0 }]);
        sheet.get_pixel(sheet.width() / 2, sheet.height() / 2).0
    }

    #[test]
    fn nearer_hides_farther_and_backs_are_drawn_only_on_cloth() {
        let (near, far) = (square(0.5), square(-0.5));
        let layer = |positions, colour, two_sided| Layer {
            positions,
            normals: &[DVec3::Z; 4],
            triangles: &[[0, 1, 2], [0, 2, 3]],
            colour,
            two_sided,
        };
        let layers = [layer(&near, &[[1.0, 0.0, 0.0]], true), layer(&far, &[[0.0, 1.0, 0.0]], false)];
        let front = middle(&layers, 0.0);
        assert!(front[0] > 150 && front[1] == 0, "the near red square hides the green one: {front:?}");
        let back = middle(&layers, std::f64::consts::PI);
        assert!(back[0] > 80 && back[0] < front[0] && back[1] == 0, "from behind: the red back, darker: {back:?}");
        let nothing = middle(&layers[1..], std::f64::consts::PI);
        assert_eq!(nothing[0], nothing[1], "the back of a body is not drawn: {nothing:?}");
    }

    #[test]
    fn yaw_a_quarter_turn_shows_what_faces_plus_x() {
        let positions = vec![DVec3::new(0.0, -1.0, 1.0), DVec3::new(0.0, -1.0, -1.0), DVec3::new(0.0, 1.0, 0.0)];
        let layer = Layer {
            positions: &positions,
            normals: &[DVec3::X; 3],
            triangles: &[[0, 1, 2]],
            colour: &[[0.0, 0.0, 1.0]],
            two_sided: false,
        };
        let pixel = middle(&[layer], std::f64::consts::FRAC_PI_2);
        assert!(pixel[2] > 150 && pixel[0] == 0, "{pixel:?}");
    }

    #[test]
    fn nothing_to_draw_is_a_background() {
        let pixel = middle(&[], 0.0);
        assert!(pixel[0] > 200, "{pixel:?}");
    }
}
