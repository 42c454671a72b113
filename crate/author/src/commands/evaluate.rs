//! `ctsn evaluate`: errors on poses the training has not seen.

use super::model;
use anyhow::Result;
use ctsn_author::dataset::{self, Dataset, Split};
use ctsn_author::evaluate;
use std::path::PathBuf;

/// Compare a model with the simulation on the last tenth of the clips (with fewer than ten: of each clip)
///
/// Prints E_dist, E_norm and penetration of the whole network, of the skeleton stream alone and of plain skinning on the same frames.
#[derive(clap::Args)]
pub struct Arguments {
    /// Model file (safetensors)
    pub model: PathBuf,
    /// Dataset folder
    pub dataset: PathBuf,
    /// Report file (JSON). Default: beside the model
    #[arg(long)]
    pub report: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let report = evaluate::evaluate(&model(&arguments.model)?, &Dataset::read(&arguments.dataset)?, Split::Test)?;
    let path = arguments.report.clone().unwrap_or_else(|| arguments.model.with_extension("report.json"));
    dataset::write(&path, serde_json::to_string_pretty(&report)?.as_bytes())?;
    println!("{report}");
    Ok(())
}
