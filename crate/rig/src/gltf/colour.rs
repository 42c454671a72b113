//! One colour per vertex: the material's base colour, times its texture around the vertex. glTF 2.0 §3.9.2.

use super::Read;
use super::file::File;
use ::gltf::image::Source;
use ::gltf::material::PbrMetallicRoughness;
use ::gltf::texture::TextureTransform;
use glam::DVec2;
use image::RgbImage;

/// Paints vertices; each texture is decoded once.
pub(super) struct Painter<'a> {
    file: &'a File,
    /// Per image of the file: outer `None` before it is asked for, inner `None` where it cannot be decoded.
    images: Vec<Option<Option<RgbImage>>>,
}

impl<'a> Painter<'a> {
    pub fn new(file: &'a File) -> Self {
        Painter { file, images: vec![None; file.document.images().len()] }
    }

    /// Linear RGB per vertex: the mean over the corners of its triangles. Each is read a quarter of the way into the
    /// triangle, since low-poly palettes change colour right at the corner. A texture in a format not built in counts
    /// as white: colour is only looked at, and not worth an error.
    pub fn paint(
        &mut self,
        material: &PbrMetallicRoughness,
        uv: &[DVec2],
        triangles: &[[u32; 3]],
        vertices: usize,
    ) -> Vec<[f32; 3]> {
        let [red, green, blue, _] = material.base_color_factor();
        let plain = [red, green, blue].map(|channel| if channel.is_finite() { channel.clamp(0.0, 1.0) } else { 1.0 });
        let texture = material.base_color_texture().filter(|_| !uv.is_empty());
        let place = texture.as_ref().and_then(|texture| texture.texture_transform());
        let place = |uv: DVec2| place.as_ref().map_or(uv, |place| placed(place, uv));
        let picture = texture.and_then(|texture| self.image(texture.texture().source()));
        let Some(picture) = picture else { return vec![plain; vertices] };
        let mut sums = vec![([0.0; 3], 0.0); vertices];
        for triangle in triangles {
            let centre = triangle.iter().map(|&corner| uv[corner as usize]).sum::<DVec2>() / 3.0;
            for &corner in triangle {
                let (sum, count) = &mut sums[corner as usize];
                let texel = texel(picture, place(uv[corner as usize].lerp(centre, 0.25)));
                (0..3).for_each(|channel| sum[channel] += plain[channel] * texel[channel]);
                *count += 1.0;
            }
        }
        sums.iter().map(|(sum, count)| sum.map(|channel: f32| channel / f32::max(*count, 1.0))).collect()
    }

    fn image(&mut self, image: ::gltf::Image) -> Option<&RgbImage> {
        let file = self.file;
        self.images.get_mut(image.index())?.get_or_insert_with(|| decode(file, &image).ok()).as_ref()
    }
}

fn decode(file: &File, image: &::gltf::Image) -> Read<RgbImage> {
    let picture = match image.source() {
        Source::View { view, .. } => image::load_from_memory(file.view(&view)?),
        Source::Uri { uri, .. } => image::load_from_memory(&file.uri(uri)?),
    };
    let picture = picture.map_err(|error| error.to_string())?.to_rgb8();
    if picture.is_empty() { Err("an image without pixels".to_string()) } else { Ok(picture) }
}

/// Texture coordinates moved, turned and scaled. KHR_texture_transform.
fn placed(place: &TextureTransform, uv: DVec2) -> DVec2 {
    let [offset, scale] = [place.offset(), place.scale()].map(|pair| DVec2::from(pair.map(f64::from)));
    let turned = DVec2::from_angle(-f64::from(place.rotation())).rotate(uv * scale);
    turned + offset
}

/// Nearest texel of the repeated texture, linear RGB.
fn texel(picture: &RgbImage, uv: DVec2) -> [f32; 3] {
    let at = |coordinate: f64, size: u32| ((coordinate.rem_euclid(1.0) * f64::from(size)) as u32).min(size - 1);
    let pixel = picture.get_pixel(at(uv.x, picture.width()), at(uv.y, picture.height()));
    pixel.0.map(|channel| linear(f32::from(channel) / 255.0))
}

/// sRGB to linear light. IEC 61966-2-1.
fn linear(channel: f32) -> f32 {
    if channel <= 0.04045 { channel / 12.92 } else { ((channel + 0.055) / 1.055).powf(2.4) }
}
