//! Authoring: rigged character + garment + motion -> quasi-static simulation -> training -> evaluation -> model file.

mod error;
pub mod gltf;
pub mod rig;

pub use error::{Error, Result};
