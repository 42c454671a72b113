//! Garments for any rigged character, and the quasi-static simulator that drapes them.

#![forbid(unsafe_code)]

pub mod garment;
pub mod simulate;
pub mod wrap;

pub use ctsn_rig::{Error, Result};
