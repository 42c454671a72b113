//! Errors of a model on simulated poses it has not seen. network.md §7.
//! E_dist: mean distance of vertices; E_norm: mean angle between vertex normals; penetration: vertices inside the posed body.

use crate::dataset::{Dataset, Sample, Setup, Split};
use crate::rig::{self, Mesh, Pose, vertices};
use crate::simulate::BodyDistance;
use crate::{Error, Result};
use ctsn_core::cpu::{Level, normals::normals};
use ctsn_core::model::HostModel;
use ctsn_core::{Predictor, Streams};
use glam::{DAffine3, DVec3};
use serde::Serialize;

/// Mean and standard deviation over frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Statistic {
    /// Mean over frames.
    pub mean: f64,
    /// Standard deviation over frames.
    pub std: f64,
}

/// Errors of one way to predict.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// E_dist, metres.
    pub distance: Statistic,
    /// E_norm, degrees.
    pub normal: Statistic,
    /// Share of vertices inside the body, mean over frames.
    pub penetrating: f64,
    /// Greatest depth inside the body, metres.
    pub depth: f64,
}

/// What `ctsn evaluate` reports.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Frames evaluated.
    pub frames: usize,
    /// Poses the simulation left out of the dataset.
    pub rejected: usize,
    /// The whole network.
    pub network: Errors,
    /// The skeleton stream alone.
    pub skeleton: Errors,
    /// Plain linear blend skinning with `W_C^I`.
    pub skinning: Errors,
    /// The simulated truth itself: its penetration; distances are zero.
    pub truth: Errors,
    /// E_dist of the network over that of plain skinning.
    pub ratio: f64,
}

/// Errors of one frame.
struct Frame {
    distance: f64,
    normal: f64,
    penetrating: f64,
    depth: f64,
}

/// Evaluates `model` on one split of `dataset`.
pub fn evaluate(model: &HostModel, dataset: &Dataset, split: Split) -> Result<Report> {
    let samples = dataset.split(split);
    if samples.is_empty() {
        return Err(Error::Dataset(format!("the split {split:?} is empty: {} poses in all", dataset.samples.len())));
    }
    let (wanted, found) = (model.sizes.vertices * 3, dataset.setup.template.len());
    if wanted != found || model.triangles != dataset.setup.triangles {
        return Err(Error::Dataset(format!("its cloth is not the model's: {} and {} vertices", found / 3, wanted / 3)));
    }
    let body = body_distance(&dataset.setup)?;
    let mut predictor = Predictor::from_model(model.clone(), Level::new());
    let mut frames = [Vec::new(), Vec::new(), Vec::new(), Vec::new()];
    for sample in &samples {
        let pose = rig::pose(&sample.joints);
        for (list, streams) in frames.iter_mut().zip([Streams::Both, Streams::Skeleton, Streams::None]) {
            predictor.predict_row_major(&sample.joints, streams)?;
            let predicted = to_body(&predictor, predictor.positions());
            list.push(compare(&predicted, sample, model, &body, &pose));
        }
        frames[3].push(compare(&vertices(&sample.truth), sample, model, &body, &pose));
    }
    let [network, skeleton, skinning, truth] = frames.map(|list| errors(&list));
    let ratio = network.distance.mean / skinning.distance.mean;
    Ok(Report { frames: samples.len(), rejected: dataset.rejected.len(), network, skeleton, skinning, truth, ratio })
}

/// World positions -> body frame, by the inverse of the predictor's own `N⁻¹`.
fn to_body(predictor: &Predictor, positions: &[f32]) -> Vec<DVec3> {
    let transforms = &predictor.activations().body_frame;
    let into: DAffine3 = rig::pose(transforms).last().map_or(DAffine3::IDENTITY, DAffine3::inverse);
    vertices(positions).into_iter().map(|position| into.transform_point3(position)).collect()
}

fn compare(predicted: &[DVec3], sample: &Sample, model: &HostModel, body: &BodyDistance, pose: &Pose) -> Frame {
    let (distance, normal) = differences(predicted, &vertices(&sample.truth), &model.triangles);
    let signed = body.signed(pose, predicted);
    let inside = signed.iter().filter(|distance| **distance < 0.0).count() as f64;
    let depth = signed.iter().fold(0.0, |depth: f64, distance| depth.max(-distance));
    Frame { distance, normal, penetrating: inside / predicted.len() as f64, depth }
}

/// Mean distance of vertices in metres and mean angle between vertex normals in degrees, of two states [n] of one cloth.
pub fn differences(a: &[DVec3], b: &[DVec3], triangles: &[u32]) -> (f64, f64) {
    let count = a.len() as f64;
    let distance = a.iter().zip(b).map(|(a, b)| a.distance(*b)).sum::<f64>() / count;
    let angle = |(a, b): (&DVec3, &DVec3)| a.dot(*b).clamp(-1.0, 1.0).acos().to_degrees();
    let [a, b] = [a, b].map(|positions| vertex_normals(positions, triangles));
    (distance, a.iter().zip(&b).map(angle).sum::<f64>() / count)
}

fn vertex_normals(positions: &[DVec3], triangles: &[u32]) -> Vec<DVec3> {
    let positions = rig::numbers(positions);
    let mut result = vec![0.0; positions.len()];
    normals(&positions, triangles, &mut result);
    vertices(&result)
}

/// The dataset's own body around its cloth, so that nothing but the dataset is needed to judge what touches it.
pub fn body_distance(setup: &Setup) -> Result<BodyDistance> {
    let cloth = Mesh { positions: vertices(&setup.template), triangles: setup.triangles.as_chunks::<3>().0.to_vec() };
    BodyDistance::new(&setup.character()?, &cloth)
}

fn errors(frames: &[Frame]) -> Errors {
    let statistic = |part: fn(&Frame) -> f64| {
        let count = frames.len() as f64;
        let mean = frames.iter().map(part).sum::<f64>() / count;
        let variance = frames.iter().map(|frame| (part(frame) - mean).powi(2)).sum::<f64>() / count;
        Statistic { mean, std: variance.sqrt() }
    };
    Errors {
        distance: statistic(|frame| frame.distance),
        normal: statistic(|frame| frame.normal),
        penetrating: statistic(|frame| frame.penetrating).mean,
        depth: frames.iter().map(|frame| frame.depth).fold(0.0, f64::max),
    }
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{} frames; {} poses were left out by the simulation", self.frames, self.rejected)?;
        writeln!(f, "{:<18}{:>18}{:>18}{:>13}{:>11}", "", "E_dist mm", "E_norm deg", "inside %", "depth mm")?;
        let rows = [
            ("network", &self.network),
            ("skeleton stream", &self.skeleton),
            ("plain skinning", &self.skinning),
            ("simulation", &self.truth),
        ];
        for (name, errors) in rows {
            let pair =
                |statistic: Statistic, unit: f64| format!("{:.2} ± {:.2}", statistic.mean * unit, statistic.std * unit);
            let (distance, normal) = (pair(errors.distance, 1e3), pair(errors.normal, 1.0));
            let (inside, depth) = (errors.penetrating * 100.0, errors.depth * 1e3);
            writeln!(f, "{name:<18}{distance:>18}{normal:>18}{inside:>13.2}{depth:>11.1}")?;
        }
        write!(f, "network / plain skinning: {:.1} % of E_dist", self.ratio * 100.0)
    }
}
