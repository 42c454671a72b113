//! Joints -> body frame `N·A` and pose vector γ. network.md §1. Computed in f64: J matrices cost nothing.

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
        self.fill(|j| std::array::from_fn(|e| f64::from(joints[12 * j + e])), out);
        Ok(())
    }

    /// The same from 4×4 column-major matrices [J, 16], as three.js and glTF keep them.
    pub fn body_frame_column_major(&self, joints: &[f32], out: &mut BodyFrame) -> Result<()> {
        self.check(joints, 16)?;
        self.fill(|j| std::array::from_fn(|e| f64::from(joints[16 * j + e % 4 * 4 + e / 4])), out);
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

    fn fill(&self, joint: impl Fn(usize) -> [f64; 12], out: &mut BodyFrame) {
        let skinning = |j: usize| multiply(&joint(j), &self.inverse_bind[j].map(f64::from));
        let (hip, a) = (joint(self.root), skinning(self.root));
        let heading = match self.frame {
            Frame::HipYaw => (a[2] - a[8]).atan2(a[0] + a[10]),
            Frame::Hip => 0.0,
        };
        let (sin, cos) = heading.sin_cos();
        let [x, y, z] = [hip[3], hip[7], hip[11]];
        // N: translate by -p, then rotate by -ψ about +Y.
        let into = [cos, 0.0, -sin, sin * z - cos * x, 0.0, 1.0, 0.0, -y, sin, 0.0, cos, -sin * x - cos * z];
        let back = [cos, 0.0, sin, x, 0.0, 1.0, 0.0, y, -sin, 0.0, cos, z];
        let (transforms, last) = out.transforms.split_at_mut(12 * self.joints.len());
        for (j, transform) in transforms.as_chunks_mut::<12>().0.iter_mut().enumerate() {
            *transform = multiply(&into, &skinning(j)).map(|value| value as f32);
        }
        last.copy_from_slice(&back.map(|value| value as f32));
        for (i, value) in out.vector.iter_mut().enumerate() {
            *value = (transforms[i] - self.mean[i]) / self.std[i];
        }
    }
}

/// Product of two 3×4 transforms.
fn multiply(a: &[f64; 12], b: &[f64; 12]) -> [f64; 12] {
    std::array::from_fn(|e| {
        let (row, column) = (e / 4, e % 4);
        let offset = if column == 3 { a[4 * row + 3] } else { 0.0 };
        (0..3).map(|i| a[4 * row + i] * b[4 * i + column]).sum::<f64>() + offset
    })
}
