//! What packing changes: the cloth of a packed model beside that of the model, over poses.

use super::BOUND;
use anyhow::{Result, ensure};
use ctsn_core::cpu::Level;
use ctsn_core::file::Tensors;
use ctsn_core::model::HostModel;
use ctsn_core::{Predictor, Streams};
use ctsn_rig::{Character, joints};
use rayon::prelude::*;

/// How far two predictions are apart, polish and repair included.
#[derive(Clone, Copy, Debug, Default)]
pub struct Difference {
    /// Mean distance of a vertex, metres.
    pub distance: f64,
    /// Mean angle of its normal, degrees.
    pub angle: f64,
    /// Greatest distance of any vertex in any pose, metres.
    pub greatest: f64,
}

impl Difference {
    /// Whether it is at most a share of [`BOUND`].
    pub fn within(&self, share: f64) -> bool {
        self.distance <= share * BOUND.0 && self.angle <= share * BOUND.1
    }
}

/// Poses, and what the model predicts in them.
pub struct Trial {
    poses: Vec<Vec<f32>>,
    truth: Vec<[Vec<f32>; 2]>,
    /// Root mean square of what each basis matrix is multiplied by: skeleton stream [m], mesh stream [k].
    pub coefficients: [Vec<f32>; 2],
}

impl Trial {
    /// Of `model` in at most `most` poses, spread evenly over the clips of `character`.
    pub fn new(model: HostModel, character: &Character, most: usize) -> Result<Self> {
        let all: Vec<_> = character.clips.iter().flat_map(|clip| &clip.poses).collect();
        ensure!(
            !all.is_empty(),
            "the character has no clip: the poses of one tell what packing changes; see ctsn motion"
        );
        let chosen = all.iter().step_by(all.len().div_ceil(most));
        let ordered = chosen.map(|pose| Ok(joints(&crate::commands::ordered(&model.rig.joints, character, pose)?)));
        let poses = ordered.collect::<Result<Vec<_>>>()?;
        let mut squares = [vec![0.0; model.sizes.embedding], vec![0.0; model.sizes.basis]];
        let (mut predictor, mut truth) = (Predictor::from_model(model, Level::new()), Vec::new());
        for pose in &poses {
            predictor.predict_row_major(pose, Streams::Both)?;
            truth.push([predictor.positions().to_vec(), predictor.normals().to_vec()]);
            let a = predictor.activations();
            for (squares, values) in squares.iter_mut().zip([a.embedding.last(), a.vertex_mlp.last()]) {
                let values = values.map_or(&[][..], |values| values);
                let (width, rows) = (squares.len(), values.len() / squares.len().max(1) * poses.len());
                values.iter().enumerate().for_each(|(i, value)| squares[i % width] += value * value / rows as f32);
            }
        }
        Ok(Self { poses, truth, coefficients: squares.map(|list| list.into_iter().map(f32::sqrt).collect()) })
    }

    /// How many poses there are.
    pub fn poses(&self) -> usize {
        self.poses.len()
    }

    /// What the model of `file` predicts otherwise.
    pub fn difference(&self, file: &Tensors) -> Result<Difference> {
        let model = HostModel::read(file)?;
        let start = || Predictor::from_model(model.clone(), Level::new());
        let sums = self.poses.par_iter().zip(&self.truth).map_init(start, sum).collect::<Result<Vec<_>>>()?;
        // Pose by pose: so the sum is the same however many threads there are.
        let mut all = Difference::default();
        for sum in sums {
            all.distance += sum.distance;
            all.angle += sum.angle;
            all.greatest = all.greatest.max(sum.greatest);
        }
        let count = self.truth.iter().map(|[positions, _]| positions.len() / 3).sum::<usize>() as f64;
        Ok(Difference { distance: all.distance / count, angle: all.angle / count, ..all })
    }
}

/// In a pose: distances and angles summed over the vertices, and the greatest distance.
fn sum(predictor: &mut Predictor, (pose, [positions, normals]): (&Vec<f32>, &[Vec<f32>; 2])) -> Result<Difference> {
    predictor.predict_row_major(pose, Streams::Both)?;
    let mut sum = Difference::default();
    for (found, wanted) in predictor.positions().as_chunks::<3>().0.iter().zip(positions.as_chunks::<3>().0) {
        let apart = apart(found, wanted);
        sum.distance += apart;
        sum.greatest = sum.greatest.max(apart);
    }
    for (found, wanted) in predictor.normals().as_chunks::<3>().0.iter().zip(normals.as_chunks::<3>().0) {
        // By the chord: the cosine of a small angle has lost it.
        sum.angle += (2.0 * (apart(found, wanted) / 2.0).min(1.0).asin()).to_degrees();
    }
    Ok(sum)
}

fn apart(a: &[f32; 3], b: &[f32; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt()
}
