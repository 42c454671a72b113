//! The paper's comparisons on one dataset. Every way to predict is trained by the same optimiser on the same poses, and
//! judged on the same unseen ones. The losses are all that training has; that of penetration has nothing to do, since
//! the models of a study have no body. Paper § "Comparisons", "Ablation Experiments". Every training leaves its outcome
//! in a file, so that an interrupted study continues where it stopped.

mod deepsd;
mod flops;
mod front;
mod method;
#[cfg(test)]
mod tests;

use crate::dataset::{Dataset, Sample, Split, digest, fingerprint};
use crate::judging::{Errors, Judge, predictions, unseen};
use crate::loss::{self, LOSSES};
use crate::training::hypernetwork::Hypernetwork;
use crate::training::{End, Files, Row, Settings, Slices, Trainer, Variant, slices};
use crate::{Error, Result};
use ctsn_core::model::{HostModel, Storage};
use ctsn_rig::file::{read, write};
pub use flops::flops;
pub use front::{front, recommended};
pub use method::{Entry, Method, Table, entries};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The outcome of one entry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Name of the entry.
    pub name: String,
    /// What it was made of: method, settings, data. An outcome of another study differs here, and is refused.
    pub made_of: String,
    /// On the unseen poses.
    pub errors: Errors,
    /// E_dist on the validation slice, metres: sizes are chosen by it, so that the unseen poses stay unseen.
    pub validation: f64,
    /// Bytes of the model file in F16.
    pub bytes: usize,
    /// Floating-point operations of one prediction.
    pub flops: usize,
    /// The epoch that was kept; 0 without training.
    pub epoch: usize,
    /// Seconds of training.
    pub seconds: f64,
}

/// A study of one dataset.
pub struct Study<'a> {
    dataset: &'a Dataset,
    slices: Slices<'a>,
    unseen: Vec<&'a Sample>,
    judge: Judge<'a>,
    settings: Settings,
    folder: &'a Path,
}

/// A model and how it came about.
struct Made {
    model: HostModel,
    /// Number of learned parameters of a form that makes its basis and weights from fewer numbers than the file holds.
    parameters: Option<usize>,
    epoch: usize,
    seconds: f64,
}

impl<'a> Study<'a> {
    /// A study of `dataset` with the same `settings` for all (their variant is ignored), kept in `folder`.
    pub fn new(dataset: &'a Dataset, settings: Settings, folder: &'a Path) -> Result<Self> {
        let (slices, unseen) = (slices(dataset)?, unseen(dataset, Split::Test)?);
        Ok(Self { judge: Judge::new(&dataset.setup)?, dataset, slices, unseen, settings, folder })
    }

    /// What is compared, in words.
    pub fn title(&self) -> String {
        let description = &self.dataset.setup.description;
        format!("{} on {}", description.garment, description.character)
    }

    /// Numbers of training, validation and unseen poses.
    pub fn poses(&self) -> [usize; 3] {
        [self.slices.train.len(), self.slices.validation.len(), self.unseen.len()]
    }

    /// Errors of the simulation itself: how much of it is inside the body, how much it accelerates.
    pub fn truth(&self) -> Errors {
        let positions = self.unseen.iter().map(|sample| ctsn_rig::vertices(&sample.truth)).collect();
        self.judge.errors(&self.unseen, &self.judge.run(&self.unseen, positions), 0..self.unseen.len())
    }

    /// The outcome of `entry`: read where there is one, else made. `progress(row)` after every epoch.
    pub fn outcome(&self, entry: &Entry, progress: impl FnMut(&Row)) -> Result<Outcome> {
        let path = self.folder.join(format!("{}.json", entry.name));
        let made_of = self.made_of(entry)?;
        if path.exists() {
            let wrong = |reason: String| Error::File { path: path.clone(), reason };
            let bytes = read(&path)?;
            let found: Outcome = serde_json::from_slice(&bytes).map_err(|error| wrong(error.to_string()))?;
            if found.made_of != made_of {
                let reason = format!("is of another study; wanted {made_of}, found {}", found.made_of);
                return Err(wrong(format!("{reason}; name another folder, or delete it")));
            }
            return Ok(found);
        }
        let made = self.make(entry, progress)?;
        let streams = entry.method.streams();
        let judged = |samples: &[&Sample]| {
            let run = self.judge.run(samples, predictions(&made.model, &self.judge, samples, streams)?);
            Ok::<_, Error>(self.judge.errors(samples, &run, 0..samples.len()))
        };
        let file = made.model.to_bytes(Storage::F16);
        let outcome = Outcome {
            name: entry.name.clone(),
            made_of,
            errors: judged(&self.unseen)?,
            validation: judged(&self.slices.validation)?.distance.mean,
            bytes: self.bytes(entry, &made, file.len())?,
            flops: flops(&made.model, streams),
            epoch: made.epoch,
            seconds: made.seconds,
        };
        write(&self.folder.join(format!("{}.safetensors", entry.name)), &file)?;
        let text = serde_json::to_string_pretty(&outcome).map_err(|error| wrong_json(&error))?;
        write(&path, text.as_bytes())?;
        Ok(outcome)
    }

    fn made_of(&self, entry: &Entry) -> Result<String> {
        // The model before training tells apart what an older version made of the same method.
        let start = entry.method.initial(&self.dataset.setup, &self.slices.train, self.settings.seed)?;
        let start = digest(&start.to_bytes(Storage::F32));
        let settings = Settings { variant: entry.method.variant(), ..self.settings };
        let of = |samples: &[&Sample]| fingerprint(&self.dataset.setup, samples);
        let data = [of(&self.slices.train)?, of(&self.slices.validation)?, of(&self.unseen)?];
        let (method, title, poses, losses) = (&entry.method, self.title(), self.poses(), loss::key(LOSSES));
        Ok(format!(
            "{method:?}, {settings:?}, {losses}, {title}, poses {poses:?}, start {start:016x}, data {data:016x?}"
        ))
    }

    /// Bytes of the file; for a form that makes its basis from fewer numbers, bytes of those.
    fn bytes(&self, entry: &Entry, made: &Made, file: usize) -> Result<usize> {
        let Some(parameters) = made.parameters else { return Ok(file) };
        let without = Method::Skinning.initial(&self.dataset.setup, &self.slices.train, self.settings.seed)?;
        debug_assert_eq!(entry.method, Method::Deepsd);
        Ok(without.to_bytes(Storage::F16).len() + 2 * parameters)
    }

    fn make(&self, entry: &Entry, progress: impl FnMut(&Row)) -> Result<Made> {
        let (setup, train) = (&self.dataset.setup, &self.slices.train);
        let model = entry.method.initial(setup, train, self.settings.seed)?;
        let variant = entry.method.variant();
        if variant == (Variant { skeleton: false, mesh: false, weights: false }) {
            return Ok(Made { model, parameters: None, epoch: 0, seconds: 0.0 });
        }
        let (model, network) = match entry.method {
            Method::Deepsd => {
                let (model, network) = deepsd::deepsd(model, setup, self.settings.seed)?;
                (model, Some(network))
            }
            _ => (model, None),
        };
        self.train(entry, model, network, variant, progress)
    }

    fn train(
        &self,
        entry: &Entry,
        model: HostModel,
        network: Option<Hypernetwork>,
        variant: Variant,
        mut progress: impl FnMut(&Row),
    ) -> Result<Made> {
        let file = |extension: &str| self.folder.join(format!("{}.{extension}", entry.name));
        let files = Files { checkpoint: file("checkpoint"), curve: file("curve.csv") };
        let settings = Settings { variant, ..self.settings };
        let parameters = network.as_ref().map(|network| deepsd::size(&model, network));
        let mut trainer = Trainer::with(model, network, LOSSES, &self.dataset.setup, &self.slices.train, settings)?;
        if files.checkpoint.exists() {
            trainer.resume(&files.checkpoint)?;
        }
        let end = trainer.fit(&self.slices.validation, &files, |_, row| progress(row))?;
        match (end, trainer.best()) {
            // A row of it would tell of the method what its training is to blame for.
            (End::Diverged(error), _) => Err(error),
            (_, None) => Err(Error::Training("wanted at least one epoch, found 0".to_owned())),
            (_, Some((best, model))) => {
                std::fs::remove_file(&files.checkpoint).ok();
                Ok(Made { model, parameters, epoch: best.epoch, seconds: trainer.seconds() })
            }
        }
    }
}

fn wrong_json(error: &serde_json::Error) -> Error {
    Error::Dataset(error.to_string())
}
