//! `ctsn train`: the network from a dataset.

use super::{bar, file_name, one_of, simulate};
use anyhow::{Context, Result, anyhow};
use ctsn_core::model::{Body, Cut, HostModel, STEPS, Storage};
use ctsn_rig::file;
use ctsn_train::body::body;
use ctsn_train::dataset::{Dataset, Sample, Setup, fingerprint};
use ctsn_train::training::{self, Architecture, End, Files, Part, Row, Settings, Slices, Trainer, Variant};
use std::path::{Path, PathBuf};

/// Train the network on a dataset: on all clips but the last tenth (with fewer than ten: on the first 90 % of each)
///
/// Mixed poses of the dataset are used too, and of symmetric characters in symmetric garments every pose a second
/// time, seen in a mirror. On a character with limbs, more poses are mixed during training, without simulation: cloth
/// learns from them to stay outside the body. A tenth of the frames is held back and predicted after every epoch: the
/// model with the least error on them is kept. The learning curve is written beside the model (MODEL.curve.csv). A
/// checkpoint is written every few epochs; interrupted training continues from it, with the same result. A model that
/// the same training has made already is left as it is. Asked for with another --storage, it is stored anew from what
/// was learned (MODEL.f32.safetensors), without training.
#[derive(clap::Args)]
pub struct Arguments {
    /// Dataset folder, as `ctsn simulate` leaves it; with --self-supervised, the character (glTF)
    pub dataset: PathBuf,
    /// With --self-supervised, the garment (glTF)
    #[arg(requires = "self_supervised")]
    pub garment: Option<PathBuf>,
    /// Learn without simulated poses: by the energy of the predicted cloth, its stretch, bending and weight, and of its
    /// contact with the body, in the frames of the character's clips and in poses mixed of them. Such cloth folds
    /// more, and finer, than simulated cloth
    #[arg(long, requires = "garment")]
    pub self_supervised: bool,
    /// Train a model to relax poses from (`ctsn simulate --from`): the simulated cloth says where it is, the energy of
    /// the predicted cloth how it folds. It is farther from this truth than others, but nearly keeps its lengths, so
    /// truth relaxed from it folds as it does
    #[arg(long, conflicts_with = "self_supervised")]
    pub teacher: bool,
    /// Model file to write (safetensors)
    #[arg(short, long)]
    pub output: PathBuf,
    #[command(flatten)]
    pub training: Training,
}

/// What to train, how, and how to store it.
#[derive(clap::Args, Clone)]
pub struct Training {
    #[command(flatten)]
    pub settings: Settings,
    #[command(flatten)]
    network: Architecture,
    /// Parts of the network to leave out, for ablations: skeleton,mesh,weights
    #[arg(long, value_enum, value_delimiter = ',')]
    without: Vec<Part>,
    /// Storage of learned tensors
    #[arg(long, value_parser = one_of(STORAGES), default_value = "f16")]
    storage: Storage,
}

const STORAGES: &[(&str, &str, Storage)] =
    &[("f32", "32-bit floats", Storage::F32), ("f16", "16-bit floats, half the bytes", Storage::F16)];

/// What makes a trainer, by its losses.
type By = fn(HostModel, &Setup, &[&Sample], Settings) -> ctsn_train::Result<Trainer>;

pub fn run(arguments: &Arguments) -> Result<()> {
    let Arguments { output, training: asked, .. } = arguments;
    let dataset = match &arguments.garment {
        Some(garment) => simulate::unsimulated(&arguments.dataset, garment)?,
        None => Dataset::read(&arguments.dataset)?,
    };
    let mut slices = slices(arguments, &dataset)?;
    let files = Files { checkpoint: output.with_extension("checkpoint"), curve: output.with_extension("curve.csv") };
    // Before the training: an unusable body must not be found out after hours.
    let fine = if arguments.self_supervised { &[][..] } else { &slices.train };
    let body = body(&dataset.setup, &slices.learned(), fine)?;
    let [images, coarse] = images(arguments, &dataset.setup, &slices)?;
    slices.add(&images, &coarse);
    let by: By = match arguments {
        Arguments { self_supervised: true, .. } => Trainer::self_supervised,
        Arguments { teacher: true, .. } => Trainer::teacher,
        _ => Trainer::new,
    };
    let mut trainer = asked.trainer(by, &dataset.setup, &slices, body)?;
    let key = key(&dataset.setup, &slices, &trainer)?;
    // What was learned, exactly, whatever the storage asked for.
    let learned = output.with_extension("f32.safetensors");
    if is_trained(output, &learned, &key, asked.storage)? {
        return Ok(());
    }
    if files.checkpoint.exists() {
        trainer.resume(&files.checkpoint)?;
        println!("continuing from epoch {} of {}", trainer.epoch, files.checkpoint.display());
    }
    let end = fit(&mut trainer, &slices, &files)?;
    let name = file_name(output);
    match (end, trainer.best()) {
        (End::Diverged(error), None) => Err(error.into()),
        (_, None) => Err(anyhow!("no epoch was trained: wanted at least one")),
        (end, Some((best, model))) => {
            let seen = if arguments.self_supervised { &slices.train } else { &slices.validation };
            let silent = training::is_mesh_silent(&model, seen)?;
            // A training that diverged may be tried again.
            let key = Some(key).filter(|_| !matches!(end, End::Diverged(_)));
            let summary = asked.summary(&dataset.setup, &slices, &trainer, &best, key);
            let model = HostModel { training: Some(summary), ..model };
            let bytes = model.to_bytes(asked.storage);
            file::write(&learned, &model.to_bytes(Storage::F32))?;
            file::write(output, &bytes)?;
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

/// The poses to learn from in a mirror, fine and coarse: none without truth.
fn images(arguments: &Arguments, setup: &Setup, slices: &Slices) -> Result<[Vec<Sample>; 2]> {
    if arguments.self_supervised {
        return Ok(Default::default());
    }
    Ok([training::mirrored(setup, &slices.train)?, training::mirrored(setup, &slices.coarse)?])
}

/// What to train with: without truth all there is, for nothing of it shows an error.
fn slices<'a>(arguments: &Arguments, dataset: &'a Dataset) -> Result<Slices<'a>> {
    if !arguments.self_supervised {
        return Ok(training::slices(dataset)?);
    }
    let train = dataset.samples.iter().collect();
    Ok(Slices { train, coarse: Vec::new(), mixed: 0, images: [0; 2], validation: Vec::new() })
}

/// Whether this same training has made the model at `output`; then stores it as asked, from what was `learned`.
fn is_trained(output: &Path, learned: &Path, key: &str, storage: Storage) -> Result<bool> {
    let Some(model) = made_by(output, key) else { return Ok(false) };
    if model.to_bytes(storage) == file::read(output)? {
        println!("{}: has been trained so already; delete it to train again", output.display());
        return Ok(true);
    }
    let Some(model) = made_by(learned, key) else { return Ok(false) };
    let bytes = model.to_bytes(storage);
    file::write(output, &bytes)?;
    let [name, learned] = [output, learned].map(file_name);
    println!("{name}: has been trained so already; stored anew from {learned}, {} bytes", bytes.len());
    Ok(true)
}

/// The model at that path, if the training of that key has made it.
fn made_by(path: &Path, key: &str) -> Option<HostModel> {
    let model = super::model(path).ok()?;
    let summary: serde_json::Value = serde_json::from_str(model.training.as_deref()?).ok()?;
    (summary["key"] == key).then_some(model)
}

/// All that decides the model: the training, and the poses that choose its epoch.
fn key(setup: &Setup, slices: &Slices, trainer: &Trainer) -> Result<String> {
    let validation = fingerprint(setup, &slices.validation)?;
    Ok(format!("{} validation {validation:016x} {}", trainer.key(), env!("CARGO_PKG_VERSION")))
}

impl Training {
    /// A trainer that has not begun.
    fn trainer(&self, by: By, setup: &Setup, slices: &Slices, body: Body<Vec<f32>, Vec<u32>>) -> Result<Trainer> {
        let variant = Variant::without(&self.without);
        let architecture = variant.sizes(self.network);
        let mut model = training::initial(setup, &slices.learned(), architecture, self.settings.seed)?;
        model.body = Some(body);
        model.cut = Some(Cut::new(setup.garment.clone(), &model.graph, STEPS)?);
        let mixed = if slices.mixed == 0 { String::new() } else { format!(" ({} of them mixed)", slices.mixed) };
        let images = if slices.images == [0; 2] { "" } else { ", each also in a mirror" };
        let [train, coarse] = slices.simulated();
        let coarse = if coarse == 0 { String::new() } else { format!(", {coarse} more of coarse cloth") };
        println!(
            "{train} poses to learn from{mixed}{coarse}{images}, {} to validate, {} vertices, {architecture:?}",
            slices.validation.len(),
            model.sizes.vertices
        );
        let settings = Settings { variant, ..self.settings };
        let mut trainer = by(model, setup, &slices.train, settings)?;
        trainer.add_coarse(setup, &slices.coarse)?;
        Ok(trainer)
    }

    /// What the model file says of its training. Nothing in it depends on the time of day.
    fn summary(&self, setup: &Setup, slices: &Slices, trainer: &Trainer, best: &Row, key: Option<String>) -> String {
        let [train, coarse] = slices.simulated();
        let part = |part: &Part| format!("{part:?}").to_lowercase();
        let summary = serde_json::json!({
            "character": setup.description.character,
            "garment": setup.description.garment,
            "fabric": setup.description.material.name,
            "clips": setup.description.clips,
            "poses": train,
            "mixed": slices.mixed,
            "mirrored": slices.images[0],
            "coarse": coarse,
            "without": self.without.iter().map(part).collect::<Vec<_>>(),
            "epoch": best.epoch,
            "batch": self.settings.batch,
            "seed": self.settings.seed,
            "loss_metres": best.loss("fine"),
            "untrained_validation_metres": trainer.untrained,
            "validation_metres": trainer.untrained.map(|_| best.distance),
            "validation_degrees": trainer.untrained.map(|_| best.normal),
            "key": key,
            "ctsn": env!("CARGO_PKG_VERSION"),
        });
        summary.to_string()
    }
}

/// Steps of the bar: the number of epochs is not known beforehand under a time budget.
const PARTS: f64 = 1000.0;

/// Trains to the end with a progress bar.
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
    let Row { distance, normal, .. } = row;
    let energies = ["energy", "contact"].map(|name| row.loss(name).map(|value| format!("{name} {value:.3} J, ")));
    let energies: String = energies.into_iter().flatten().collect();
    let loss = row.loss("fine").map_or(energies, |fine| format!("loss {:.2} mm, ", fine * 1e3));
    if !row.is_judged() {
        return format!("{loss}no truth");
    }
    format!("{loss}E_dist {:.2} mm, E_norm {normal:.2}°", distance * 1e3)
}
