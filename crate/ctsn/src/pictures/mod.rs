//! Pictures of results for people: views of a dressed character side by side, drawn off-screen without a GPU.

mod canvas;
mod comparison;
mod figure;
mod sheet;
mod text;

use canvas::Canvas;
pub use comparison::comparison;
use ctsn_rig::file::write;
use ctsn_rig::mesh::bounds;
use ctsn_rig::{Character, Error, Mesh, Pose, Result};
use figure::Figure;
use glam::{DMat3, DVec2, DVec3};
use image::RgbImage;
pub use sheet::{Poses, sheet};
use std::path::Path;

/// Width and greatest height of one view, pixels. Content that is wide rather than tall gets a lower picture.
const VIEW_SIZE: [usize; 2] = [400, 560];
/// Empty share of the view on either side of the content.
const MARGIN: f64 = 0.06;
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

/// A direction to look from: an orthographic camera that circles the upright axis.
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

/// The layers from each view, side by side, at the largest scale that fits all.
pub fn contact_sheet(layers: &[Layer], views: &[View]) -> RgbImage {
    let [width, tallest] = VIEW_SIZE;
    let points = || layers.iter().flat_map(|layer| layer.positions).filter(|point| point.is_finite());
    let bounds = |axes: DMat3| bounds(points().map(|&p| axes * p));
    let extent = |view: &View| {
        let [low, high] = bounds(view.axes());
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
        let [low, high] = bounds(axes);
        let canvas = Canvas::new([width, height], axes, (low + high) / 2.0, pixels_per_metre);
        canvas.paint(layers, ground).resolve(&mut sheet, [column * width, 0]);
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
    let figure = Figure::new(character, pose, cloth);
    write(path, &png(&contact_sheet(&figure.layers(), &View::THREE))?)
}

/// Front, side and back view of a character in its canonical pose, with cloth in these colours, linear RGB per vertex.
pub fn painted(character: &Character, cloth: &Mesh, colour: &[[f32; 3]]) -> RgbImage {
    let figure = Figure::new(character, &character.canonical_pose(), Some((&cloth.positions, &cloth.triangles)));
    contact_sheet(&figure.painted(colour).layers(), &View::THREE)
}

/// The bytes of a picture as PNG.
pub fn png(picture: &RgbImage) -> Result<Vec<u8>> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let written = picture.write_to(&mut bytes, image::ImageFormat::Png);
    written.map_err(|error| Error::Dataset(format!("a picture could not be encoded: {error}")))?;
    Ok(bytes.into_inner())
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
