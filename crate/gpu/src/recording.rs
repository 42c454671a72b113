//! A forward pass as data: what is dispatched, on which buffers, in which order.

use crate::cost::Cost;
use ctsn_shaders::Shader;

/// A storage buffer of a dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operand {
    /// A constant of the model.
    Constant(usize),
    /// An intermediate result.
    Activation(usize),
}

/// An intermediate result: rows of `columns` numbers, `stride` numbers apart.
#[derive(Clone, Debug)]
pub(crate) struct Room {
    /// Stage that computes it.
    pub stage: String,
    pub rows: usize,
    pub columns: usize,
    pub stride: usize,
}

impl Room {
    /// What a buffer of this layout holds, without padding.
    pub fn unpad(&self, values: &[f32]) -> Vec<f32> {
        values.chunks_exact(self.stride).flat_map(|row| row[..self.columns].iter().copied()).collect()
    }
}

/// One dispatch.
pub(crate) struct Dispatch {
    pub shader: &'static Shader,
    /// Stage it belongs to.
    pub stage: String,
    /// Uniform buffer.
    pub params: wgpu::Buffer,
    /// Features to hold in workgroup memory, where the shader does so.
    pub room: Option<u32>,
    pub operands: Vec<Operand>,
    /// Workgroups by x and y.
    pub groups: [u32; 2],
    pub cost: Cost,
}
