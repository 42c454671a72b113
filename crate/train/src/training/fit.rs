//! Training from the first epoch to the last: validation after every epoch, the best parameters kept, checkpoints, and
//! the reasons to stop before the end: no gain, no time left, divergence.

use super::adam::schedule;
use super::watch::Watched;
use super::{Trainer, curve};
use crate::dataset::Sample;
use crate::loss::{magnitude, sum, told};
use crate::{Error, Result};
use curve::Row;
use std::path::PathBuf;

/// Epochs between checkpoints.
const CHECKPOINT: usize = 5;
/// Losses this many times those of the first step have exploded.
const EXPLOSION: f32 = 10.0;

/// Where a training leaves its traces.
#[derive(Clone, Debug)]
pub struct Files {
    /// Checkpoint, to go on from after an interruption.
    pub checkpoint: PathBuf,
    /// Learning curve (CSV).
    pub curve: PathBuf,
}

/// Why a training ended.
#[derive(Debug)]
pub enum End {
    /// All epochs done, or the time is up.
    Done,
    /// No better validation error for so many epochs as the settings' patience.
    NoGain,
    /// The loss was no number any more, or exploded.
    Diverged(Error),
}

impl Trainer {
    /// Trains to the end, from wherever it stands; `progress(trainer, row)` after every epoch. [`Self::best`] is the
    /// outcome.
    pub fn fit(&mut self, validation: &[&Sample], files: &Files, mut progress: impl FnMut(&Self, &Row)) -> Result<End> {
        while !self.ended() {
            if self.best_epoch().is_some_and(|best| self.epoch - best.epoch >= self.settings.patience) {
                return Ok(End::NoGain);
            }
            let row = match self.round(validation) {
                Err(error @ Error::Diverged(_)) => return Ok(End::Diverged(error)),
                row => row?,
            };
            curve::write(&files.curve, &self.curve)?;
            if self.epoch.is_multiple_of(CHECKPOINT) {
                self.save(&files.checkpoint)?;
            }
            progress(self, &row);
        }
        Ok(End::Done)
    }

    /// One epoch and its validation, noted in the curve.
    pub(super) fn round(&mut self, validation: &[&Sample]) -> Result<Row> {
        if self.untrained.is_none() && !validation.is_empty() {
            self.untrained = Some(self.validate(validation)?.distance);
        }
        self.emphasise();
        let losses = self.epoch(|_, _, _| {})?;
        let Watched { distance, normal, bending } = match validation {
            [] => Watched { distance: sum(&self.terms, &losses), normal: 0.0, bending: None },
            _ => self.validate(validation)?,
        };
        let first = self.first.unwrap_or(f32::INFINITY);
        if magnitude(&self.terms, &losses) > EXPLOSION * first || !distance.is_finite() {
            let told = told(&self.terms, &losses);
            return Err(Error::Diverged(format!(
                "epoch {}: {told}; validation error {distance} m, {} m before training",
                self.epoch,
                self.untrained.unwrap_or_default()
            )));
        }
        let rate = self.rate(self.epoch * self.steps());
        let losses = self.terms.iter().map(|term| term.name.to_owned()).zip(losses).collect();
        let row = Row { epoch: self.epoch, losses, distance, normal, bending, rate, seconds: self.seconds() };
        self.curve.push(row.clone());
        if self.best_epoch().is_some_and(|best| best.epoch == row.epoch) {
            self.best = self.parameters.each().map(|(_, values)| values.to_vec()).collect();
        }
        Ok(row)
    }

    /// Share of the training that is over: of its time where that is given, else of its epochs.
    pub fn progress(&self) -> f64 {
        self.progress_at(self.epoch * self.steps())
    }

    fn progress_at(&self, step: usize) -> f64 {
        match self.settings.budget {
            Some(budget) => self.seconds() / budget.as_secs_f64(),
            None => step as f64 / (self.settings.epochs() * self.steps()).max(1) as f64,
        }
    }

    /// Learning rate of optimisation step `step`.
    pub(super) fn rate(&self, step: usize) -> f32 {
        schedule(self.settings.rate, self.progress_at(step) as f32)
    }

    /// The epoch that is best on the validation slice.
    pub fn best_epoch(&self) -> Option<&Row> {
        curve::best(&self.curve)
    }

    /// Whether the epochs are done or the time is up: an epoch that would end later than half its time past the budget
    /// is not begun, but the first one is.
    fn ended(&self) -> bool {
        match self.settings.budget {
            None => self.epoch >= self.settings.epochs(),
            Some(budget) => {
                let seconds = self.seconds();
                self.epoch > 0 && seconds + 0.5 * seconds / self.epoch as f64 >= budget.as_secs_f64()
            }
        }
    }
}
