//! Authoring: rigged character + garment + motion -> quasi-static simulation -> training -> evaluation -> model file.

mod error;
pub mod rig;
pub mod simulate;

pub use error::{Error, Result};
