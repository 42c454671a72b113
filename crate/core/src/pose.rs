//! A skeleton as the network needs it, and the checks a pose must pass. network.md §1.

use crate::cpu::network::body_frame::body_frame;
use crate::{Error, Result};
use glam::{Mat3, Vec3};

/// 3×4 transform, row-major.
pub type Transform = [f32; 12];

/// What the body frame takes out of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// Translation and heading of the hip.
    HipYaw,
    /// Translation of the hip only, as the paper does.
    Hip,
}

/// The skeleton as the network needs it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// What the body frame takes out.
    pub frame: Frame,
    /// Index of the hip.
    pub root: usize,
    /// Joint names.
    pub joints: Vec<String>,
    /// `B_j⁻¹`.
    pub inverse_bind: Vec<Transform>,
    /// Mean of the pose vector [12J].
    pub mean: Vec<f32>,
    /// Standard deviation of the pose vector [12J].
    pub std: Vec<f32>,
    /// Which poses were seen in training, where the file says so.
    pub range: Option<Range>,
}

/// The poses seen in training: least and greatest numbers of the transforms `N·A_j`, by rows of the linear part and the
/// joint's own position. Beyond them the pose vector is clamped. (A transform's translation is where it carries the
/// origin, which may be far from the joint: clamped apart from the rotation it tore the joint away.)
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// Least [J, 3, 4].
    pub min: Vec<f32>,
    /// Greatest [J, 3, 4].
    pub max: Vec<f32>,
    /// Where the joints are in canonical space, metres [J].
    pub origins: Vec<Vec3>,
}

impl Range {
    /// A range [J, 3, 4] of joints with these inverse binds.
    pub fn new(inverse_bind: &[Transform], min: Vec<f32>, max: Vec<f32>) -> Self {
        Self { min, max, origins: inverse_bind.iter().map(origin).collect() }
    }

    /// The range of `frames`' transforms; `None` of none.
    pub fn of(inverse_bind: &[Transform], frames: &[BodyFrame]) -> Option<Self> {
        let count = 12 * inverse_bind.len();
        let (min, max) = (vec![f32::INFINITY; count], vec![f32::NEG_INFINITY; count]);
        let mut range = Self::new(inverse_bind, min, max);
        for frame in frames {
            for (row, numbers) in frame.transforms[..count].as_chunks::<4>().0.iter().enumerate() {
                for (e, number) in (4 * row..).zip(range.placed(row, *numbers)) {
                    range.min[e] = range.min[e].min(number);
                    range.max[e] = range.max[e].max(number);
                }
            }
        }
        (!frames.is_empty()).then_some(range)
    }

    /// Row `row` of the transforms, or the nearest one seen.
    pub fn nearest(&self, row: usize, numbers: [f32; 4]) -> [f32; 4] {
        let placed = self.placed(row, numbers);
        let near: [f32; 4] = std::array::from_fn(|e| placed[e].max(self.min[4 * row + e]).min(self.max[4 * row + e]));
        if near == placed {
            return numbers;
        }
        let [x, y, z, place] = near;
        [x, y, z, place - Vec3::new(x, y, z).dot(self.origins[row / 3])]
    }

    /// Linear part of a row and the joint's position in place of the translation.
    fn placed(&self, row: usize, [x, y, z, offset]: [f32; 4]) -> [f32; 4] {
        [x, y, z, offset + Vec3::new(x, y, z).dot(self.origins[row / 3])]
    }
}

/// Where the joint of an inverse bind is in canonical space; the origin where it cannot be inverted.
fn origin(bind: &Transform) -> Vec3 {
    let row = |row: usize| Vec3::from_slice(&bind[4 * row..]);
    let inverse = Mat3::from_cols(row(0), row(1), row(2)).transpose().inverse();
    let origin = inverse * -Vec3::new(bind[3], bind[7], bind[11]);
    if origin.is_finite() { origin } else { Vec3::ZERO }
}

/// One pose as the devices see it.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyFrame {
    /// `N·A_j` per joint, then `N⁻¹`: [J + 1, 3, 4].
    pub transforms: Vec<f32>,
    /// Standardised pose vector [12J].
    pub vector: Vec<f32>,
}

impl BodyFrame {
    /// Room for a pose of `joints` joints.
    pub fn new(joints: usize) -> Self {
        Self { transforms: vec![0.0; 12 * (joints + 1)], vector: vec![0.0; 12 * joints] }
    }
}

impl Rig {
    /// Joint world transforms `G_j` [J, 3, 4], row-major, metres -> body frame and pose vector.
    pub fn body_frame(&self, joints: &[f32], out: &mut BodyFrame) -> Result<()> {
        self.check(joints, 12)?;
        body_frame(self, joints, &mut out.transforms, &mut out.vector);
        Ok(())
    }

    /// The transforms of a pose [J, 3, 4], row-major, as the devices read them: checked and copied.
    pub fn read(&self, joints: &[f32], out: &mut [f32]) -> Result<()> {
        self.check(joints, 12)?;
        out.copy_from_slice(joints);
        Ok(())
    }

    /// The same from 4×4 column-major matrices [J, 16], as three.js and glTF keep them.
    pub fn read_column_major(&self, joints: &[f32], out: &mut [f32]) -> Result<()> {
        self.check(joints, 16)?;
        for (joint, out) in joints.as_chunks::<16>().0.iter().zip(out.as_chunks_mut::<12>().0) {
            *out = std::array::from_fn(|e| joint[e % 4 * 4 + e / 4]);
        }
        Ok(())
    }

    fn check(&self, joints: &[f32], stride: usize) -> Result<()> {
        let count = self.joints.len();
        if joints.len() != stride * count {
            return Err(Error::JointCount { wanted: stride * count, joints: count, found: joints.len() });
        }
        match joints.iter().position(|value| !value.is_finite()) {
            Some(element) => {
                let what = format!("pose, joint {}", self.joints[element / stride]);
                Err(Error::NotFinite { what, element, found: joints[element] })
            }
            None => Ok(()),
        }
    }
}
