//! ctsn-gpu: the forward pass of `ctsn_core::network`, recorded once as WGSL dispatches and replayed each frame, by
//! wgpu: WebGPU in the browser, Vulkan natively.
//!
//! [`Gpu`] (a device, ours or lent) -> [`Model`] (weights and recorded frames, shared) -> [`Predictor`] (one cloth).

#![forbid(unsafe_code)]
// Natively clones are handed to other threads. In a browser there is one thread, and wgpu's objects are bound to it.
#![cfg_attr(target_arch = "wasm32", allow(clippy::arc_with_non_send_sync))]

mod cost;
mod error;
mod evaluate;
mod gpu;
mod model;
mod pack;
mod predictor;
mod read;
mod recorder;
mod recording;
mod timestamps;

pub use cost::{Cost, Stage};
pub use error::{Error, Result};
pub use evaluate::evaluate;
pub use gpu::Gpu;
pub use model::Model;
pub use predictor::{Prediction, Predictor};
pub use wgpu;
