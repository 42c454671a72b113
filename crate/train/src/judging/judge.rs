//! What predictions of one dataset are judged against: its truth, its body, its cloth at rest. All in the body frame.

use super::errors::Errors;
use super::folds::{FoldErrors, FoldJudge, FrameFolds};
use crate::dataset::{Sample, Setup};
use crate::{Error, Result};
use ctsn_cloth::simulate::BodyDistance;
use ctsn_core::cpu::Cpu;
use ctsn_core::model::HostModel;
use ctsn_core::operation::Normals;
use ctsn_core::topology::Graph;
use ctsn_rig::mesh::bounds;
use ctsn_rig::path::body_frame;
use ctsn_rig::{Character, Pose, vertices};
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use std::ops::Range;

/// Errors of one way to predict on one pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PoseErrors {
    /// E_dist, metres.
    pub distance: f64,
    /// E_norm, degrees.
    pub normal: f64,
    /// Share of vertices inside the body.
    pub penetrating: f64,
    /// Greatest depth inside the body, metres.
    pub depth: f64,
    /// Share of the cloth's edges that pass through a face of the body.
    pub crossing: f64,
    /// Whether a limb has come out through the cloth.
    pub out: bool,
    /// Mean over edges of `|l_p - l_g| / l_rest`.
    pub stretch: f64,
}

/// One way to predict: its predictions for every judged sample, and their errors.
pub struct Run {
    /// Positions in the body frame [samples][n].
    pub positions: Vec<Vec<DVec3>>,
    /// Errors by sample.
    pub frames: Vec<PoseErrors>,
    /// Folds by sample.
    pub folds: Vec<FrameFolds>,
}

/// Judges predictions of the poses of one dataset.
pub struct Judge<'a> {
    setup: &'a Setup,
    character: Character,
    body: BodyDistance,
    /// Each edge once, with its length at rest, metres.
    edges: Vec<([usize; 2], f64)>,
    folds: FoldJudge,
    /// Greatest extent of the canonical body, metres: the height of an upright body, the length of one on four legs.
    pub size: f64,
}

impl<'a> Judge<'a> {
    /// A judge of the poses of `setup`.
    pub fn new(setup: &'a Setup) -> Result<Self> {
        let rest = vertices(&setup.template);
        let graph = Graph::new(rest.len(), &setup.triangles);
        let directed = (0..rest.len()).flat_map(|i| graph.of(i).iter().map(move |j| [i, *j as usize]));
        let once = directed.filter(|[i, j]| i < j).map(|[i, j]| ([i, j], rest[i].distance(rest[j])));
        let edges: Vec<_> = once.filter(|(_, length)| *length > 0.0).collect();
        let [low, high] = bounds(vertices(&setup.body));
        let size = (high - low).max_element();
        if !(size > 0.0 && size.is_finite()) || edges.is_empty() {
            let found = format!("found an extent of {size} m and {} edges", edges.len());
            return Err(Error::Dataset(format!("wanted a body with an extent and cloth with edges, {found}")));
        }
        Ok(Self {
            setup,
            character: setup.character()?,
            body: body_distance(setup)?,
            edges,
            folds: FoldJudge::new(setup)?,
            size,
        })
    }

    /// World positions [n, 3] -> body frame of the dataset.
    pub fn to_body(&self, sample: &Sample, world: &[f32]) -> Vec<DVec3> {
        let into = body_frame(&self.character, &ctsn_rig::pose(&sample.joints));
        vertices(world).into_iter().map(|position| into.transform_point3(position)).collect()
    }

    /// The body and its joints in the body frame of `sample`.
    pub fn figure(&self, sample: &Sample) -> (&Character, Pose) {
        (&self.character, ctsn_rig::path::to_body_frame(&self.character, &ctsn_rig::pose(&sample.joints)))
    }

    /// Poses per second of the clips, as they were sampled.
    pub fn rate(&self) -> f64 {
        self.setup.description.rate
    }

    /// The pose a share `t` of the way from `a` to `b`.
    pub fn between(&self, a: &Sample, b: &Sample, t: f64) -> Pose {
        ctsn_rig::path::between(&self.character, &ctsn_rig::pose(&a.joints), &ctsn_rig::pose(&b.joints), t)
    }

    /// Judges `positions` [samples][n], body frame.
    pub fn run(&self, samples: &[&Sample], positions: Vec<Vec<DVec3>>) -> Run {
        let judge = |(sample, predicted): (&&Sample, &Vec<DVec3>)| {
            let truth = vertices(&sample.truth);
            (self.pose_errors(sample, predicted, &truth), self.folds.frame(predicted, &truth))
        };
        let (frames, folds) = samples.par_iter().zip(&positions).map(judge).unzip();
        Run { frames, folds, positions }
    }

    fn pose_errors(&self, sample: &Sample, predicted: &[DVec3], truth: &[DVec3]) -> PoseErrors {
        let (distance, normal) = differences(predicted, truth, &self.setup.triangles);
        let pose = ctsn_rig::pose(&sample.joints);
        let signed = self.body.signed(&pose, predicted);
        let inside = signed.iter().filter(|distance| **distance < 0.0).count() as f64;
        let depth = signed.iter().fold(0.0, |depth: f64, distance| depth.max(-distance));
        let stretch = self
            .edges
            .iter()
            .map(|([i, j], rest)| (predicted[*i].distance(predicted[*j]) - truth[*i].distance(truth[*j])).abs() / rest);
        let edges = self.edges.len() as f64;
        let crossed = self.body.crossed(&pose, predicted, self.edges.iter().map(|(ends, _)| *ends));
        let (penetrating, crossing) = (inside / predicted.len() as f64, crossed as f64 / edges);
        let out = self.body.limb_out(&pose, predicted).is_some();
        PoseErrors { distance, normal, penetrating, depth, crossing, out, stretch: stretch.sum::<f64>() / edges }
    }

    /// Errors of `run` over the samples in `range`.
    pub fn errors(&self, samples: &[&Sample], run: &Run, range: Range<usize>) -> Errors {
        let rate = self.setup.description.rate;
        let jitter = super::jitter(&samples[range.clone()], &run.positions[range.clone()], rate);
        Errors {
            folds: FoldErrors::over(&run.folds[range.clone()]),
            ..Errors::over(&run.frames[range], jitter, self.size)
        }
    }

    /// Mean over the samples of distance (metres) and angle (degrees), by vertex [n].
    pub fn by_vertex(&self, samples: &[&Sample], run: &Run) -> Vec<(f64, f64)> {
        let mut sums = vec![(0.0, 0.0); self.setup.template.len() / 3];
        for (sample, predicted) in samples.iter().zip(&run.positions) {
            let truth = vertices(&sample.truth);
            let errors = vertex_errors(predicted, &truth, &self.setup.triangles);
            sums.iter_mut().zip(errors).for_each(|(sum, error)| *sum = (sum.0 + error.0, sum.1 + error.1));
        }
        let count = samples.len().max(1) as f64;
        sums.into_iter().map(|(distance, angle)| (distance / count, angle / count)).collect()
    }
}

/// Refuses a model whose cloth or joints are not those of the dataset of `setup`.
pub fn check_same(model: &HostModel, setup: &Setup) -> Result<()> {
    let size = |vertices: usize, triangles: &[u32]| format!("{vertices} vertices, {} triangles", triangles.len() / 3);
    let wanted = size(model.sizes.vertices, &model.triangles);
    let found = size(setup.template.len() / 3, &setup.triangles);
    if wanted != found {
        return Err(Error::Dataset(format!("its cloth is not the model's: wanted {wanted}; found {found}")));
    }
    if !is_same_cloth(model, setup) {
        return Err(Error::Dataset("its cloth is not the model's: as many triangles, of other vertices".to_owned()));
    }
    check_joints(model, setup)
}

/// Whether the model's cloth is the very mesh of the dataset.
pub fn is_same_cloth(model: &HostModel, setup: &Setup) -> bool {
    model.rest.len() == setup.template.len() && model.triangles == setup.triangles
}

/// Refuses a model whose joints are not those of the dataset of `setup`.
pub fn check_joints(model: &HostModel, setup: &Setup) -> Result<()> {
    let (wanted, found) = (&model.rig.joints, &setup.description.joints);
    if wanted != found {
        let pairs = || wanted.iter().zip(found);
        let differing = pairs().find(|(wanted, found)| wanted != found);
        let place = differing.map(|(wanted, found)| format!(", {wanted:?} against {found:?}")).unwrap_or_default();
        let counts = format!("wanted {} joints, found {}{place}", wanted.len(), found.len());
        return Err(Error::Dataset(format!("its joints are not the model's: {counts}")));
    }
    Ok(())
}

/// Distance in metres and angle between vertex normals in degrees, by vertex, of two states [n] of one cloth.
pub fn vertex_errors<'a>(
    a: &'a [DVec3],
    b: &'a [DVec3],
    triangles: &[u32],
) -> impl Iterator<Item = (f64, f64)> + use<'a> {
    let [of_a, of_b] = [a, b].map(|positions| vertex_normals(positions, triangles));
    // The arc cosine loses the small angles to rounding.
    let angle = |a: DVec3, b: DVec3| a.cross(b).length().atan2(a.dot(b)).to_degrees();
    let normals = of_a.into_iter().zip(of_b);
    a.iter().zip(b).zip(normals).map(move |((a, b), normals)| (a.distance(*b), angle(normals.0, normals.1)))
}

/// Means over the vertices of [`vertex_errors`].
pub fn differences(a: &[DVec3], b: &[DVec3], triangles: &[u32]) -> (f64, f64) {
    let sum = vertex_errors(a, b, triangles).fold((0.0, 0.0), |sum, error| (sum.0 + error.0, sum.1 + error.1));
    let count = a.len().max(1) as f64;
    (sum.0 / count, sum.1 / count)
}

pub(super) fn vertex_normals(positions: &[DVec3], triangles: &[u32]) -> Vec<DVec3> {
    let positions = ctsn_rig::numbers(positions);
    let mut result = vec![0.0; positions.len()];
    Cpu::new().compute(Normals { positions: &positions[..], triangles, normals: &mut result[..] });
    vertices(&result)
}

/// Distances to the dataset's own body: nothing but the dataset is needed to judge contact.
pub fn body_distance(setup: &Setup) -> Result<BodyDistance> {
    BodyDistance::new(&setup.character()?, &setup.cloth())
}
