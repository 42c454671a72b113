//! A place where the network runs.

use crate::operation::Operation;

/// What runs operations, at once or later: it owns the buffers that they work on.
pub trait Device {
    /// f32 storage.
    type Buffer;
    /// u32 storage, never changed.
    type Indices;

    /// Runs an operation, or notes it to run it later.
    fn run(&mut self, operation: Operation<&Self::Buffer, &mut Self::Buffer, &Self::Indices>);
}
