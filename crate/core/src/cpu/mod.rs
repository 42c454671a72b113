//! The CPU device: one file per operation, kernels generic over the SIMD level, dispatched once per call.
//! The same source serves AVX2, NEON, wasm simd128 and the scalar level, which is the reference.

pub mod limits;
pub mod vector;

/// The paper's network.
pub mod network {
    pub mod attend;
    pub mod blend;
    pub mod body_frame;
    pub mod exp;
    pub mod features;
    pub mod gate;
    pub mod heads;
    pub mod linear;
    pub mod normals;
    pub mod polish;
    pub mod skin;
    pub mod surface;
}

/// The repair of penetration, which comes after it.
pub mod repair {
    pub mod bury;
    pub mod closest;
    pub mod collide;
    pub mod eight;
    pub mod rings;
    pub mod settle;
    pub mod spread;
}

use crate::device::Device;
use crate::operation::Operation;
pub use fearless_simd::Level;

/// The CPU: level of SIMD and scratch space that grows to its final size in the first frame.
pub struct Cpu {
    level: Level,
    linear: network::linear::Scratch,
    attend: network::attend::Scratch,
    rings: repair::rings::Rings,
    dipoles: repair::bury::Dipoles,
}

/// An operation on slices: what each file of `network` and `repair` named as an operation implements.
trait Kernel {
    fn run(self, cpu: &mut Cpu);
}

impl Cpu {
    /// The best level this machine has.
    pub fn new() -> Self {
        Self::with_level(Level::new())
    }

    /// A chosen level.
    pub fn with_level(level: Level) -> Self {
        let (linear, attend, rings, dipoles) = Default::default();
        Self { level, linear, attend, rings, dipoles }
    }

    /// Runs an operation on slices.
    pub fn compute<'a>(&mut self, operation: impl Into<Operation<&'a [f32], &'a mut [f32], &'a [u32]>>) {
        each!(operation.into(), operation => operation.run(self));
    }
}

impl Default for Cpu {
    fn default() -> Self {
        Self::new()
    }
}

impl Device for Cpu {
    type Buffer = Vec<f32>;
    type Indices = Vec<u32>;

    fn run(&mut self, operation: Operation<&Vec<f32>, &mut Vec<f32>, &Vec<u32>>) {
        self.compute(operation.map(Vec::as_slice, Vec::as_mut_slice, Vec::as_slice));
    }
}
