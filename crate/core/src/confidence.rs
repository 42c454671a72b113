//! How far a pose leaves the poses seen in training, and what the network's residuals are worth there: all of it among them, nothing far
//! away, where the cloth is skinned plainly. The paper (§ Limitations) leaves such poses open.

use crate::model::{HostModel, Skin};
use crate::pose::{BodyFrame, Range, Rig};
use glam::{Vec3, Vec4};

/// Excess up to which the residuals count in full, and from which on they count for nothing, in units of the garment's size.
/// Between the two the cloth goes over from folds to plain skinning without a jump. By measurement on a T-shirt: unseen clips stay below
/// 0.05; single joints turned further and further stretch the network's cloth more than plain skinning does from 0.3 to 0.4 on.
const TRUST: f32 = 0.1;
const DOUBT: f32 = 0.5;

/// What a pose's confidence is reckoned from.
#[derive(Clone, Debug)]
pub struct Confidence {
    range: Range,
    /// Joints that carry what the cloth may touch.
    levers: Vec<Lever>,
    /// Root mean square distance of the cloth from its centre, metres, positive.
    size: f32,
    frame: BodyFrame,
}

/// What a joint carries.
#[derive(Clone, Copy, Debug, Default)]
struct Lever {
    joint: usize,
    /// Share of all that is carried.
    share: f32,
    /// Its centre in canonical space, metres.
    centre: Vec3,
}

impl Confidence {
    /// For `model`; `None` where it does not say which poses it has seen.
    pub fn new(model: &HostModel) -> Option<Self> {
        let range = model.rig.range.clone()?;
        let joints = model.sizes.joints;
        // What the cloth may touch tells more than what lies under it: an obstacle carries no cloth.
        let levers = match &model.body {
            Some(body) => levers(&body.rest, &body.skin, joints),
            None => levers(&model.reference.rest, &model.reference.skin, joints),
        };
        let points = || model.rest.as_chunks::<3>().0.iter().map(|point| Vec3::from_array(*point));
        let count = points().count() as f32;
        let centre = points().sum::<Vec3>() / count;
        let size = (points().map(|point| point.distance_squared(centre)).sum::<f32>() / count).sqrt();
        Some(Self { range, levers, size: size.max(f32::MIN_POSITIVE), frame: BodyFrame::new(joints) })
    }

    /// Joint world transforms [J, 3, 4] -> 1 among the poses seen, 0 far from them.
    pub fn of(&mut self, rig: &Rig, joints: &[f32]) -> f32 {
        crate::cpu::body_frame::body_frame(rig, joints, &mut self.frame.transforms, &mut self.frame.vector);
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
fn levers(points: &[f32], skin: &Skin<Vec<f32>, Vec<u32>>, joints: usize) -> Vec<Lever> {
    let mut levers: Vec<Lever> = (0..joints).map(|joint| Lever { joint, ..Lever::default() }).collect();
    let total: f32 = skin.weights.iter().sum();
    let rows = skin.joints.chunks_exact(skin.width).zip(skin.weights.chunks_exact(skin.width));
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

/// 0 up to 0, 1 from 1 on, smooth between; 1 for what is no number.
fn smoothstep(x: f32) -> f32 {
    let x = if x.is_nan() { 1.0 } else { x.clamp(0.0, 1.0) };
    x * x * (3.0 - 2.0 * x)
}
