//! What the loss adds for cloth inside the body: the paper's `E_B` (§ Penetration Handling) of the prediction before its repair, so that
//! less is left to repair. It needs no truth, so poses that nobody simulated teach it as well. (Of a skirt, 1.5 % of the vertices are
//! inside the body in unseen poses without this loss, 1.2 where it is of the simulated poses alone, 0.9 with others, all with
//! a weight of 1.)

use super::Settings;
use super::item::Item;
use super::recording::Recording;
use crate::Result;
use crate::dataset::{Sample, Setup};
use crate::motion::{has_limbs, mixed};
use crate::rig::{Character, Pose, joints, pose};
use crate::simulate::is_sound;
use ctsn_core::cpu::Cpu;
use ctsn_core::device::{Device, Space};
use ctsn_core::model::{Body, HostModel};
use ctsn_core::network::Streams;
use ctsn_core::pose::BodyFrame;
use rayon::prelude::*;

/// Weight of a metre inside the body beside a metre from the truth. (With 1 a repaired cape's slow motion trembled by 4.8 and 5.4 % more in
/// two trainings, with 2 by 2.8 in one; 0.3 and 0.4 % of its vertices were inside before the repair, then 0.2.)
pub(super) const WEIGHT: f32 = 2.0;

/// Unlabelled poses for each of a batch. (Of a skirt in unseen poses, one for each leaves 0.96 % inside, four leave 0.91 %, with a weight
/// of 1; a step takes 7 % longer.)
pub(super) const UNLABELLED: usize = 4;

/// The body of one pose after the other; one per thread.
pub(super) struct Penetration {
    body: Body<Vec<f32>, Vec<u32>>,
    cpu: Cpu,
    posed: Vec<f32>,
    normals: Vec<f32>,
    exposed: Vec<f32>,
    cloth: Vec<f32>,
    push: Vec<f32>,
}

impl Penetration {
    /// Room for a body and its cloth.
    pub fn new(body: &Body<Vec<f32>, Vec<u32>>, n: usize) -> Self {
        let room = |vertices: usize| vec![0.0; vertices * 3];
        let [posed, normals, exposed] = std::array::from_fn(|_| room(body.vertices));
        Self { body: body.clone(), cpu: Cpu::new(), posed, normals, exposed, cloth: room(n), push: room(n) }
    }

    /// Poses the body.
    pub fn pose(&mut self, frame: &BodyFrame) {
        let Self { body, cpu, posed, normals, exposed, .. } = self;
        cpu.skin(&body.rest, &body.skin, &frame.transforms, Space::Body, posed);
        cpu.normals(posed, &body.triangles, normals);
        cpu.bury(body, posed, normals, exposed);
    }

    /// Mean over the vertices of what `predicted` [n, 3], body frame, lacks to the gap around the body, metres; its gradient times `scale` and
    /// [`WEIGHT`] is added to g [n, 3].
    pub fn loss(&mut self, predicted: &[f32], scale: f32, g: &mut [f32]) -> f32 {
        let Self { body, cpu, normals, exposed, cloth, push, .. } = self;
        cloth.copy_from_slice(predicted);
        cpu.collide(body, exposed, normals, cloth, push);
        let count = cloth.len() as f32 / 3.0;
        let mut total = 0.0_f64;
        for (push, g) in push.as_chunks::<3>().0.iter().zip(g.as_chunks_mut::<3>().0) {
            let length = push.iter().map(|d| d * d).sum::<f32>().sqrt();
            total += f64::from(length);
            if length > 0.0 {
                (0..3).for_each(|c| g[c] -= WEIGHT * scale * push[c] / (length * count));
            }
        }
        (total / f64::from(count)) as f32
    }
}

/// Poses beyond those simulated: [`mixed`] anew for every step. They teach the skeleton stream: most of what is inside the body is so by its
/// prediction, and a pass of both streams takes some twenty times as long.
pub(super) struct Unlabelled {
    pub recording: Recording,
    character: Character,
    frames: Vec<Pose>,
    seed: u64,
    /// Poses for each step.
    count: usize,
}

impl Unlabelled {
    /// Mixtures of the poses in `samples`; none where there is no body to be inside of, no limbs to mix, or no skeleton stream to learn.
    pub fn new(model: &HostModel, setup: &Setup, samples: &[&Sample], settings: &Settings) -> Result<Option<Self>> {
        let Settings { variant, seed, batch, .. } = *settings;
        if model.body.is_none() || !variant.skeleton {
            return Ok(None);
        }
        let character = setup.character()?;
        let poses = samples.iter().map(|sample| pose(&sample.joints));
        let frames: Vec<Pose> = poses.filter(|pose| is_sound(&character, pose)).collect();
        if frames.is_empty() || !has_limbs(&character) {
            return Ok(None);
        }
        let (recording, ..) = Recording::new(model, variant, Streams::Skeleton);
        Ok(Some(Self { recording, character, frames, seed, count: batch * UNLABELLED }))
    }

    /// The poses for optimisation step `step`, the same ones whenever they are asked for.
    pub fn draw(&self, model: &HostModel, step: usize) -> Result<Vec<Item>> {
        let frames: Vec<&Pose> = self.frames.iter().collect();
        // Other numbers than those of simulated mixtures, which start at nought.
        let first = (self.seed as usize).wrapping_add(1) << 40;
        let item = |i| {
            let pose = mixed(&self.character, &frames, first | (step * self.count + i));
            Item::posed(model, &joints(&pose))
        };
        (0..self.count).into_par_iter().map(item).collect()
    }
}
