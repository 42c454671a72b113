//! `ctsn train`: the network from a dataset.

use super::{Network, bar, file_name};
use anyhow::Result;
use ctsn_author::dataset::{self, Dataset, Split};
use ctsn_author::train::{self, Loss, Trainer};
use ctsn_core::model::Storage;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Train the network on a dataset: all clips but the last tenth (with fewer than ten: the first 90 % of each)
///
/// A checkpoint is written beside the model every few epochs; training interrupted goes on from it, to the same result.
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
    /// Poses per optimisation step
    #[arg(long, default_value_t = 8)]
    batch: usize,
    /// Adam's learning rate at the start; it falls along a cosine
    #[arg(long, default_value_t = 1e-3)]
    learning_rate: f32,
    /// Seed of initial weights and order
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    network: Network,
    /// Storage of learned tensors
    #[arg(long, value_enum, default_value = "f16")]
    storage: StorageArgument,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum StorageArgument {
    /// 32-bit floats
    F32,
    /// 16-bit floats, half the bytes
    F16,
}

/// Epochs between checkpoints.
const CHECKPOINT: usize = 5;

pub fn run(arguments: &Arguments) -> Result<()> {
    let Settings { epochs, batch, learning_rate, seed, ref network, storage } = arguments.settings;
    let dataset = Dataset::read(&arguments.dataset)?;
    let samples = dataset.split(Split::Train);
    let architecture = network.architecture();
    let model = train::initial(&dataset.setup, &samples, architecture, seed)?;
    let settings = train::Settings { epochs, batch, rate: learning_rate, seed };
    let mut trainer = Trainer::new(model, &dataset.setup, &samples, settings)?;
    let checkpoint = arguments.output.with_extension("checkpoint");
    if checkpoint.exists() {
        trainer.resume(&checkpoint)?;
        println!("going on from epoch {} of {}", trainer.epoch, checkpoint.display());
    }
    println!("{} training poses, {} vertices, {architecture:?}", samples.len(), dataset.setup.template.len() / 3);
    let loss = epochs_of(&mut trainer, epochs, &checkpoint)?;
    let mut model = trainer.model();
    let summary = serde_json::json!({
        "character": dataset.setup.description.character,
        "garment": dataset.setup.description.garment,
        "clips": dataset.setup.description.clips,
        "poses": samples.len(),
        "epochs": epochs,
        "batch": batch,
        "seed": seed,
        "loss_metres": loss.fine,
        "ctsn": env!("CARGO_PKG_VERSION"),
    });
    model.training = Some(summary.to_string());
    let bytes = model.to_bytes(match storage {
        StorageArgument::F32 => Storage::F32,
        StorageArgument::F16 => Storage::F16,
    });
    dataset::write(&arguments.output, &bytes)?;
    std::fs::remove_file(&checkpoint).ok();
    println!("{}: {} bytes, training loss {:.2} mm", file_name(&arguments.output), bytes.len(), loss.fine * 1e3);
    Ok(())
}

/// Runs what is left of `epochs`, writing checkpoints; the last epoch's loss.
fn epochs_of(trainer: &mut Trainer, epochs: usize, checkpoint: &Path) -> Result<Loss> {
    let (first, start) = (trainer.epoch, Instant::now());
    let bar = bar(epochs, "train");
    bar.set_position(first as u64);
    bar.reset_eta();
    let (mut loss, mut steps_done) = (Loss::default(), 0);
    while trainer.epoch < epochs {
        loss = trainer.epoch(|_, _, _| steps_done += 1)?;
        bar.set_position(trainer.epoch as u64);
        bar.set_message(format!("E_dist {:.2} mm, coarse {:.2} mm", loss.fine * 1e3, loss.coarse * 1e3));
        if trainer.epoch.is_multiple_of(CHECKPOINT) && trainer.epoch < epochs {
            trainer.save(checkpoint)?;
        }
        if bar.is_hidden() && (trainer.epoch.is_multiple_of(CHECKPOINT) || trainer.epoch == epochs) {
            println!(
                "epoch {} of {epochs}: {:.2} mm, {:.0} s",
                trainer.epoch,
                loss.fine * 1e3,
                start.elapsed().as_secs_f64()
            );
        }
    }
    bar.finish_and_clear();
    if steps_done > 0 {
        println!("{:.1} ms an optimisation step", start.elapsed().as_secs_f64() * 1e3 / steps_done as f64);
    }
    Ok(loss)
}
