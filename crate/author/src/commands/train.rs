//! `ctsn train`: the network from a dataset.

use super::{Network, bar, file_name};
use anyhow::{Context, Result, anyhow};
use ctsn_author::body::body;
use ctsn_author::dataset::{self, Dataset, Setup};
use ctsn_author::train::{self, End, Files, Part, Row, Slices, Trainer, Variant};
use ctsn_core::model::{Body, HostModel, Storage};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Train the network on a dataset: all clips but the last tenth (with fewer than ten: the first 90 % of each)
///
/// Mixed poses of the dataset are learned from, too. From further ones, which need no simulation, cloth on a character with limbs learns to
/// stay outside the body. A tenth of the frames are not learned from, but predicted after every epoch: the model
/// with the least error on them is kept. The learning curve stands beside the model (MODEL.curve.csv). A checkpoint is written every few
/// epochs; training interrupted goes on from it, to the same result. A model that this very training has made is left as it is.
#[derive(clap::Args)]
pub struct Arguments {
    /// Dataset folder, as `ctsn simulate` leaves it
    pub dataset: PathBuf,
    /// Model file to write (safetensors)
    #[arg(short, long)]
    pub output: PathBuf,
    #[command(flatten)]
    pub settings: Settings,
}

/// How to train.
#[derive(clap::Args, Clone)]
pub struct Settings {
    /// Passes over the training poses
    #[arg(long, default_value_t = 100)]
    epochs: usize,
    /// Train for this long instead, as 90s, 60m or 1.5h: the learning rate has fallen when the time is up
    #[arg(long, value_parser = duration, conflicts_with = "epochs")]
    time_budget: Option<Duration>,
    /// Stop after so many epochs without a better validation error
    #[arg(long, default_value_t = 50)]
    patience: usize,
    /// Simulated poses per optimisation step
    #[arg(long, default_value_t = 8)]
    batch: usize,
    /// Adam's learning rate at the start; it falls along a cosine
    #[arg(long, default_value_t = 1e-3)]
    learning_rate: f32,
    /// Seed of initial weights, of the order, and of the poses mixed on the way
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    network: Network,
    /// Parts of the network to leave out, for ablations: skeleton,mesh,weights
    #[arg(long, value_enum, value_delimiter = ',')]
    without: Vec<Part>,
    /// Storage of learned tensors
    #[arg(long, value_enum, default_value = "f16")]
    storage: StorageArgument,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum StorageArgument {
    /// 32-bit floats
    F32,
    /// 16-bit floats, half the bytes
    F16,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let dataset = Dataset::read(&arguments.dataset)?;
    let slices = train::slices(&dataset)?;
    let files = Files {
        checkpoint: arguments.output.with_extension("checkpoint"),
        curve: arguments.output.with_extension("curve.csv"),
    };
    // Before the training: what cannot be made of this body must not be found out after hours.
    let body = body(&dataset.setup, &slices.train)?;
    let mut trainer = arguments.settings.trainer(&dataset.setup, &slices, body)?;
    let key = arguments.settings.key(&dataset.setup, &slices, &trainer);
    if made_by(&arguments.output, &key) {
        println!("{}: has been trained so already; delete it to train anew", arguments.output.display());
        return Ok(());
    }
    if files.checkpoint.exists() {
        trainer.resume(&files.checkpoint)?;
        println!("going on from epoch {} of {}", trainer.epoch, files.checkpoint.display());
    }
    let end = fit(&mut trainer, &slices, &files)?;
    let name = file_name(&arguments.output);
    match (end, trainer.best()) {
        (End::Diverged(error), None) => Err(error.into()),
        (_, None) => Err(anyhow!("no epoch was trained: wanted at least one")),
        (end, Some((best, model))) => {
            let silent = train::is_mesh_silent(&model, &slices.validation)?;
            // What diverged is to be tried again.
            let key = Some(key).filter(|_| !matches!(end, End::Diverged(_)));
            let bytes = arguments.settings.store(&dataset.setup, &slices, &trainer, &best, model, key);
            dataset::write(&arguments.output, &bytes)?;
            std::fs::remove_file(&files.checkpoint).ok();
            println!("{name}: {} bytes, of epoch {}: {}", bytes.len(), best.epoch, errors(&best));
            if silent {
                println!("its mesh stream died in training and adds nothing: try another --seed, or --without mesh");
            }
            match end {
                End::Diverged(error) => {
                    Err(error).context(format!("{name} is of the best epoch before, {}", best.epoch))
                }
                End::NoGain | End::Done => Ok(()),
            }
        }
    }
}

/// Whether there is a model of the training of that key.
fn made_by(path: &Path, key: &str) -> bool {
    let summary = super::model(path).ok().and_then(|model| model.training);
    let summary = summary.and_then(|text| serde_json::from_str::<serde_json::Value>(&text).ok());
    summary.is_some_and(|summary| summary["key"] == key)
}

impl Settings {
    /// A trainer that has not begun.
    fn trainer(&self, setup: &Setup, slices: &Slices, body: Body<Vec<f32>, Vec<u32>>) -> Result<Trainer> {
        let Self { epochs, time_budget: budget, patience, batch, learning_rate: rate, seed, .. } = *self;
        let variant = Variant::without(&self.without);
        let architecture = variant.sizes(self.network.architecture());
        let mut model = train::initial(setup, &slices.train, architecture, seed)?;
        model.body = Some(body);
        let mixed = if slices.mixed == 0 { String::new() } else { format!(" ({} of them mixed)", slices.mixed) };
        println!(
            "{} poses to learn from{mixed}, {} to validate, {} vertices, {architecture:?}",
            slices.train.len(),
            slices.validation.len(),
            model.sizes.vertices
        );
        let settings = train::Settings { epochs, budget, patience, batch, rate, seed, variant };
        Ok(Trainer::new(model, setup, &slices.train, settings)?)
    }

    /// What makes the model: the training, what its epoch is chosen by, and how it is stored.
    fn key(&self, setup: &Setup, slices: &Slices, trainer: &Trainer) -> String {
        let validation = dataset::fingerprint(setup, &slices.validation);
        let (training, version) = (trainer.key(), env!("CARGO_PKG_VERSION"));
        format!("{training} validation {validation:016x} {:?} {version}", self.storage)
    }

    /// The model file: the best epoch's model, and what it was trained on. Nothing in it depends on the hour.
    fn store(
        &self,
        setup: &Setup,
        slices: &Slices,
        trainer: &Trainer,
        best: &Row,
        mut model: HostModel,
        key: Option<String>,
    ) -> Vec<u8> {
        let part = |part: &Part| format!("{part:?}").to_lowercase();
        let summary = serde_json::json!({
            "character": setup.description.character,
            "garment": setup.description.garment,
            "clips": setup.description.clips,
            "poses": slices.train.len(),
            "mixed": slices.mixed,
            "without": self.without.iter().map(part).collect::<Vec<_>>(),
            "epoch": best.epoch,
            "batch": self.batch,
            "seed": self.seed,
            "loss_metres": best.fine,
            "untrained_validation_metres": trainer.untrained,
            "validation_metres": best.distance,
            "validation_degrees": best.normal,
            "key": key,
            "ctsn": env!("CARGO_PKG_VERSION"),
        });
        model.training = Some(summary.to_string());
        model.to_bytes(match self.storage {
            StorageArgument::F32 => Storage::F32,
            StorageArgument::F16 => Storage::F16,
        })
    }
}

/// Steps of the bar: epochs are not known beforehand where time is given.
const PARTS: f64 = 1000.0;

/// Trains to the end, telling how it goes.
fn fit(trainer: &mut Trainer, slices: &Slices, files: &Files) -> Result<End> {
    let bar = bar(PARTS as usize, "train");
    bar.set_position((PARTS * trainer.progress()) as u64);
    bar.reset_eta();
    let (first, start) = (trainer.epoch, trainer.seconds());
    let end = trainer.fit(&slices.validation, files, |trainer, row| {
        bar.set_position((PARTS * trainer.progress()) as u64);
        let best = trainer.best_epoch().map_or(0, |best| best.epoch);
        let text = format!("epoch {}: {}, best {best}", row.epoch, errors(row));
        if bar.is_hidden() {
            println!("{text}, {:.0} s", row.seconds);
        }
        bar.set_message(text);
    })?;
    bar.finish_and_clear();
    if let Some(distance) = trainer.untrained {
        println!("before training: E_dist {:.2} mm", distance * 1e3);
    }
    let steps = (trainer.epoch - first) * trainer.steps();
    if steps > 0 {
        println!("{:.1} ms an optimisation step", (trainer.seconds() - start) * 1e3 / steps as f64);
    }
    if let End::NoGain = end {
        println!("stopped after epoch {}: no better validation error for long enough", trainer.epoch);
    }
    Ok(end)
}

fn errors(row: &Row) -> String {
    let Row { fine, distance, normal, .. } = row;
    format!("loss {:.2} mm, E_dist {:.2} mm, E_norm {normal:.2}°", fine * 1e3, distance * 1e3)
}

/// A number with its unit: s, m or h.
fn duration(text: &str) -> Result<Duration, String> {
    let wrong = || format!("wanted a time as 90s, 60m or 1.5h, found {text}");
    let (number, unit) = text.split_at_checked(text.len().saturating_sub(1)).ok_or_else(wrong)?;
    let seconds = match unit {
        "s" => 1.0,
        "m" => 60.0,
        "h" => 3600.0,
        _ => return Err(wrong()),
    };
    let number: f64 = number.parse().map_err(|_| wrong())?;
    Duration::try_from_secs_f64(number * seconds).ok().filter(|time| !time.is_zero()).ok_or_else(wrong)
}
