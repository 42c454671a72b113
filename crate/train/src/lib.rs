//! Simulated truth, training on it, and judging what was learned.

#![forbid(unsafe_code)]

pub mod body;
pub mod dataset;
pub mod ground_truth;
pub mod judging;
pub mod loss;
pub mod methods;
pub mod report;
mod smoother;
pub mod synthetic;
pub mod training;

pub use ctsn_rig::{Error, Result};
