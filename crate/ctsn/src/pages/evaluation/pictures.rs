//! Pictures of truth, prediction and error side by side, from one camera.

use super::repair::{self, Repaired};
use crate::pages::html::picture;
use crate::pictures::{View, comparison};
use ctsn_core::Streams;
use ctsn_core::model::HostModel;
use ctsn_rig::Result;
use ctsn_rig::statistics::Sorted;
use ctsn_rig::vertices;
use ctsn_train::dataset::{Dataset, Sample};
use ctsn_train::judging::{FrameErrors, Judge, Report, predictions, vertex_errors};
use maud::{Markup, html};

/// Clips of which the worst frame is shown.
const CLIPS: usize = 6;
/// Views of each frame: front and back.
const VIEWS: [View; 2] = [View::THREE[0], View::THREE[2]];
/// Millimetres to which the top of the heat map's scale is rounded up.
const STEP: f64 = 5.0;

/// Pictures of some frames, worst first.
pub struct Gallery {
    /// Error that gets the strongest colour, mm.
    top: f64,
    /// Caption and pictures [views] of (truth, prediction, error).
    frames: Vec<(String, Vec<[Markup; 3]>)>,
    /// Mean error by vertex on the garment at rest [views].
    mean: Vec<Markup>,
    /// Frames before and after the repair of penetration.
    repaired: Vec<Repaired>,
}

/// The frames to show, as indices into the report: the worst of each of the worst clips, and the median frame.
fn choose(report: &Report) -> Vec<usize> {
    let mut clips = std::collections::BTreeSet::new();
    let worst = (0..report.frames.len()).filter(|i| clips.insert(report.frames[*i].clip.as_str()));
    let mut chosen: Vec<usize> = worst.take(CLIPS).collect();
    let median = report.frames.len() / 2;
    if !chosen.contains(&median) {
        chosen.push(median);
    }
    chosen
}

/// Error in mm -> linear RGB, from pale yellow to dark red at `top`.
fn heat(error: f64, top: f64) -> [f32; 3] {
    let colour = colorous::YELLOW_ORANGE_RED.eval_continuous((error / top).clamp(0.0, 1.0));
    [colour.r, colour.g, colour.b].map(|value| (f32::from(value) / 255.0).powf(2.2))
}

impl Gallery {
    /// Draws the predictions of `model` for frames of `report`, which was made on `dataset`.
    pub fn new(model: &HostModel, dataset: &Dataset, report: &Report) -> Result<Self> {
        let judge = Judge::new(&dataset.setup)?;
        let clips = &dataset.setup.description.clips;
        let sample = |frame: &FrameErrors| {
            let same =
                |sample: &&Sample| (&clips[sample.record.clip], sample.record.frame) == (&frame.clip, frame.frame);
            dataset.samples.iter().find(same)
        };
        let (chosen, samples): (Vec<usize>, Vec<&Sample>) =
            choose(report).into_iter().filter_map(|i| Some((i, sample(&report.frames[i])?))).unzip();
        let predicted = predictions(model, &judge, &samples, Streams::Both)?;
        let triangles = &dataset.setup.triangles;
        let errors = samples.iter().zip(&predicted).map(|(sample, predicted)| -> Vec<f64> {
            vertex_errors(predicted, &vertices(&sample.truth), triangles).map(|error| 1e3 * error.0).collect()
        });
        let errors: Vec<Vec<f64>> = errors.collect();
        let high = Sorted::new(errors.iter().flatten().copied()).percentile(98);
        let top = STEP * (high / STEP).ceil().max(1.0);
        let triangles = triangles.as_chunks::<3>().0;
        let mut frames = Vec::new();
        for ((index, sample), (predicted, errors)) in chosen.iter().zip(&samples).zip(predicted.iter().zip(&errors)) {
            let (character, pose) = judge.figure(sample);
            let colour: Vec<[f32; 3]> = errors.iter().map(|error| heat(*error, top)).collect();
            let truth = vertices(&sample.truth);
            let cloths: [(&[_], &[_]); 3] = [(&truth, &[]), (predicted, &[]), (predicted, &colour)];
            let pictures = comparison(character, &pose, triangles, &cloths, &VIEWS);
            let frame = &report.frames[*index];
            let mut views = Vec::new();
            for pictures in pictures {
                let mut embedded = ["simulation", "prediction", "error"].into_iter().zip(&pictures);
                let mut next = || embedded.next().map_or(Ok(html! {}), |(what, image)| picture(image, what));
                views.push([next()?, next()?, next()?]);
            }
            let rank = if *index == report.frames.len() / 2 { "median frame: " } else { "" };
            let (distance, normal) = (1e3 * frame.network.distance, frame.network.normal);
            let caption = format!("{rank}{} {}: {distance:.1} mm, {normal:.1}°", frame.clip, frame.frame);
            frames.push((caption, views));
        }
        let repaired = repair::pictures(model, &judge, report, triangles, &VIEWS, sample)?;
        Ok(Self { top, frames, mean: mean(dataset, report, top)?, repaired })
    }

    /// The pictures with their captions and scale.
    pub(super) fn markup(&self) -> Markup {
        let stops = (0..=8).map(|i| {
            let colour = colorous::YELLOW_ORANGE_RED.eval_rational(i, 9);
            format!("#{colour:x}")
        });
        let gradient = format!("background:linear-gradient(to right,{})", stops.collect::<Vec<_>>().join(","));
        html! {
            h2 { "Where the error is" }
            p {
                "First the mean over the frames judged, on the garment at rest; then the worst frame of each of the \
                worst clips."
            }
            p class="scale" { "0 mm" i style=(gradient) {} (format!("{:.0} mm and more", self.top)) }
            div class="views two" { @for view in &self.mean { (view) } }
            @for (caption, views) in &self.frames {
                h3 { (caption) }
                div class="views" {
                    span { "simulation" } span { "prediction" } span { "error" }
                    @for view in views { @for picture in view { (picture) } }
                }
            }
            (repair::markup(&self.repaired))
        }
    }
}

/// Mean error by vertex on the garment at rest, from each view.
fn mean(dataset: &Dataset, report: &Report, top: f64) -> Result<Vec<Markup>> {
    let setup = &dataset.setup;
    let character = setup.character()?;
    let colour: Vec<[f32; 3]> = report.by_vertex.iter().map(|error| heat(1e3 * error, top)).collect();
    let rest = vertices(&setup.template);
    let (pose, triangles) = (character.canonical_pose(), setup.triangles.as_chunks::<3>().0);
    let pictures = comparison(&character, &pose, triangles, &[(&rest, &colour)], &VIEWS);
    pictures.into_iter().flatten().map(|image| picture(&image, "mean error")).collect()
}
