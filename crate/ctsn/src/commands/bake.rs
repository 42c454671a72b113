//! `ctsn bake`: simulate, train and evaluate in one go.

use super::{evaluate, file_name, garment, simulate, train};
use anyhow::{Context, Result, ensure};
use ctsn_cloth::garment::Cut;
use ctsn_rig::file::{read, write};
use ctsn_train::ground_truth::Shard;
use std::path::{Path, PathBuf};

/// Character and garment in, model out: simulate → train → evaluate
///
/// Intermediate results are kept in a folder beside the model (MODEL.work), from which an interrupted bake continues.
#[derive(clap::Args)]
pub struct Arguments {
    /// Rigged character (glTF)
    character: PathBuf,
    /// Garment, worn in the character's canonical pose (glTF). Without one, a garment is made as `ctsn garment` does
    #[arg(conflicts_with = "Cut")]
    garment: Option<PathBuf>,
    /// Model file to write (safetensors)
    #[arg(short, long)]
    output: PathBuf,
    #[command(flatten, next_help_heading = "Garment, where none is given")]
    cut: Cut,
    #[command(flatten, next_help_heading = "Simulation")]
    options: simulate::Options,
    #[command(flatten, next_help_heading = "Training")]
    training: train::Training,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let Arguments { character, garment, output, cut, options, training } = arguments;
    let dataset = output.with_extension("work");
    let garment = match garment {
        Some(garment) => garment.clone(),
        None => generated(character, cut, &dataset)?,
    };
    simulate::run(&simulate::Arguments {
        character: character.clone(),
        garment,
        output: dataset.clone(),
        shard: Shard::WHOLE,
        options: options.clone(),
    })?;
    train::run(&train::Arguments { dataset: dataset.clone(), output: output.clone(), training: training.clone() })?;
    let json = Some(output.with_extension("report.json"));
    evaluate::run(&evaluate::Arguments { model: output.clone(), dataset, json, html: None })
}

/// The garment that `ctsn garment` makes. It is made once and kept beside the dataset, with a note of how it was cut.
fn generated(character: &Path, cut: &Cut, dataset: &Path) -> Result<PathBuf> {
    let [path, note] = ["garment.glb", "garment.txt"].map(|name| dataset.join(name));
    let wanted = format!("{} {}", file_name(character), serde_json::to_string(cut)?);
    if !path.exists() {
        std::fs::create_dir_all(dataset).with_context(|| dataset.display().to_string())?;
        write(&note, wanted.as_bytes())?;
        garment::make(character, cut, &path)?;
    }
    // An older version left no note.
    if note.exists() {
        let found = String::from_utf8_lossy(&read(&note)?).into_owned();
        let what = "holds poses of another garment; name another --output, or delete this folder";
        ensure!(found == wanted, "{}: {what}: wanted {wanted}, found {found}", dataset.display());
    }
    Ok(path)
}
