//! The commands, one file each: arguments, then the stage that does the work, then what to tell the user.

pub mod bake;
pub mod bench;
pub mod character;
pub mod evaluate;
pub mod garment;
pub mod inspect;
pub mod predict;
pub mod render;
pub mod sheet;
pub mod simulate;
pub mod train;

use anyhow::{Context, Result};
use ctsn_author::dataset;
use ctsn_author::train::Architecture;
use ctsn_core::model::HostModel;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::Path;

/// Sizes of the network that are free to choose, for every command that makes one.
#[derive(clap::Args, Clone)]
pub struct Network {
    /// Size of the pose embedding, m
    #[arg(long, default_value_t = 32)]
    embedding: usize,
    /// Mesh basis matrices, k
    #[arg(long, default_value_t = 64)]
    basis: usize,
    /// Graph transformer layers, L
    #[arg(long, default_value_t = 2)]
    layers: usize,
    /// Attention heads, C
    #[arg(long, default_value_t = 4)]
    heads: usize,
    /// Features of a graph layer, F
    #[arg(long, default_value_t = 64)]
    features: usize,
}

impl Network {
    /// The architecture these arguments describe.
    pub fn architecture(&self) -> Architecture {
        let Self { embedding, basis, layers, heads, features } = *self;
        Architecture { embedding, basis, layers, heads, features }
    }
}

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
