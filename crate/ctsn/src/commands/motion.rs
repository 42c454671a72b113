//! `ctsn motion`: generated clips for a character.

use anyhow::Result;
use ctsn_cast::motion;
use ctsn_rig::gltf;
use std::path::PathBuf;

/// Give a character generated clips in place of its own
///
/// The kind of body is told by its joint names, with or without a prefix such as `mixamorig:`. If none fits, the error
/// says which joints were wanted.
#[derive(clap::Args)]
pub struct Arguments {
    /// The character (glTF)
    character: PathBuf,
    /// Poses per second of the clips
    #[arg(long, default_value_t = motion::RATE)]
    rate: f64,
    /// Where to write the character with its new clips (GLB)
    #[arg(short, long)]
    output: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let mut character = gltf::read_character(&arguments.character, motion::RATE)?;
    character.clips = motion::clips(&character, arguments.rate)?;
    gltf::write_character(&arguments.output, &character, &gltf::Appearance::default())?;
    super::list_clips(&arguments.output, &character);
    Ok(())
}
