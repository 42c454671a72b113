//! ctsn-core: the two-stream network of the paper CTSN, from model file and pose to cloth. No I/O, no platform code.
//!
//! `Model` (weights) + `BodyFrame` (pose) -> `network::forward` over a `Device` -> positions. `Predictor` ties them for
//! the CPU.

#![cfg_attr(not(feature = "threads"), forbid(unsafe_code))]
// Allowed in `cpu/pool.rs` alone.
#![deny(unsafe_code)]

#[macro_use]
pub mod operation;

pub mod confidence;
pub mod cpu;
pub mod device;
mod error;
pub mod file;
pub mod model;
pub mod network;
pub mod pose;
mod predictor;
#[cfg(feature = "suite")]
pub mod suite;
pub mod topology;

pub use confidence::Confidence;
pub use error::{Error, Result};
pub use network::Streams;
pub use predictor::{Folds, Predictor, Shares};
