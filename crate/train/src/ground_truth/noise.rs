//! Noise floor: how far the truth moves when the pose hardly does. A twin is a pose with every joint turned by half a
//! degree. The truths of pose and twin are compared, and so are their plain skinnings: what the turn itself explains.

use crate::Result;
use crate::dataset::{Dataset, Sample, paths, pose_path};
use crate::judging::differences;
use ctsn_rig::mixed::turn;
use ctsn_rig::path::to_body_frame;
use ctsn_rig::statistics::Sorted;
use ctsn_rig::{Character, Mesh, Pose, SkinnedMesh, pose, vertices};
use serde::Serialize;
use std::path::Path;

/// Turn of every joint of a twin, degrees.
pub const DEGREES: f64 = 0.5;

/// Differences between poses and their twins, over the pairs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Mean vertex distance, mm: mean, 95th percentile and greatest over the pairs.
    pub distance: [f64; 3],
    /// Mean angle between vertex normals, degrees: mean, 95th percentile and greatest over the pairs.
    pub normal: [f64; 3],
}

/// The noise floor of a dataset.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NoiseFloor {
    /// Turn of every joint, degrees.
    pub degrees: f64,
    /// Pairs compared.
    pub pairs: usize,
    /// Pairs left out because the pose or its twin did not converge.
    pub left_out: usize,
    /// Between the truths.
    pub truth: Difference,
    /// Between plain skinnings of the rest cloth.
    pub skinning: Difference,
}

/// The twin of a pose: every joint turned by [`DEGREES`] against its parent, about an axis drawn from clip, frame and
/// joint.
pub(super) fn turned(character: &Character, pose: &Pose, clip: usize, frame: usize) -> Pose {
    let mut rng = fastrand::Rng::with_seed(((clip as u64) << 32) + frame as u64);
    let mut twin = Pose::with_capacity(pose.len());
    for (joint, world) in character.joints.iter().zip(pose) {
        let moved = joint.parent.map_or(*world, |parent| twin[parent] * pose[parent].inverse() * *world);
        twin.push(moved * turn(&mut rng, DEGREES.to_radians()));
    }
    twin
}

/// Compares the twins of dataset `folder` with their poses; `None` when there is no pair.
pub fn noise_floor(dataset: &Dataset, folder: &Path) -> Result<Option<NoiseFloor>> {
    let twins = paths(&folder.join("twins"))?;
    let setup = &dataset.setup;
    let weights = setup.nearest()?.into_iter().map(|nearest| setup.body_weights[nearest].clone());
    let character = setup.character()?;
    let mesh = Mesh { positions: vertices(&setup.template), ..Mesh::default() };
    let cloth = SkinnedMesh { mesh, weights: weights.collect() };
    let skinned = |sample: &Sample| cloth.pose(&character.skinning(&to_body_frame(&character, &pose(&sample.joints))));
    let (mut truth, mut skinning, mut left_out) = (Vec::new(), Vec::new(), 0);
    for path in &twins {
        let twin = Sample::read(path, character.joints.len(), cloth.weights.len())?;
        let place = (twin.record.clip, twin.record.frame);
        let found = dataset.samples.binary_search_by_key(&place, |sample| (sample.record.clip, sample.record.frame));
        match found {
            Ok(index) if twin.record.rejected.is_none() => {
                let sample = &dataset.samples[index];
                let pair = [sample, &twin].map(|sample| vertices(&sample.truth));
                truth.push(differences(&pair[0], &pair[1], &setup.triangles));
                skinning.push(differences(&skinned(sample), &skinned(&twin), &setup.triangles));
            }
            // Its pose may be missing while shards are missing.
            Err(_) if !pose_path(folder, place.0, place.1).exists() => (),
            _ => left_out += 1,
        }
    }
    let floor = NoiseFloor {
        degrees: DEGREES,
        pairs: truth.len(),
        left_out,
        truth: Difference::over(&truth),
        skinning: Difference::over(&skinning),
    };
    Ok(Some(floor).filter(|floor| floor.pairs + floor.left_out > 0))
}

impl Difference {
    /// From metres and degrees per pair.
    fn over(pairs: &[(f64, f64)]) -> Self {
        let summary = |values: Sorted| [values.mean(), values.percentile(95), values.greatest()];
        Self {
            distance: summary(Sorted::new(pairs.iter().map(|pair| 1e3 * pair.0))),
            normal: summary(Sorted::new(pairs.iter().map(|pair| pair.1))),
        }
    }
}
