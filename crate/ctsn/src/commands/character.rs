//! `ctsn character`: one of the project's own characters.

use anyhow::Result;
use ctsn_cast::character;
use ctsn_rig::gltf;
use std::path::PathBuf;

/// Write one of the project's own characters, with its motion, as GLB
#[derive(clap::Args)]
pub struct Arguments {
    #[arg(help = format!("Name of the character: {}", character::names()))]
    name: String,
    /// Where to write it (GLB)
    #[arg(short, long)]
    output: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let character = character::character(&arguments.name)?;
    gltf::write_character(&arguments.output, &character, &gltf::Appearance::default())?;
    super::list_clips(&arguments.output, &character);
    Ok(())
}
