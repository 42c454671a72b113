//! `ctsn evaluate`: errors on poses the training has not seen.

use super::{file_name, model};
use crate::pages::evaluation::{Gallery, page, training};
use anyhow::{Context, Result};
use ctsn_core::model::HostModel;
use ctsn_rig::file;
use ctsn_train::dataset::{Dataset, Split};
use ctsn_train::judging::{self, Report};
use maud::{Markup, html};
use std::path::{Path, PathBuf};

/// Compare a model with the simulation on the last tenth of the clips (with fewer than ten: of each clip)
///
/// Prints E_dist and E_norm (mean ± standard deviation over frames, 95th percentile), the share of vertices inside the
/// body, the error of edge lengths and the acceleration of the vertices, for the whole network, the skeleton stream
/// alone and plain skinning.
#[derive(clap::Args)]
pub struct Arguments {
    /// Model file (safetensors)
    pub model: PathBuf,
    /// Dataset folder
    pub dataset: PathBuf,
    /// Judge every pose of the dataset, of which the model has learned nothing: another's dances, for example
    /// (`ctsn motion CHARACTER --from OTHER`, then `ctsn simulate`)
    #[arg(long)]
    pub all: bool,
    /// Write all of it for programs, also by clip, joint and frame (JSON)
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write a page with tables, curves and pictures of the worst frames, in one file (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    judge(arguments, |_| Ok([html! {}, html! {}]))
}

/// Judges the model; `around` gives what the page has before and after its figures.
pub fn judge(arguments: &Arguments, around: impl FnOnce(&Report) -> Result<[Markup; 2]>) -> Result<()> {
    let (model, dataset) = (model(&arguments.model)?, Dataset::read(&arguments.dataset)?);
    let split = if arguments.all { Split::All } else { Split::Test };
    let report = judging::evaluate(&model, &dataset, split)?;
    if let Some(path) = &arguments.json {
        file::write(path, serde_json::to_string_pretty(&report)?.as_bytes())?;
    }
    if let Some(path) = &arguments.html {
        let curves = training::curves(&arguments.model.with_extension("curve.csv"))?;
        let gallery = Gallery::new(&model, &dataset, &report)?;
        let facts = facts(&arguments.model, &model)?;
        let page = page::report(&report, &curves, &gallery, &facts, &around(&report)?)?;
        file::write(path, page.as_bytes())?;
    }
    println!("{report}");
    Ok(())
}

/// Facts on the model itself: name and text.
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

/// The model's JSON about its training, as text to read.
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
