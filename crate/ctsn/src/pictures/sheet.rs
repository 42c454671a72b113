//! Contact sheet of a dataset: poses spread over its clips, from front and back, at one scale, centred on the cloth.

use super::canvas::Canvas;
use super::figure::Figure;
use super::{View, text};
use ctsn_rig::mesh;
use ctsn_rig::path::{body_frame, to_body_frame};
use ctsn_rig::{Character, pose, vertices};
use ctsn_rig::{Error, Result};
use ctsn_train::dataset::{Dataset, Sample};
use glam::{DVec2, DVec3};
use image::{Rgb, RgbImage};
use std::path::Path;

/// Poses on a sheet, and how many of them side by side.
const POSES: usize = 12;
const COLUMNS: usize = 4;
/// Pixels of one view, and between two.
const VIEW: [usize; 2] = [246, 356];
const GAP: usize = 4;
/// Height of a caption with the space around it, pixels.
const CAPTION: usize = text::HEIGHT + 10;
/// Share of the view on either side of the cloth: enough of the body to understand the pose.
const MARGIN: f64 = 0.14;

/// Which poses of a dataset are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Poses {
    /// The frames that were kept.
    Kept,
    /// The mixed poses that were kept.
    Mixed,
    /// The frames that were left out.
    LeftOut,
}

/// The sheet of some poses of the dataset in `folder`, which was made with `character`.
pub fn sheet(folder: &Path, dataset: &Dataset, character: &Character, poses: Poses) -> Result<RgbImage> {
    let description = &dataset.setup.description;
    let names = character.joints.iter().map(|joint| &joint.name);
    // What was missing of the body was added behind it.
    if !names.eq(&description.joints) || character.body.mesh.positions.len() * 3 > dataset.setup.body.len() {
        return Err(Error::Dataset(format!("wanted the character {}, found another", description.character)));
    }
    let left_out;
    let samples = match poses {
        Poses::Kept => &dataset.samples,
        Poses::Mixed => &dataset.mixed,
        Poses::LeftOut => {
            left_out = dataset.left_out(folder)?;
            &left_out
        }
    };
    let chosen = choose(samples, &vertices(&dataset.setup.template), character);
    if chosen.is_empty() {
        let what = match poses {
            Poses::Kept => "no pose was kept",
            Poses::Mixed => "no mixed pose was kept",
            Poses::LeftOut => "no pose was left out",
        };
        return Err(Error::Dataset(format!("{what}, there is nothing to show")));
    }
    let setup = &dataset.setup;
    let triangles = setup.shown_triangles().as_chunks::<3>().0;
    let cloths: Vec<Vec<DVec3>> = chosen.iter().map(|sample| vertices(&setup.shown(&sample.truth))).collect();
    let views = [View::THREE[0], View::THREE[2]];
    let extent = cloths.iter().flat_map(|cloth| views.map(|view| bounds(cloth, &view)));
    let extent = extent.map(|[low, high]| (high - low).truncate()).fold(DVec2::splat(1e-3), DVec2::max);
    let size = DVec2::new(VIEW[0] as f64, VIEW[1] as f64);
    let pixels_per_metre = (size * (1.0 - 2.0 * MARGIN) / extent).min_element();
    let rows = chosen.len().div_ceil(COLUMNS);
    let pair = [2 * (VIEW[0] + GAP), VIEW[1] + GAP + CAPTION];
    let mut sheet = RgbImage::from_pixel((COLUMNS * pair[0]) as u32, (rows * pair[1]) as u32, Rgb([255; 3]));
    for (at, (sample, cloth)) in chosen.iter().zip(&cloths).enumerate() {
        let corner = [at % COLUMNS * pair[0] + GAP / 2, at / COLUMNS * pair[1]];
        let pose = to_body_frame(character, &pose(&sample.joints));
        let figure = Figure::new(character, &pose, Some((cloth, triangles)));
        let layers = figure.layers();
        let ground = layers[0].positions.iter().map(|point| point.y).fold(f64::INFINITY, f64::min);
        for (side, view) in views.iter().enumerate() {
            let [low, high] = bounds(cloth, view);
            let canvas = Canvas::new(VIEW, view.axes(), (low + high) / 2.0, pixels_per_metre);
            canvas.paint(&layers, ground).resolve(&mut sheet, [corner[0] + side * (VIEW[0] + GAP), corner[1]]);
        }
        let clip = if poses == Poses::Mixed { "mixed" } else { &description.clips[sample.record.clip] };
        let caption = format!("{clip} {}", sample.record.frame);
        text::write(&mut sheet, [corner[0], corner[1] + VIEW[1] + 5], pair[0] - GAP, &caption);
    }
    Ok(sheet)
}

/// Least and greatest corner of the cloth in view space.
fn bounds(cloth: &[DVec3], view: &View) -> [DVec3; 2] {
    let axes = view.axes();
    mesh::bounds(cloth.iter().map(|point| axes * *point))
}

/// Up to [`POSES`] of `samples`, spread evenly over the clips. Of each stretch of a clip it takes the pose whose cloth
/// is furthest from where it hangs in the canonical pose: that one is most likely to be wrong.
fn choose<'a>(samples: &'a [Sample], template: &[DVec3], character: &Character) -> Vec<&'a Sample> {
    let clips: Vec<&[Sample]> = samples.chunk_by(|a, b| a.record.clip == b.record.clip).collect();
    let body_frame = body_frame(character, &character.canonical_pose());
    let hung: Vec<DVec3> = template.iter().map(|point| body_frame.transform_point3(*point)).collect();
    let distance = |sample: &Sample| -> f64 {
        vertices(&sample.truth).iter().zip(&hung).map(|(a, b)| a.distance_squared(*b)).sum()
    };
    let furthest = |part: &'a [Sample]| part.iter().max_by(|a, b| distance(a).total_cmp(&distance(b)));
    let lengths: Vec<usize> = clips.iter().map(|clip| clip.len()).collect();
    let stretches = clips.iter().zip(deal(&lengths)).flat_map(|(clip, share)| {
        let bound = move |i: usize| i * clip.len() / share;
        (0..share).map(move |i| &clip[bound(i)..bound(i + 1)])
    });
    stretches.filter_map(furthest).collect()
}

/// How many of [`POSES`] each clip gives, from the lengths of the clips: an equal share, or all that it has.
fn deal(lengths: &[usize]) -> Vec<usize> {
    let taken = POSES.min(lengths.len());
    let taken: Vec<usize> = (0..taken).map(|i| i * lengths.len() / taken).collect();
    let most = taken.iter().map(|clip| lengths[*clip]).sum::<usize>().min(POSES);
    let mut shares = vec![0; lengths.len()];
    let rounds = (1..).flat_map(|round| taken.iter().filter(move |clip| lengths[**clip] >= round));
    rounds.take(most).for_each(|clip| shares[*clip] += 1);
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_is_full_while_there_are_poses() {
        assert_eq!(deal(&[59, 1, 4]), [7, 1, 4]);
        assert_eq!(deal(&[2, 3]), [2, 3]);
        assert_eq!(deal(&[9; 24]).iter().sum::<usize>(), POSES);
        assert!(deal(&[9; 24]).chunks(2).all(|pair| pair.iter().sum::<usize>() == 1), "evenly spread");
        assert!(deal(&[]).is_empty());
    }
}
