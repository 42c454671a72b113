//! A skeleton as the network needs it, and the checks a pose must pass. network.md §1.

use crate::cpu::body_frame::body_frame;
use crate::{Error, Result};

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
            Some(element) => Err(Error::NotFinite { what: "pose".to_owned(), element, found: joints[element] }),
            None => Ok(()),
        }
    }
}
