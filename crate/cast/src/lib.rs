//! The project's own characters, and motion for any skeleton.

#![forbid(unsafe_code)]

pub mod character;
pub mod motion;

pub use ctsn_rig::{Error, Result};
