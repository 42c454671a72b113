//! `ctsn evaluate`: errors on poses the training has not seen.

use super::{file_name, model};
use anyhow::{Context, Result};
use ctsn_author::dataset::{self, Dataset, Split};
use ctsn_author::evaluate::{self, Gallery, page, training};
use ctsn_core::model::HostModel;
use std::path::{Path, PathBuf};

/// Compare a model with the simulation on the last tenth of the clips (with fewer than ten: of each clip)
///
/// Prints E_dist and E_norm (mean ± standard deviation over frames, 95th percentile), vertices inside the body, difference of edge
/// stretch and acceleration of the vertices: of the whole network, of the skeleton stream alone and of plain skinning.
#[derive(clap::Args)]
pub struct Arguments {
    /// Model file (safetensors)
    pub model: PathBuf,
    /// Dataset folder
    pub dataset: PathBuf,
    /// All of it, by clip, joint and frame too, for programs to read (JSON)
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// A page with tables, curves and pictures of the worst frames, in one file (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let (model, dataset) = (model(&arguments.model)?, Dataset::read(&arguments.dataset)?);
    let report = evaluate::evaluate(&model, &dataset, Split::Test)?;
    if let Some(path) = &arguments.json {
        dataset::write(path, serde_json::to_string_pretty(&report)?.as_bytes())?;
    }
    if let Some(path) = &arguments.html {
        let curves = training::curves(&arguments.model.with_extension("curve.csv"))?;
        let gallery = Gallery::new(&model, &dataset, &report)?;
        let page = page::report(&report, &curves, &gallery, &facts(&arguments.model, &model)?)?;
        dataset::write(path, page.as_bytes())?;
    }
    println!("{report}");
    Ok(())
}

/// What is told of the model itself.
fn facts(path: &Path, model: &HostModel) -> Result<Vec<(&'static str, String)>> {
    let bytes = std::fs::metadata(path).with_context(|| path.display().to_string())?.len();
    let sizes = model.sizes;
    let streams =
        format!("m = {}, k = {}, L = {}, F = {}", sizes.embedding, sizes.basis, model.layers.len(), sizes.features);
    let mut facts = vec![
        ("file", format!("{}, {:.2} MB", file_name(path), bytes as f64 / 1e6)),
        (
            "cloth",
            format!("{} vertices, {} triangles, {} joints", sizes.vertices, model.triangles.len() / 3, sizes.joints),
        ),
        ("network", streams),
    ];
    facts.extend(model.training.as_deref().map(|training| ("training", told(training))));
    Ok(facts)
}

/// The model's JSON about its training, to read.
fn told(training: &str) -> String {
    let Ok(serde_json::Value::Object(object)) = serde_json::from_str(training) else { return training.to_owned() };
    let value = |value: &serde_json::Value| match value {
        serde_json::Value::String(text) => text.clone(),
        serde_json::Value::Array(list) => list.len().to_string(),
        other => other.to_string(),
    };
    let parts = object.iter().map(|(name, found)| format!("{} {}", name.replace('_', " "), value(found)));
    parts.collect::<Vec<_>>().join(", ")
}
