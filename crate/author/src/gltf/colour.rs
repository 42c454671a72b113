//! One colour per triangle: the material's base colour, times its texture at the triangle's centre. glTF 2.0 §3.9.2.

use super::Read;
use super::file::File;
use ::gltf::image::Source;
use ::gltf::material::PbrMetallicRoughness;
use glam::DVec2;
use image::RgbImage;

/// Paints triangles; each texture is decoded once.
pub(super) struct Painter<'a> {
    file: &'a File,
    /// Per image of the file, once asked for; the inner `None` is an image that cannot be decoded.
    images: Vec<Option<Option<RgbImage>>>,
}

impl<'a> Painter<'a> {
    pub fn new(file: &'a File) -> Self {
        Painter { file, images: vec![None; file.document.images().len()] }
    }

    /// Linear RGB per triangle. Textures in formats not built in count as white: colour here is for looking, not an error.
    pub fn paint(&mut self, material: &PbrMetallicRoughness, uv: &[DVec2], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
        let [red, green, blue, _] = material.base_color_factor();
        let plain = [red, green, blue].map(|channel| if channel.is_finite() { channel.clamp(0.0, 1.0) } else { 1.0 });
        let texture = material.base_color_texture().filter(|_| !uv.is_empty());
        let picture = texture.and_then(|texture| self.image(texture.texture().source()));
        let Some(picture) = picture else { return vec![plain; triangles.len()] };
        let at_centre = |triangle: &[u32; 3]| {
            let centre = triangle.iter().map(|&corner| uv[corner as usize]).sum::<DVec2>() / 3.0;
            let texel = texel(picture, centre);
            std::array::from_fn(|channel| plain[channel] * texel[channel])
        };
        triangles.iter().map(at_centre).collect()
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

/// Nearest texel, the texture repeated, sRGB made linear.
fn texel(picture: &RgbImage, uv: DVec2) -> [f32; 3] {
    let at = |coordinate: f64, size: u32| ((coordinate.rem_euclid(1.0) * f64::from(size)) as u32).min(size - 1);
    let pixel = picture.get_pixel(at(uv.x, picture.width()), at(uv.y, picture.height()));
    pixel.0.map(|channel| linear(f32::from(channel) / 255.0))
}

/// sRGB transfer function, to linear light. IEC 61966-2-1.
fn linear(channel: f32) -> f32 {
    if channel <= 0.04045 { channel / 12.92 } else { ((channel + 0.055) / 1.055).powf(2.4) }
}
