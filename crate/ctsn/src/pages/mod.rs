//! What a browser shows of an evaluation or a study: one HTML file each.

pub mod evaluation;
mod html;
pub mod study;
