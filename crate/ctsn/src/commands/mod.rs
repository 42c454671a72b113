//! The commands, one file each: arguments, then the stage that does the work, then what to tell the user.

pub mod bake;
pub mod bench;
pub mod character;
pub mod evaluate;
pub mod export;
pub mod garment;
pub mod inspect;
pub mod motion;
pub mod pack;
pub mod polish;
pub mod predict;
pub mod render;
pub mod sheet;
pub mod simulate;
pub mod split;
pub mod study;
pub mod train;

use anyhow::{Context, Result, bail};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use ctsn_core::model::HostModel;
use ctsn_rig::{Character, Clip, Pose, file};
use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use std::path::Path;
use std::time::Duration;

/// What computes a prediction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Device {
    /// SIMD on this machine's processor
    Cpu,
    /// This machine's GPU, by Vulkan
    Gpu,
}

/// A parser of an argument that is one of `choices`: name, help, value. For types of crates that know no command line.
pub fn one_of<T: Clone + Send + Sync>(choices: &'static [(&str, &str, T)]) -> impl TypedValueParser<Value = T> {
    let names = choices.iter().map(|(name, help, _)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(names).try_map(|found| {
        let choice = choices.iter().find(|(name, ..)| *name == found);
        choice.map(|(.., value)| value.clone()).ok_or("no such choice")
    })
}

/// The pose in the order of a model's joints, which have these names.
pub fn ordered(names: &[String], character: &Character, pose: &Pose) -> Result<Pose> {
    let mut ordered = Vec::new();
    for name in names {
        match character.joint(name) {
            Some(joint) => ordered.push(pose[joint]),
            None => bail!("the model wants joint {name}, the character has no joint of that name"),
        }
    }
    Ok(ordered)
}

/// Reads a model file, naming it in errors.
pub fn model(path: &Path) -> Result<HostModel> {
    HostModel::parse(&file::read(path)?).with_context(|| path.display().to_string())
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

/// Time that is left when `done` of `all` equal steps took `taken`. The bar's own estimate looks back only some
/// seconds: when two steps end together and none for the next ten seconds, it jumps between nothing and days.
pub fn remaining(taken: Duration, done: u64, all: u64) -> HumanDuration {
    HumanDuration(taken.mul_f64(all.saturating_sub(done) as f64 / done.max(1) as f64))
}

/// Tells what was written: joints, triangles, and the clips with their lengths in seconds.
pub fn list_clips(path: &Path, character: &Character) {
    let seconds = |clip: &Clip| (clip.poses.len().max(1) - 1) as f64 / clip.rate;
    let clips = character.clips.iter().map(|clip| format!("{} ({:.1} s)", clip.name, seconds(clip)));
    // Not `sum`, which is -0 for no clips.
    let all = character.clips.iter().map(seconds).fold(0.0, |all, one| all + one);
    println!(
        "{}: {} joints, {} triangles; {} clips, {:.0} s: {}",
        path.display(),
        character.joints.len(),
        character.body.mesh.triangles.len(),
        character.clips.len(),
        all,
        clips.collect::<Vec<_>>().join(", ")
    );
}

/// File name for messages and records, without its folder.
pub fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}
