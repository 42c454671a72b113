//! `ctsn polish`: how much a trained model's cloth is polished.

use super::{file_name, model};
use anyhow::{Result, bail};
use ctsn_core::file::{Dtype, Tensors};
use ctsn_core::model::{Cut, HostModel, MOST_STEPS, SKELETON_BASIS, STEPS, Storage};
use ctsn_rig::file;
use ctsn_train::dataset::Dataset;
use ctsn_train::judging::check_same;
use std::path::PathBuf;

/// Give a trained model the lengths its garment was cut to, and say by how many steps its cloth takes them back
///
/// What a network learns is smooth: its folds are there as compression. After each prediction some steps let every edge
/// ask for its own length, and the folds come out. `ctsn train` does this with 16 steps; here a model of an older
/// version gets them, or any model another number. `ctsn evaluate` shows the difference.
#[derive(clap::Args)]
pub struct Arguments {
    /// Model file (safetensors)
    pub model: PathBuf,
    /// A dataset of the same garment, as `ctsn simulate` leaves it
    pub dataset: PathBuf,
    /// Steps; 0 is none. A finer mesh needs more
    #[arg(long, default_value_t = STEPS, value_parser = steps)]
    pub steps: usize,
    /// Model file to write
    #[arg(short, long)]
    pub output: PathBuf,
}

fn steps(text: &str) -> Result<usize, String> {
    let found = text.parse().ok().filter(|steps| *steps <= MOST_STEPS);
    found.ok_or_else(|| format!("wanted a number of steps from 0 to {MOST_STEPS}, found {text}"))
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let Arguments { dataset, output, steps, .. } = arguments;
    let bytes = file::read(&arguments.model)?;
    let (model, Dataset { setup, .. }) = (model(&arguments.model)?, Dataset::read(dataset)?);
    check_same(&model, &setup)?;
    let cut = (*steps > 0).then(|| Cut::new(setup.garment.clone(), &model.graph, *steps)).transpose()?;
    // Learned tensors stay as they are stored.
    let basis = Tensors::parse(&bytes)?.tensors.remove(SKELETON_BASIS).map(|basis| basis.dtype);
    let storage = match basis {
        Some(Dtype::F16) => Storage::F16,
        Some(Dtype::F32) | None => Storage::F32,
        Some(_) => bail!("{}: is packed; polish the model that it was made of, then pack", arguments.model.display()),
    };
    let bytes = HostModel { cut, ..model }.to_bytes(storage);
    file::write(output, &bytes)?;
    println!("{}: {steps} steps, {} bytes", file_name(output), bytes.len());
    Ok(())
}
