//! Errors of a model on simulated poses it has not seen. network.md §7, paper § "Quantitative Comparisons".

mod errors;
mod folds;
mod judge;
mod slow;
mod table;
#[cfg(test)]
mod tests;

use crate::dataset::{Dataset, Sample, Split};
use crate::{Error, Result};
use ctsn_core::cpu::Level;
use ctsn_core::model::HostModel;
use ctsn_core::{Predictor, Streams};
use ctsn_rig::{strongest, vertices};
pub use errors::{Errors, Statistic};
pub(crate) use folds::Bending;
pub use folds::{FoldErrors, FrameFolds};
use glam::DVec3;
pub use judge::{
    Judge, PoseErrors, Run, body_distance, check_joints, check_same, differences, is_same_cloth, vertex_errors,
};
use rayon::prelude::*;
use serde::Serialize;

/// Errors on the frames of one clip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClipErrors {
    /// Clip name.
    pub clip: String,
    /// Judged frames of the clip.
    pub frames: usize,
    /// The whole network.
    pub network: Errors,
    /// Plain skinning.
    pub skinning: Errors,
}

/// Errors on the vertices that follow one joint more than any other (by `W_C^I`), mean over vertices and frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointErrors {
    /// Joint name.
    pub joint: String,
    /// Vertices.
    pub vertices: usize,
    /// E_dist of the network, metres.
    pub distance: f64,
    /// E_norm of the network, degrees.
    pub normal: f64,
    /// E_dist of plain skinning, metres.
    pub skinning: f64,
}

/// Errors of one frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameErrors {
    /// Clip name.
    pub clip: String,
    /// Frame within the clip.
    pub frame: usize,
    /// The whole network.
    pub network: PoseErrors,
    /// The whole network before penetration is repaired; null where the model repairs nothing.
    pub unrepaired: Option<PoseErrors>,
    /// Plain skinning.
    pub skinning: PoseErrors,
}

/// What `ctsn evaluate` reports.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Character file name.
    pub character: String,
    /// Garment file name.
    pub garment: String,
    /// Cloth vertices.
    pub vertices: usize,
    /// Greatest extent of the canonical body, metres; what `scaled` divides by.
    pub size: f64,
    /// Whether every pose of the dataset is judged, not the unseen ones alone.
    pub whole: bool,
    /// Poses the simulation left out of the dataset.
    pub rejected: usize,
    /// The whole network.
    pub network: Errors,
    /// The whole network before penetration is repaired; null where the model repairs nothing.
    pub unrepaired: Option<Errors>,
    /// The whole network, repaired, but not polished; null where the model polishes nothing.
    pub unpolished: Option<Errors>,
    /// The skeleton stream alone.
    pub skeleton: Errors,
    /// Plain linear blend skinning with `W_C^I`.
    pub skinning: Errors,
    /// The simulated truth itself: its penetration and its jitter; distances are zero.
    pub truth: Errors,
    /// E_dist of the network over that of plain skinning.
    pub ratio: f64,
    /// By clip, in the dataset's order.
    pub clips: Vec<ClipErrors>,
    /// By joint, worst first.
    pub joints: Vec<JointErrors>,
    /// By frame, worst first.
    pub frames: Vec<FrameErrors>,
    /// E_dist of the network by vertex [n], metres: for pictures.
    #[serde(skip)]
    pub by_vertex: Vec<f64>,
}

impl Report {
    /// The ways to predict, each with its name.
    pub fn ways(&self) -> impl Iterator<Item = (&'static str, &Errors)> {
        let ways = [
            ("network", Some(&self.network)),
            ("not repaired", self.unrepaired.as_ref()),
            ("not polished", self.unpolished.as_ref()),
            ("skeleton stream", Some(&self.skeleton)),
            ("plain skinning", Some(&self.skinning)),
            ("simulation", Some(&self.truth)),
        ];
        ways.into_iter().filter_map(|(name, errors)| Some((name, errors?)))
    }
}

/// The samples of one split; an error where there are none.
pub fn unseen(dataset: &Dataset, split: Split) -> Result<Vec<&Sample>> {
    let samples = dataset.split(split);
    if samples.is_empty() {
        let (poses, clips) = (dataset.samples.len(), dataset.setup.description.clips.len());
        let wanted = match split {
            Split::Train => "poses to learn from",
            Split::Validation => "poses to validate",
            Split::Test => "unseen poses in the last tenth of the clips (with fewer than ten clips: of each)",
            Split::All => "poses along the clips",
        };
        return Err(Error::Dataset(format!("wanted {wanted}, found none: {poses} poses of {clips} clips in all")));
    }
    Ok(samples)
}

/// Positions that `model` predicts for every sample [samples][n], in the dataset's body frame.
pub fn predictions(model: &HostModel, judge: &Judge, samples: &[&Sample], streams: Streams) -> Result<Vec<Vec<DVec3>>> {
    let start = || Predictor::from_model(model.clone(), Level::new());
    let predict = |predictor: &mut Predictor, sample: &&Sample| {
        predictor.predict_row_major(&sample.joints, streams)?;
        Ok(judge.to_body(sample, predictor.positions()))
    };
    samples.par_iter().map_init(start, predict).collect()
}

/// The same model without the repair of penetration; `None` where it repairs nothing.
pub fn without_repair(model: &HostModel) -> Option<HostModel> {
    model.body.as_ref().map(|_| HostModel { body: None, ..model.clone() })
}

/// The same model without the polish; `None` where it polishes nothing.
pub fn without_polish(model: &HostModel) -> Option<HostModel> {
    model.cut.as_ref().filter(|cut| cut.steps > 0).map(|_| HostModel { cut: None, ..model.clone() })
}

/// Evaluates `model` on one split of `dataset`.
pub fn evaluate(model: &HostModel, dataset: &Dataset, split: Split) -> Result<Report> {
    judge::check_same(model, &dataset.setup)?;
    let samples = unseen(dataset, split)?;
    let judge = Judge::new(&dataset.setup)?;
    let run = |model: &HostModel, streams| {
        Ok::<_, Error>(judge.run(&samples, predictions(model, &judge, &samples, streams)?))
    };
    let bare = without_repair(model);
    let unrepaired = bare.as_ref().map(|bare| run(bare, Streams::Both)).transpose()?;
    let rough = without_polish(model);
    let unpolished = rough.as_ref().map(|rough| run(rough, Streams::Both)).transpose()?;
    let (network, skinning) = (run(model, Streams::Both)?, run(model, Streams::None)?);
    let whole = |run: &Run| judge.errors(&samples, run, 0..samples.len());
    let slow = slow::motion(&judge, &samples);
    let slow: Vec<&Sample> = slow.iter().collect();
    let moving = |run: &Run, model: &HostModel| {
        let positions = predictions(model, &judge, &slow, Streams::Both)?;
        Ok::<_, Error>(Errors { slow_jitter: jitter(&slow, &positions, slow::RATE), ..whole(run) })
    };
    let truth = judge.run(&samples, samples.iter().map(|sample| vertices(&sample.truth)).collect());
    let of_network = judge.by_vertex(&samples, &network);
    let description = &dataset.setup.description;
    Ok(Report {
        character: description.character.clone(),
        garment: description.garment.clone(),
        vertices: model.sizes.vertices,
        size: judge.size,
        whole: split == Split::All,
        rejected: dataset.rejected.len(),
        unrepaired: unrepaired.as_ref().zip(bare.as_ref()).map(|(run, bare)| moving(run, bare)).transpose()?,
        unpolished: unpolished.as_ref().zip(rough.as_ref()).map(|(run, rough)| moving(run, rough)).transpose()?,
        skeleton: whole(&run(model, Streams::Skeleton)?),
        truth: whole(&truth),
        ratio: whole(&network).distance.mean / whole(&skinning).distance.mean,
        clips: by_clip(dataset, &judge, &samples, &network, &skinning),
        joints: by_joint(dataset, &of_network, &judge.by_vertex(&samples, &skinning))?,
        frames: by_frame(dataset, &samples, &network, unrepaired.as_ref(), &skinning),
        by_vertex: of_network.into_iter().map(|(distance, _)| distance).collect(),
        network: moving(&network, model)?,
        skinning: whole(&skinning),
    })
}

/// Mean acceleration of the vertices in the body frame, m/s²: `‖x_{f+1} - 2 x_f + x_{f-1}‖ · rate²`, over all vertices
/// and all groups of three consecutive frames of a clip; `None` without such a group. The truth has the acceleration of
/// the motion; what a prediction has beyond that is trembling.
pub fn jitter(samples: &[&Sample], positions: &[Vec<DVec3>], rate: f64) -> Option<f64> {
    let place = |i: usize| (samples[i].record.clip, samples[i].record.frame);
    let follow = |i: usize| place(i) == (place(i - 1).0, place(i - 1).1 + 1);
    let (mut sum, mut count) = (0.0, 0);
    for i in (2..samples.len()).filter(|i| follow(*i) && follow(*i - 1)) {
        for ((a, b), c) in positions[i - 2].iter().zip(&positions[i - 1]).zip(&positions[i]) {
            sum += (*c - 2.0 * *b + *a).length();
            count += 1;
        }
    }
    (count > 0).then(|| sum / f64::from(count) * rate * rate)
}

fn by_clip(dataset: &Dataset, judge: &Judge, samples: &[&Sample], network: &Run, skinning: &Run) -> Vec<ClipErrors> {
    let mut start = 0;
    let clip = |part: &[&Sample]| {
        let range = start..start + part.len();
        start = range.end;
        ClipErrors {
            clip: dataset.setup.description.clips[part[0].record.clip].clone(),
            frames: part.len(),
            network: judge.errors(samples, network, range.clone()),
            skinning: judge.errors(samples, skinning, range),
        }
    };
    samples.chunk_by(|a, b| a.record.clip == b.record.clip).map(clip).collect()
}

/// Errors by joint, from those by vertex (metres, degrees) of the network and of plain skinning.
fn by_joint(dataset: &Dataset, network: &[(f64, f64)], skinning: &[(f64, f64)]) -> Result<Vec<JointErrors>> {
    let setup = &dataset.setup;
    let empty =
        |joint: &String| JointErrors { joint: joint.clone(), vertices: 0, distance: 0.0, normal: 0.0, skinning: 0.0 };
    let mut joints: Vec<JointErrors> = setup.description.joints.iter().map(empty).collect();
    for (vertex, nearest) in setup.nearest()?.into_iter().enumerate() {
        let Some(joint) = joints.get_mut(strongest(&setup.body_weights[nearest])) else { continue };
        joint.vertices += 1;
        joint.distance += network[vertex].0;
        joint.normal += network[vertex].1;
        joint.skinning += skinning[vertex].0;
    }
    joints.retain(|joint| joint.vertices > 0);
    for joint in &mut joints {
        let count = joint.vertices as f64;
        for sum in [&mut joint.distance, &mut joint.normal, &mut joint.skinning] {
            *sum /= count;
        }
    }
    joints.sort_by(|a, b| b.distance.total_cmp(&a.distance));
    Ok(joints)
}

fn by_frame(
    dataset: &Dataset,
    samples: &[&Sample],
    network: &Run,
    unrepaired: Option<&Run>,
    skinning: &Run,
) -> Vec<FrameErrors> {
    let clips = &dataset.setup.description.clips;
    let frame = |(i, sample): (usize, &&Sample)| FrameErrors {
        clip: clips[sample.record.clip].clone(),
        frame: sample.record.frame,
        network: network.frames[i],
        unrepaired: unrepaired.map(|run| run.frames[i]),
        skinning: skinning.frames[i],
    };
    let mut frames: Vec<_> = samples.iter().enumerate().map(frame).collect();
    frames.sort_by(|a, b| b.network.distance.total_cmp(&a.network.distance));
    frames
}
