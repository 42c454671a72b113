//! The model before its first step: everything that is not learned, and seeded initial weights.
//! The mesh stream sees the body vertex nearest to each cloth vertex (KD-tree). network.md §3, §4.

use super::blur::blur;
use super::compass::compass;
use super::{limbs, weights};
use crate::dataset::{Sample, Setup};
use crate::{Error, Result};
use ctsn_core::cpu::Cpu;
use ctsn_core::model::surroundings::{INPUTS, surroundings};
use ctsn_core::model::{HostModel, Layer, Linear, Reference, Sizes, Skinning};
use ctsn_core::network::skin;
use ctsn_core::operation::Space;
use ctsn_core::pose::{BodyFrame, Frame, Range, Rig};
use ctsn_core::topology::Graph;
use ctsn_rig::{SkinWeights, is_obstacle};
use std::sync::Arc;

/// Sizes of the network that are free to choose.
#[derive(Clone, Copy, Debug, PartialEq, clap::Args)]
pub struct Architecture {
    /// Size of the pose embedding, m
    #[arg(long, default_value_t = Self::default().embedding)]
    pub embedding: usize,
    /// Mesh basis matrices, k
    #[arg(long, default_value_t = Self::default().basis)]
    pub basis: usize,
    /// Graph transformer layers, L
    #[arg(long, default_value_t = Self::default().layers)]
    pub layers: usize,
    /// Attention heads, C
    #[arg(long, default_value_t = Self::default().heads)]
    pub heads: usize,
    /// Features of a graph layer, F
    #[arg(long, default_value_t = Self::default().features)]
    pub features: usize,
}

impl Default for Architecture {
    fn default() -> Self {
        Self { embedding: 64, basis: 64, layers: 1, heads: 4, features: 64 }
    }
}

/// Hidden layer of the vertex-level MLP.
const VERTEX: usize = 64;
/// Least standard deviation of a pose number: a joint that hardly moved in training must not amplify.
const LEAST_STD: f32 = 0.05;
/// Least share of the cloth that a joint must carry to be heard. What head, hands and feet do tells a shirt nothing,
/// but a network finds something in it: a T-shirt's validation error (363 poses, 20 epochs) was 11.24 and 11.16 mm with
/// all joints, two seeds, and 9.72 and 10.16 mm without these.
const CARRIED: f64 = 1.5e-3;
/// Standard deviation of the numbers of other joints: the network sees zeros.
const UNHEARD: f32 = 1e6;

/// The untrained model for a dataset; means and deviations from the training samples alone.
pub fn initial(setup: &Setup, train: &[&Sample], architecture: Architecture, seed: u64) -> Result<HostModel> {
    let (n, joints) = (setup.template.len() / 3, setup.description.joints.len());
    let Architecture { embedding, basis, layers, heads, features } = architecture;
    if heads == 0 || features == 0 || features % heads != 0 || layers == 0 || embedding == 0 || basis == 0 {
        return Err(Error::Training(format!(
            "heads must divide features and all sizes be positive, found {architecture:?}"
        )));
    }
    let mut rng = fastrand::Rng::with_seed(seed);
    let graph = Graph::new(n, &setup.triangles);
    let nearest = setup.nearest()?;
    let body_frames = body_frames(setup, train)?;
    let inputs = |l: usize| if l == 0 { INPUTS } else { features };
    let weights = weights::smooth(setup, &graph, &nearest)?;
    let [skeleton_basis, mesh_basis] = [embedding, basis].map(|count| {
        let mut basis = small(n * 3 * count, &mut rng);
        blur(&graph, &mut basis);
        basis
    });
    let (carried, heard) = heard(setup, &weights);
    let parts = limbs::parts(&setup.description.parents, &carried, &heard);
    let drawn = setup.drawn.as_ref();
    Ok(HostModel {
        sizes: Sizes { vertices: n, joints, embedding, basis, features, heads },
        reference: reference(setup, &graph, &body_frames)?,
        surroundings: Some(surroundings(&compass(&setup.template, &setup.triangles, &graph))),
        rig: Arc::new(standardised(setup, &body_frames, &heard)?),
        skinning: weights::trainable(&graph, &weights),
        triangles: setup.triangles.clone(),
        graph,
        rest: setup.template.clone(),
        embedding: limbs::embedding(&parts, embedding, &mut rng),
        skeleton_basis,
        layers: (0..layers).map(|l| layer(inputs(l), features, &mut rng)).collect(),
        vertex_mlp: mlp(&[features, VERTEX, basis], &mut rng),
        mesh_basis,
        mesh_stream: true,
        surface: Some(drawn.map_or(&setup.surface, |drawn| &drawn.surface).clone()).filter(|it| !it.vertex.is_empty()),
        ride: drawn.map(|drawn| drawn.ride.clone()),
        cut: None,
        body: None,
        training: None,
    })
}

fn rig(setup: &Setup) -> Result<Rig> {
    let description = &setup.description;
    let transform = |numbers: &Vec<f32>| <[f32; 12]>::try_from(numbers.as_slice()).ok();
    let inverse_bind: Option<Vec<_>> = description.inverse_bind.iter().map(transform).collect();
    let joints = description.joints.len();
    let inverse_bind = inverse_bind.filter(|list| list.len() == joints && description.root < joints);
    let wrong = || Error::Dataset(format!("wanted {joints} inverse binds of 12 numbers and a root among the joints"));
    Ok(Rig {
        frame: Frame::HipYaw,
        root: description.root,
        joints: description.joints.clone(),
        inverse_bind: inverse_bind.ok_or_else(wrong)?,
        mean: vec![0.0; 12 * joints],
        std: vec![1.0; 12 * joints],
        range: None,
    })
}

/// Body frame of every sample; the pose vectors are not yet standardised.
fn body_frames(setup: &Setup, samples: &[&Sample]) -> Result<Vec<BodyFrame>> {
    let rig = rig(setup)?;
    let body_frame = |sample: &&Sample| {
        let mut body_frame = BodyFrame::new(rig.joints.len());
        rig.body_frame(&sample.joints, &mut body_frame)?;
        Ok(body_frame)
    };
    samples.iter().map(body_frame).collect()
}

/// How much cloth each joint carries, in vertices, by the cloth's skin weights, and which joints the network therefore
/// listens to: obstacles, too.
fn heard(setup: &Setup, weights: &[SkinWeights]) -> (Vec<f64>, Vec<bool>) {
    let joints = &setup.description.joints;
    let mut carried = vec![0.0; joints.len()];
    weights.iter().flatten().for_each(|(joint, weight)| carried[*joint] += weight);
    let least = CARRIED * weights.len() as f64;
    let heard = joints.iter().zip(&carried).map(|(joint, carried)| *carried >= least || is_obstacle(joint)).collect();
    (carried, heard)
}

fn standardised(setup: &Setup, body_frames: &[BodyFrame], heard: &[bool]) -> Result<Rig> {
    let mut rig = rig(setup)?;
    rig.range = Range::of(&rig.inverse_bind, body_frames);
    for i in 0..rig.mean.len() {
        let (mean, std) = moments(body_frames.iter().map(|body_frame| f64::from(body_frame.vector[i])));
        rig.mean[i] = mean;
        rig.std[i] = if heard[i / 12] { std.max(LEAST_STD) } else { UNHEARD };
    }
    Ok(rig)
}

fn moments(values: impl Iterator<Item = f64> + Clone) -> (f32, f32) {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    let variance = values.map(|value| (value - mean) * (value - mean)).sum::<f64>() / count;
    (mean as f32, variance.sqrt() as f32)
}

fn reference(
    setup: &Setup,
    graph: &Graph<Vec<u32>>,
    body_frames: &[BodyFrame],
) -> Result<Reference<Vec<f32>, Vec<u32>>> {
    let nearest = setup.reference()?;
    let rest: Vec<f32> = nearest.iter().flat_map(|i| setup.body[3 * i..3 * i + 3].iter().copied()).collect();
    // Where figure and obstacle part, cloth between them would be torn: the seam was seen in what the network made of
    // it.
    let rows: Vec<_> = match setup.description.joints.iter().any(|joint| is_obstacle(joint)) {
        true => weights::smooth(setup, graph, &nearest)?,
        false => nearest.iter().map(|i| setup.body_weights[*i].clone()).collect(),
    };
    let weights = rows_to_skin(&rows);
    let mut values = [Vec::new(), Vec::new(), Vec::new()];
    let mut posed = vec![0.0; rest.len()];
    for body_frame in body_frames {
        skin(&mut Cpu::new(), &rest, &weights, &body_frame.transforms, Space::Body, &mut posed);
        for position in posed.as_chunks::<3>().0 {
            (0..3).for_each(|c| values[c].push(f64::from(position[c])));
        }
    }
    let moments: [(f32, f32); 3] = std::array::from_fn(|c| moments(values[c].iter().copied()));
    let length = |i: usize, j: usize| -> f32 {
        (0..3).map(|c| (setup.template[3 * i + c] - setup.template[3 * j + c]).powi(2)).sum::<f32>().sqrt()
    };
    let lengths = (0..nearest.len()).flat_map(|i| graph.of(i).iter().map(move |j| length(i, *j as usize)));
    let total: f32 = lengths.sum();
    Ok(Reference {
        mean: moments.map(|moments| moments.0),
        std: moments.map(|moments| moments.1.max(1e-3)),
        edge_scale: total / graph.neighbours.len().max(1) as f32,
        rest,
        skinning: weights,
    })
}

pub(super) fn rows_to_skin(rows: &[SkinWeights]) -> Skinning<Vec<f32>, Vec<u32>> {
    let width = rows.iter().map(Vec::len).max().unwrap_or(0).max(1);
    let mut skin = Skinning { joints: vec![0; rows.len() * width], weights: vec![0.0; rows.len() * width], width };
    for (i, row) in rows.iter().enumerate() {
        for (slot, (joint, weight)) in row.iter().enumerate() {
            skin.joints[i * width + slot] = *joint as u32;
            skin.weights[i * width + slot] = *weight as f32;
        }
    }
    skin
}

/// Residual matrices start near nothing, so that training starts from plain skinning.
fn small(length: usize, rng: &mut fastrand::Rng) -> Vec<f32> {
    (0..length).map(|_| (rng.f32() - 0.5) * 4e-4).collect()
}

/// PyTorch's default: uniform in ±1/√inputs.
pub(super) fn linear(inputs: usize, outputs: usize, rng: &mut fastrand::Rng) -> Linear<Vec<f32>> {
    let bound = 1.0 / (inputs as f32).sqrt();
    let mut uniform = |length: usize| (0..length).map(|_| (rng.f32() * 2.0 - 1.0) * bound).collect();
    Linear { weight: uniform(inputs * outputs), bias: uniform(outputs), inputs, outputs }
}

pub(crate) fn mlp(sizes: &[usize], rng: &mut fastrand::Rng) -> Vec<Linear<Vec<f32>>> {
    sizes.windows(2).map(|pair| linear(pair[0], pair[1], rng)).collect()
}

pub(crate) fn layer(inputs: usize, features: usize, rng: &mut fastrand::Rng) -> Layer<Vec<f32>> {
    Layer {
        project: linear(inputs, 4 * features, rng),
        edge: linear(6, features, rng).weight,
        gate: linear(3 * features, 1, rng).weight,
        norm_weight: vec![1.0; features],
        norm_bias: vec![0.0; features],
    }
}
