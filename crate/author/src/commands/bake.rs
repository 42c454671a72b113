//! `ctsn bake`: simulate, train and evaluate in one go.

use super::{evaluate, simulate, train};
use anyhow::Result;
use std::path::PathBuf;

/// Character and garment in, model out: simulate → train → evaluate
///
/// What the steps leave behind stands in a folder beside the model (MODEL.work), so an interrupted bake goes on where it stopped.
#[derive(clap::Args)]
pub struct Arguments {
    /// Rigged character (glTF)
    character: PathBuf,
    /// Garment, worn in the character's canonical pose (glTF)
    garment: PathBuf,
    /// Model file to write (safetensors)
    #[arg(short, long)]
    output: PathBuf,
    #[command(flatten)]
    motion: simulate::Motion,
    #[command(flatten)]
    settings: train::Settings,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let Arguments { character, garment, output, motion, settings } = arguments;
    let dataset = output.with_extension("work");
    simulate::run(&simulate::Arguments {
        character: character.clone(),
        garment: garment.clone(),
        output: dataset.clone(),
        motion: motion.clone(),
    })?;
    train::run(&train::Arguments { dataset: dataset.clone(), output: output.clone(), settings: settings.clone() })?;
    evaluate::run(&evaluate::Arguments { model: output.clone(), dataset, report: None })
}
