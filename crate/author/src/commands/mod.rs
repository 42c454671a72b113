//! The commands, one file each: arguments, then the stage that does the work, then what to tell the user.

pub mod bake;
pub mod bench;
pub mod character;
pub mod evaluate;
pub mod garment;
pub mod inspect;
pub mod predict;
pub mod render;
pub mod simulate;
pub mod train;

use anyhow::{Context, Result};
use ctsn_author::dataset;
use ctsn_core::model::HostModel;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::Path;

/// Reads a model file, naming it in errors.
pub fn model(path: &Path) -> Result<HostModel> {
    HostModel::parse(&dataset::read(path)?).with_context(|| path.display().to_string())
}

/// A bar with elapsed and remaining time.
pub fn bar(length: usize, what: &str) -> ProgressBar {
    let style = ProgressStyle::with_template("{prefix:>10} {bar:30} {pos}/{len} {elapsed} + {eta} left  {msg}");
    let bar = ProgressBar::new(length as u64).with_prefix(what.to_owned());
    bar.enable_steady_tick(std::time::Duration::from_millis(500));
    if let Ok(style) = style { bar.with_style(style) } else { bar }
}

/// File name for messages and records, without its folder.
pub fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}
