//! Authoring: rigged character + garment + motion -> quasi-static simulation -> training -> evaluation -> model file.

pub mod dataset;
mod error;
pub mod garment;
pub mod gltf;
pub mod rig;
pub mod simulate;
pub mod train;

pub use error::{Error, Result};
