//! What a browser shows of an evaluation or a study: one HTML file each.

pub mod bake;
pub mod check;
pub mod evaluation;
mod html;
pub mod study;
