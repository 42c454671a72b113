//! The paper's comparisons on one dataset: each way to predict trained by the same optimiser on the same poses, judged on the same unseen
//! ones; by the paper's losses, without that of penetration, since the models of a study have no body. Paper § "Comparisons", "Ablation Experiments". Every training leaves its outcome in a file: a study goes on where it stopped.

mod deepsd;
mod flops;
mod front;
mod method;
mod page;
mod table;
#[cfg(test)]
mod tests;

use crate::dataset::{Dataset, Sample, Split, digest, fingerprint, write};
use crate::evaluate::{Errors, Judge, predictions, unseen};
use crate::train::{End, Files, Row, Settings, Slices, Trainer, Variant, slices};
use crate::{Error, Result};
use ctsn_core::model::{HostModel, Storage};
pub use flops::flops;
pub use front::{front, recommended};
pub use method::{Entry, Method, Table};
pub use page::study as page;
use serde::{Deserialize, Serialize};
use std::path::Path;
pub use table::{Grid, entries};

/// What came of one entry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Of which entry.
    pub name: String,
    /// What it was made of: method, settings, data. Another study's outcome is refused by it.
    pub made_of: String,
    /// On the unseen poses.
    pub errors: Errors,
    /// E_dist on the validation slice, metres: what sizes are chosen by, so that the unseen poses stay unseen.
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
    /// Where it is not the file's: numbers learned that make the basis and the weights.
    parameters: Option<usize>,
    epoch: usize,
    seconds: f64,
}

impl<'a> Study<'a> {
    /// A study of `dataset` with the same `settings` for all (their variant counts for nothing), kept in `folder`.
    pub fn new(dataset: &'a Dataset, settings: Settings, folder: &'a Path) -> Result<Self> {
        let (slices, unseen) = (slices(dataset)?, unseen(dataset, Split::Test)?);
        Ok(Self { judge: Judge::new(&dataset.setup)?, dataset, slices, unseen, settings, folder })
    }

    /// What is compared, in words.
    pub fn title(&self) -> String {
        let description = &self.dataset.setup.description;
        format!("{} on {}", description.garment, description.character)
    }

    /// Poses learned from, to validate, unseen.
    pub fn poses(&self) -> [usize; 3] {
        [self.slices.train.len(), self.slices.validation.len(), self.unseen.len()]
    }

    /// The outcome of the simulation itself: what of it is inside the body.
    pub fn truth(&self) -> Errors {
        let positions = self.unseen.iter().map(|sample| crate::rig::vertices(&sample.truth)).collect();
        self.judge.errors(&self.unseen, &self.judge.run(&self.unseen, positions), 0..self.unseen.len())
    }

    /// The outcome of `entry`: read where there is one, else made. `progress(row)` after every epoch.
    pub fn outcome(&self, entry: &Entry, progress: impl FnMut(&Row)) -> Result<Outcome> {
        let path = self.folder.join(format!("{}.json", entry.name));
        let made_of = self.made_of(entry)?;
        if path.exists() {
            let wrong = |reason: String| Error::File { path: path.clone(), reason };
            let bytes = crate::dataset::read(&path)?;
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
        // Tells what an older version made of the same method.
        let start = entry.method.initial(&self.dataset.setup, &self.slices.train, self.settings.seed)?;
        let start = digest(&start.to_bytes(Storage::F32));
        let settings = Settings { variant: entry.method.variant(), ..self.settings };
        let parts = [&self.slices.train, &self.slices.validation, &self.unseen];
        let data = parts.map(|samples| fingerprint(&self.dataset.setup, samples));
        let (method, title, poses) = (&entry.method, self.title(), self.poses());
        Ok(format!("{method:?}, {settings:?}, {title}, poses {poses:?}, start {start:016x}, data {data:016x?}"))
    }

    /// Bytes of the file; of a form that makes its basis from fewer numbers, of those.
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
        if entry.method == Method::Deepsd {
            let form = deepsd::Deepsd::new(model, setup, train, self.settings)?;
            let curve = self.folder.join(format!("{}.curve.csv", entry.name));
            let deepsd::Trained { best, model, parameters, seconds } =
                form.fit(&self.slices, &self.judge, &curve, progress)?;
            return Ok(Made { model, parameters: Some(parameters), epoch: best.epoch, seconds });
        }
        if variant == (Variant { skeleton: false, mesh: false, weights: false }) {
            return Ok(Made { model, parameters: None, epoch: 0, seconds: 0.0 });
        }
        self.train(entry, model, variant, progress)
    }

    fn train(&self, entry: &Entry, model: HostModel, variant: Variant, mut progress: impl FnMut(&Row)) -> Result<Made> {
        let file = |extension: &str| self.folder.join(format!("{}.{extension}", entry.name));
        let files = Files { checkpoint: file("checkpoint"), curve: file("curve.csv") };
        let settings = Settings { variant, ..self.settings };
        let mut trainer = Trainer::new(model, &self.dataset.setup, &self.slices.train, settings)?;
        if files.checkpoint.exists() {
            trainer.resume(&files.checkpoint)?;
        }
        let end = trainer.fit(&self.slices.validation, &files, |_, row| progress(row))?;
        match (end, trainer.best()) {
            (End::Diverged(error), None) => Err(error),
            (_, None) => Err(Error::Training("wanted at least one epoch, found 0".to_owned())),
            (_, Some((best, model))) => {
                std::fs::remove_file(&files.checkpoint).ok();
                Ok(Made { model, parameters: None, epoch: best.epoch, seconds: trainer.seconds() })
            }
        }
    }
}

fn wrong_json(error: &serde_json::Error) -> Error {
    Error::Dataset(error.to_string())
}
