//! Authoring: rigged character + garment + motion -> quasi-static simulation -> training -> evaluation -> model file.

pub mod body;
pub mod character;
pub mod dataset;
mod error;
pub mod evaluate;
pub mod garment;
pub mod gltf;
pub mod ground_truth;
mod html;
pub mod motion;
pub mod render;
pub mod report;
pub mod rig;
pub mod simulate;
pub mod study;
pub mod synthetic;
pub mod train;
mod triangle;

pub use error::{Error, Result};
