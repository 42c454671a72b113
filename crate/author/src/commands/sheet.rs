//! `ctsn sheet`: what a dataset looks like, for people to judge.

use anyhow::{Context, Result};
use ctsn_author::dataset::Dataset;
use ctsn_author::{gltf, render};
use std::path::PathBuf;

/// Draw a contact sheet of a dataset: twelve kept poses, front and back
#[derive(clap::Args)]
pub struct Arguments {
    /// Dataset folder
    dataset: PathBuf,
    /// The character it was simulated on (glTF)
    character: PathBuf,
    /// Of its mixed poses
    #[arg(long)]
    mixed: bool,
    /// Where to write the picture (PNG)
    #[arg(short, long)]
    output: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let dataset = Dataset::read(&arguments.dataset)?;
    let character = gltf::read_character(&arguments.character, dataset.setup.description.rate)?;
    let picture = render::sheet(&dataset, &character, arguments.mixed)?;
    let path = &arguments.output;
    picture.save_with_format(path, image::ImageFormat::Png).with_context(|| path.display().to_string())?;
    println!("{}", path.display());
    Ok(())
}
