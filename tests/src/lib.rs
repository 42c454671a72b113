//! What the tests across packages share: golden files and the checks against them, the same natively and in the
//! browser.

#![forbid(unsafe_code)]

pub mod finite;
pub mod golden;
pub mod layered;
pub mod nested;
pub mod random;
pub mod sphere;
#[cfg(not(target_arch = "wasm32"))]
pub mod tree;
