//! The same figure in several cloths, each seen by the same camera.

use super::View;
use super::canvas::Canvas;
use super::figure::Figure;
use ctsn_rig::mesh::bounds;
use ctsn_rig::{Character, Pose};
use glam::{DVec2, DVec3};
use image::RgbImage;

/// Pixels of one view.
const VIEW: [usize; 2] = [240, 320];
/// Share of the view on either side of the cloth: enough of the body to understand the pose.
const MARGIN: f64 = 0.1;

/// One picture per view and cloth [views][cloths]; each view holds all the cloths. A cloth is its positions in the
/// space of `pose`, and linear RGB per vertex (empty: the usual colour).
pub fn comparison(
    character: &Character,
    pose: &Pose,
    triangles: &[[u32; 3]],
    cloths: &[(&[DVec3], &[[f32; 3]])],
    views: &[View],
) -> Vec<Vec<RgbImage>> {
    let figures: Vec<Figure> = cloths
        .iter()
        .map(|(positions, colour)| Figure::new(character, pose, Some((positions, triangles))).painted(colour))
        .collect();
    let ground = character.pose_body(pose).iter().map(|point| point.y).fold(f64::INFINITY, f64::min);
    let size = DVec2::new(VIEW[0] as f64, VIEW[1] as f64);
    let draw = |view: &View| {
        let axes = view.axes();
        let [low, high] = bounds(cloths.iter().flat_map(|cloth| cloth.0).map(|point| axes * *point));
        let extent = (high - low).truncate().max(DVec2::splat(1e-3));
        let pixels_per_metre = (size * (1.0 - 2.0 * MARGIN) / extent).min_element();
        let paint = |figure: &Figure| {
            let mut picture = RgbImage::new(VIEW[0] as u32, VIEW[1] as u32);
            let canvas = Canvas::new(VIEW, axes, (low + high) / 2.0, pixels_per_metre);
            canvas.paint(&figure.layers(), ground).resolve(&mut picture, [0, 0]);
            picture
        };
        figures.iter().map(paint).collect()
    };
    views.iter().map(draw).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ctsn_rig::vertices;
    use ctsn_train::synthetic;

    #[test]
    fn cloths_share_the_camera_and_keep_their_colours() {
        let (setup, _) = synthetic::dataset(200, 3, 0);
        let character = setup.character().expect("a character");
        let pose = character.canonical_pose();
        let cloth = vertices(&setup.template);
        let moved: Vec<DVec3> = cloth.iter().map(|point| *point + DVec3::X * 0.6).collect();
        let red = [[1.0, 0.0, 0.0]];
        let cloths: [(&[DVec3], &[[f32; 3]]); 2] = [(&cloth, &[]), (&moved, &red)];
        let front = View { yaw: 0.0, pitch: 0.0 };
        let pictures =
            comparison(&character, &pose, setup.triangles.as_chunks::<3>().0, &cloths, &[front, View::THREE[2]]);
        assert_eq!((pictures.len(), pictures[0].len()), (2, 2));
        // Mean column of the pixels that `is` accepts.
        let middle = |picture: &RgbImage, is: fn(&image::Rgb<u8>) -> bool| {
            let columns = picture.enumerate_pixels().filter(|(_, _, pixel)| is(pixel)).map(|(x, _, _)| f64::from(x));
            let columns: Vec<f64> = columns.collect();
            columns.iter().sum::<f64>() / columns.len() as f64
        };
        let reddish = |pixel: &image::Rgb<u8>| pixel.0[0] > 100 && pixel.0[1] < 20 && pixel.0[2] < 20;
        let blueish = |pixel: &image::Rgb<u8>| pixel.0[2] > 60 && pixel.0[2] > pixel.0[0].saturating_mul(2);
        let found = (middle(&pictures[0][0], blueish), middle(&pictures[0][1], reddish));
        // The tube is 1.5 m tall, which is 0.8 of 320 pixels; so 0.6 m are 102 pixels.
        assert!((found.1 - found.0 - 102.4).abs() < 8.0, "{found:?}");
        let behind = (middle(&pictures[1][0], blueish), middle(&pictures[1][1], reddish));
        assert!(behind.1 < behind.0, "from behind left and right change: {behind:?}");
    }
}
