//! Checkpoints: parameters, moments, the best parameters and the learning curve. Training resumed from one goes on as if it had not been interrupted.

use super::penetration::{UNLABELLED, WEIGHT};
use super::smooth::STEPS;
use super::{Row, Trainer};
use crate::dataset::{tensors, write};
use crate::{Error, Result};
use ctsn_core::file::{Tensor, Tensors};
use std::path::Path;
use std::time::Instant;

impl Trainer {
    /// Writes a checkpoint.
    pub fn save(&self, path: &Path) -> Result<()> {
        let mut file = Tensors::default();
        file.metadata.insert("settings".to_owned(), self.key());
        file.metadata.insert(
            "curve".to_owned(),
            serde_json::to_string(&(self.untrained, &self.curve))
                .map_err(|error| Error::Training(error.to_string()))?,
        );
        for (i, (id, moments)) in self.parameters.iter().zip(&self.moments).enumerate() {
            let parts = [("value", self.shared.get(*id)), ("mean", &moments.mean), ("square", &moments.square)];
            for (name, values) in parts {
                file.tensors.insert(format!("{i:03}.{name}"), Tensor::f32(&[values.len()], values));
            }
        }
        for (i, values) in self.best.iter().enumerate() {
            file.tensors.insert(format!("{i:03}.best"), Tensor::f32(&[values.len()], values));
        }
        write(path, &file.to_bytes())
    }

    /// Goes on from a checkpoint of the same training.
    pub fn resume(&mut self, path: &Path) -> Result<()> {
        let wrong = |reason: String| Error::File { path: path.to_owned(), reason };
        let file = tensors(path)?;
        if file.metadata.get("settings") != Some(&self.key()) {
            return Err(wrong("is a checkpoint of another training; delete it to start anew".to_owned()));
        }
        let curve =
            file.metadata.get("curve").and_then(|text| serde_json::from_str::<(Option<f32>, Vec<Row>)>(text).ok());
        let (untrained, curve) = curve.ok_or_else(|| wrong("holds no learning curve".to_owned()))?;
        let read = |i: usize, name: &str, values: &mut [f32]| {
            let stored = file.f32(&format!("{i:03}.{name}"), &[Some(values.len())]);
            stored.map(|stored| values.copy_from_slice(&stored.0)).map_err(|error| wrong(error.to_string()))
        };
        self.best = self.parameters.iter().map(|id| self.shared.get(*id).to_vec()).collect();
        for (i, (id, moments)) in self.parameters.iter().zip(&mut self.moments).enumerate() {
            read(i, "value", self.shared.get_mut(*id))?;
            read(i, "mean", &mut moments.mean)?;
            read(i, "square", &mut moments.square)?;
            read(i, "best", &mut self.best[i])?;
        }
        self.epoch = curve.len();
        self.started = (Instant::now(), curve.last().map_or(0.0, |row| row.seconds));
        (self.untrained, self.curve) = (untrained, curve);
        Ok(())
    }

    /// What two trainings must have in common to go on as one, and by which their models are the same.
    pub fn key(&self) -> String {
        let constants = format!("smooth {STEPS} penetration {WEIGHT} unlabelled {UNLABELLED}");
        format!("{:?} {constants} start {:016x} data {:016x}", self.settings, self.start, self.data)
    }
}
