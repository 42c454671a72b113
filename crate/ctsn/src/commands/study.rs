//! `ctsn study`: the paper's comparisons and ablations on one dataset.

use super::bar;
use crate::pages::study::{self, Grid};
use anyhow::Result;
use ctsn_rig::file;
use ctsn_train::dataset::Dataset;
use ctsn_train::methods::{Entry, Outcome, Study, Table, entries};
use ctsn_train::training::{EPOCHS, Settings};
use std::path::PathBuf;

/// Compare the network with plain skinning, older methods, and itself without some of its parts or in other sizes
///
/// Every way to predict is trained on the same poses and judged on the same unseen ones. Each leaves its model,
/// learning curve and errors in the folder; an interrupted study continues from them. The tables are printed as
/// Markdown and written to study.html.
#[derive(clap::Args)]
pub struct Arguments {
    /// Dataset folder, as `ctsn simulate` leaves it
    dataset: PathBuf,
    /// Folder for models and outcomes
    #[arg(short, long)]
    output: PathBuf,
    /// Tables to make; all without it
    #[arg(long, value_enum, value_delimiter = ',')]
    tables: Vec<Table>,
    /// Passes over the training poses
    #[arg(long, default_value_t = EPOCHS)]
    epochs: usize,
    /// Stop a training after so many epochs without a better validation error
    #[arg(long, default_value_t = Settings::default().patience)]
    patience: usize,
    /// Poses per optimisation step
    #[arg(long, default_value_t = Settings::default().batch)]
    batch: usize,
    /// Seed of initial weights and order
    #[arg(long, default_value_t = Settings::default().seed)]
    seed: u64,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let Arguments { epochs, patience, batch, seed, ref output, .. } = *arguments;
    let dataset = Dataset::read(&arguments.dataset)?;
    let settings = Settings { epochs: Some(epochs), patience, batch, seed, ..Settings::default() };
    let study = Study::new(&dataset, settings, output)?;
    let tables = if arguments.tables.is_empty() { Table::ALL.to_vec() } else { arguments.tables.clone() };
    let outcomes = outcomes(&study, &entries(&tables), epochs)?;
    let of = |table: &Table| -> (Vec<Entry>, Vec<Outcome>) {
        let outcome = |entry: Entry| {
            let found = outcomes.iter().find(|outcome| outcome.name == entry.name)?.clone();
            Some((entry, found))
        };
        table.entries().into_iter().filter_map(outcome).unzip()
    };
    let grid = |table: &Table| {
        let (entries, outcomes) = of(table);
        Grid::new(*table, &study, &entries, &outcomes)
    };
    let grids: Vec<Grid> = tables.iter().map(grid).collect();
    let sizes = tables.iter().filter(|table| **table == Table::Front).map(of);
    let sizes: Vec<_> = sizes.flat_map(|(entries, outcomes)| entries.into_iter().zip(outcomes)).collect();
    let page = study::page(&study.title(), &grids, &sizes)?;
    file::write(&output.join("study.html"), page.as_bytes())?;
    file::write(&output.join("study.json"), serde_json::to_string_pretty(&outcomes)?.as_bytes())?;
    println!("# {}\n", study.title());
    grids.iter().for_each(|grid| println!("{grid}"));
    Ok(())
}

/// Makes or reads the outcome of every entry, with a progress bar.
fn outcomes(study: &Study, entries: &[Entry], epochs: usize) -> Result<Vec<Outcome>> {
    let bar = bar(entries.len() * epochs, "study");
    let mut outcomes = Vec::new();
    for (i, entry) in entries.iter().enumerate() {
        let outcome = study.outcome(entry, |row| {
            bar.set_position((i * epochs + row.epoch) as u64);
            bar.set_message(format!("{} of {}, {}: {:.2} mm", i + 1, entries.len(), entry.name, row.distance * 1e3));
        })?;
        bar.set_position(((i + 1) * epochs) as u64);
        let errors = &outcome.errors;
        let text = format!(
            "{}: E_dist {:.2} mm, E_norm {:.2}°, epoch {}, {:.0} s",
            entry.name,
            errors.distance.mean * 1e3,
            errors.normal.mean,
            outcome.epoch,
            outcome.seconds
        );
        if bar.is_hidden() {
            eprintln!("{text}")
        } else {
            bar.println(text)
        }
        outcomes.push(outcome);
    }
    bar.finish_and_clear();
    Ok(outcomes)
}
