//! `ctsn sheet`: what a dataset looks like, for people to judge.

use crate::pictures::{self, Poses};
use anyhow::Result;
use ctsn_rig::file::write;
use ctsn_rig::gltf;
use ctsn_train::dataset::Dataset;
use std::path::PathBuf;

/// Draw a contact sheet of a dataset: twelve kept poses, front and back
#[derive(clap::Args)]
pub struct Arguments {
    /// Dataset folder
    dataset: PathBuf,
    /// The character it was simulated on (glTF)
    character: PathBuf,
    /// Show mixed poses instead of frames
    #[arg(long)]
    mixed: bool,
    /// Show frames that were left out instead of those that were kept
    #[arg(long, conflicts_with = "mixed")]
    left_out: bool,
    /// Where to write the picture (PNG)
    #[arg(short, long)]
    output: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let dataset = Dataset::read(&arguments.dataset)?;
    let character = gltf::read_character(&arguments.character, dataset.setup.description.rate)?;
    let poses = match arguments {
        Arguments { mixed: true, .. } => Poses::Mixed,
        Arguments { left_out: true, .. } => Poses::LeftOut,
        _ => Poses::Kept,
    };
    let picture = pictures::sheet(&arguments.dataset, &dataset, &character, poses)?;
    let path = &arguments.output;
    write(path, &pictures::png(&picture)?)?;
    println!("{}", path.display());
    Ok(())
}
