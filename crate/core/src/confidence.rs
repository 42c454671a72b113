//! How far a pose lies outside the poses seen in training, and how much the network's residuals count there: in full
//! among the seen poses, not at all far away, where the garment at rest is skinned with the learned weights. The paper
//! (§ Limitations) leaves this open.

use crate::model::{HostModel, Skinning};
use crate::pose::{BodyFrame, Range, Rig};
use glam::{Vec3, Vec4};

/// Up to the excess TRUST the residuals count in full, from DOUBT on they count for nothing; in units of the garment's
/// size. Between the two, the cloth goes over from folds to that skinning without a jump. Measured on a T-shirt: in
/// unseen clips the excess stays below 0.05; when single joints are turned further and further, the network's cloth is
/// stretched more than plainly skinned cloth from 0.3 to 0.4 on.
pub const TRUST: f32 = 0.1;
/// See [`TRUST`].
pub const DOUBT: f32 = 0.5;

/// What the confidence in a pose is computed from.
#[derive(Clone, Debug)]
pub struct Confidence {
    range: Range,
    /// Joints that carry what the cloth may touch.
    pub levers: Vec<Lever>,
    /// Root mean square distance of the cloth from its centre, metres, positive.
    pub size: f32,
    frame: BodyFrame,
}

/// What a joint carries.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lever {
    /// Which joint.
    pub joint: usize,
    /// Share of all that is carried.
    pub share: f32,
    /// Its centre in canonical space, metres.
    pub centre: Vec3,
}

impl Confidence {
    /// For `model`; `None` where it does not say which poses it has seen.
    pub fn new(model: &HostModel) -> Option<Self> {
        let range = model.rig.range.clone()?;
        let joints = model.sizes.joints;
        // The body that cloth may touch, not what lies under the cloth: an obstacle carries no cloth.
        let levers = match &model.body {
            Some(body) => levers(&body.rest, &body.skinning, joints),
            None => levers(&model.reference.rest, &model.reference.skinning, joints),
        };
        let points = || model.rest.as_chunks::<3>().0.iter().map(|point| Vec3::from_array(*point));
        let count = points().count() as f32;
        let centre = points().sum::<Vec3>() / count;
        let size = (points().map(|point| point.distance_squared(centre)).sum::<f32>() / count).sqrt();
        Some(Self { range, levers, size: size.max(f32::MIN_POSITIVE), frame: BodyFrame::new(joints) })
    }

    /// Joint world transforms [J, 3, 4] -> 1 among the poses seen, 0 far from them.
    pub fn of(&mut self, rig: &Rig, joints: &[f32]) -> f32 {
        crate::cpu::network::body_frame::body_frame(rig, joints, &mut self.frame.transforms, &mut self.frame.vector);
        let excess = self.levers.iter().map(|lever| lever.share * self.excess(lever)).sum::<f32>().sqrt();
        1.0 - smoothstep((excess / self.size - TRUST) / (DOUBT - TRUST))
    }

    /// Square of the way by which a joint carries its lever beyond the place where the nearest transform seen would.
    fn excess(&self, lever: &Lever) -> f32 {
        let row = |row: usize| {
            let row = 3 * lever.joint + row;
            let numbers: [f32; 4] = std::array::from_fn(|e| self.frame.transforms[4 * row + e]);
            let beyond = Vec4::from(numbers) - Vec4::from(self.range.nearest(row, numbers));
            beyond.dot(lever.centre.extend(1.0))
        };
        Vec3::new(row(0), row(1), row(2)).length_squared()
    }
}

/// What each joint carries of the points [n, 3].
fn levers(points: &[f32], skinning: &Skinning<Vec<f32>, Vec<u32>>, joints: usize) -> Vec<Lever> {
    let mut levers: Vec<Lever> = (0..joints).map(|joint| Lever { joint, ..Lever::default() }).collect();
    let total: f32 = skinning.weights.iter().sum();
    let rows = skinning.joints.chunks_exact(skinning.width).zip(skinning.weights.chunks_exact(skinning.width));
    for (point, (joints, weights)) in points.as_chunks::<3>().0.iter().zip(rows) {
        for (joint, weight) in joints.iter().zip(weights) {
            let lever = &mut levers[*joint as usize];
            lever.share += weight / total;
            lever.centre += weight / total * Vec3::from_array(*point);
        }
    }
    levers.retain(|lever| lever.share > 0.0);
    levers.iter_mut().for_each(|lever| lever.centre /= lever.share);
    levers
}

/// 0 below 0, 1 above 1, smooth between; 1 for NaN.
fn smoothstep(x: f32) -> f32 {
    let x = if x.is_nan() { 1.0 } else { x.clamp(0.0, 1.0) };
    x * x * (3.0 - 2.0 * x)
}
