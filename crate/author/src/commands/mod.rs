//! The commands, one file each: arguments, then the stage that does the work, then what to tell the user.

pub mod bake;
pub mod bench;
pub mod character;
pub mod evaluate;
pub mod garment;
pub mod inspect;
pub mod motion;
pub mod predict;
pub mod render;
pub mod sheet;
pub mod simulate;
pub mod study;
pub mod train;

use anyhow::{Context, Result};
use ctsn_author::dataset;
use ctsn_author::rig::{Character, Clip};
use ctsn_author::train::Architecture;
use ctsn_core::model::HostModel;
use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use std::path::Path;
use std::time::Duration;

/// Sizes of the network that are free to choose, for every command that makes one.
#[derive(clap::Args, Clone)]
pub struct Network {
    /// Size of the pose embedding, m
    #[arg(long, default_value_t = 64)]
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

/// What computes a prediction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Device {
    /// SIMD on this machine's processor
    Cpu,
    /// This machine's GPU, by Vulkan
    Gpu,
}

/// Reads a model file, naming it in errors.
pub fn model(path: &Path) -> Result<HostModel> {
    HostModel::parse(&dataset::read(path)?).with_context(|| path.display().to_string())
}

/// A bar with elapsed and remaining time.
pub fn bar(length: usize, what: &str) -> ProgressBar {
    let style = ProgressStyle::with_template("{prefix:>10} {bar:30} {pos}/{len} {elapsed} + {left} left  {msg}");
    let bar = ProgressBar::new(length as u64).with_prefix(what.to_owned());
    bar.enable_steady_tick(Duration::from_millis(500));
    let left = |state: &ProgressState, text: &mut dyn std::fmt::Write| {
        let left = remaining(state.elapsed(), state.pos(), state.len().unwrap_or_default());
        // A bar that cannot be written is not worth an error.
        let _ = write!(text, "{left}");
    };
    if let Ok(style) = style { bar.with_style(style.with_key("left", left)) } else { bar }
}

/// What is left of a work of `all` like steps when `done` took that long. The bar's own estimate looks back some seconds only: where
/// two steps come at once and none for the next ten seconds, it wavers between nothing and days.
pub fn remaining(taken: Duration, done: u64, all: u64) -> HumanDuration {
    HumanDuration(taken.mul_f64(all.saturating_sub(done) as f64 / done.max(1) as f64))
}

/// Tells what was written: joints, triangles, and the clips with their lengths in seconds.
pub fn list_clips(path: &Path, character: &Character) {
    let seconds = |clip: &Clip| (clip.poses.len().max(1) - 1) as f64 / clip.rate;
    let clips = character.clips.iter().map(|clip| format!("{} ({:.1} s)", clip.name, seconds(clip)));
    println!(
        "{}: {} joints, {} triangles; {} clips, {:.0} s: {}",
        path.display(),
        character.joints.len(),
        character.body.triangles.len(),
        character.clips.len(),
        character.clips.iter().map(seconds).sum::<f64>(),
        clips.collect::<Vec<_>>().join(", ")
    );
}

/// File name for messages and records, without its folder.
pub fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}
