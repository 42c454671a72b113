//! The page of `ctsn evaluate`: figures, curves, pictures of the worst frames.

pub mod page;
mod pictures;
mod repair;
pub mod training;

pub use pictures::Gallery;
