//! The CPU device: one file per operation, kernels generic over the SIMD level, dispatched once per call.
//! The same source serves AVX2, NEON, wasm simd128 and the scalar level, which is the reference.

pub mod limits;
#[cfg(feature = "threads")]
mod pool;
mod threads;
pub mod vector;

/// The paper's network.
pub mod network {
    pub mod attend;
    pub mod blend;
    pub mod body_frame;
    pub mod diffuse;
    pub mod exp;
    pub mod features;
    pub mod gate;
    pub mod heads;
    pub mod linear;
    pub mod normals;
    pub mod polish;
    pub mod pull;
    pub mod ride;
    pub mod skin;
    pub mod surface;
    pub mod surround;
}

/// The repair of penetration, which comes after it.
pub mod repair {
    pub mod closest;
    pub mod collide;
    pub mod eight;
    pub mod rings;
    pub mod settle;
    pub mod slide;
    pub mod spread;
}

use crate::device::Device;
use crate::operation::Operation;
pub use fearless_simd::Level;
pub use threads::Threads;

/// The CPU: level of SIMD, threads, and scratch space that grows to its final size in the first frame.
pub struct Cpu {
    level: Level,
    threads: Threads,
    /// Of a product, for all threads: weights and bias.
    panels: Vec<f32>,
    /// One for each thread.
    scratch: Vec<Scratch>,
    rings: repair::rings::Rings,
}

/// Room of one thread.
#[derive(Default)]
struct Scratch {
    /// Of a product: a block of its inputs.
    tiles: Vec<f32>,
    attend: network::attend::Scratch,
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
        Self::with_threads(level, Threads::default())
    }

    /// A chosen level on chosen threads.
    pub fn with_threads(level: Level, threads: Threads) -> Self {
        let (panels, rings) = Default::default();
        let scratch = (0..threads.count()).map(|_| Scratch::default()).collect();
        Self { level, threads, panels, scratch, rings }
    }

    /// The threads that operations are shared out over.
    pub fn threads(&self) -> &Threads {
        &self.threads
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
