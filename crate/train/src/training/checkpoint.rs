//! Checkpoints: parameters, moments, the best parameters and the learning curve. Training resumed from one goes on as
//! if it had not been interrupted.

use super::{Trainer, coarse, unsimulated};
use crate::{Error, Result, loss};
use ctsn_core::file::{Tensor, Tensors};
use ctsn_rig::file::{tensors, write};
use std::path::Path;
use std::time::Instant;

/// By what the best parameters were kept: after another rule they are not those of the epoch that the curve tells.
const KEPT: &str = "near the least E_dist, by E_dist times E_norm";

impl Trainer {
    /// Writes a checkpoint.
    pub fn save(&self, path: &Path) -> Result<()> {
        let mut file = Tensors::default();
        file.metadata.insert("settings".to_owned(), self.key());
        file.metadata.insert("kept".to_owned(), KEPT.to_owned());
        let past = serde_json::to_string(&(self.untrained, self.first, &self.curve));
        file.metadata.insert("curve".to_owned(), past.map_err(|error| Error::Training(error.to_string()))?);
        self.parameters.save(&mut file);
        self.hypernetwork.iter().for_each(|network| network.parameters.save(&mut file));
        for ((name, _), values) in self.parameters.each().zip(&self.best) {
            file.tensors.insert(format!("{name}.best"), Tensor::f32(&[values.len()], values));
        }
        write(path, &file.to_bytes())
    }

    /// Goes on from a checkpoint of the same training.
    pub fn resume(&mut self, path: &Path) -> Result<()> {
        let wrong = |reason: String| Error::File { path: path.to_owned(), reason };
        let file = tensors(path)?;
        let told = |name: &str| file.metadata.get(name).map(String::as_str);
        if told("settings") != Some(&self.key()) || told("kept") != Some(KEPT) {
            return Err(wrong("is a checkpoint of another training; delete it to start anew".to_owned()));
        }
        let past = file.metadata.get("curve").and_then(|text| serde_json::from_str(text).ok());
        (self.untrained, self.first, self.curve) = past.ok_or_else(|| wrong("holds no learning curve".to_owned()))?;
        let named = |error: Error| wrong(error.to_string());
        self.parameters.load(&file).map_err(named)?;
        if let Some(network) = &mut self.hypernetwork {
            network.parameters.load(&file).map_err(named)?;
            network.make(&mut self.parameters);
        }
        let best = |(name, values): (&str, &[f32])| {
            let stored = file.f32(&format!("{name}.best"), &[Some(values.len())]);
            stored.map(|stored| stored.0).map_err(|error| wrong(error.to_string()))
        };
        self.best = self.parameters.each().map(best).collect::<Result<_>>()?;
        self.epoch = self.curve.len();
        self.started = (Instant::now(), self.curve.last().map_or(0.0, |row| row.seconds));
        Ok(())
    }

    /// What two trainings must have in common to go on as one, and by which their models are the same.
    pub fn key(&self) -> String {
        let (settings, terms, each) = (self.settings, loss::key(&self.terms), unsimulated::EACH);
        // Without coarse poses the key is that of versions that knew none.
        let coarse = self.coarse.as_ref().map(|poses| format!("coarse {} {:016x} ", coarse::EACH, poses.data));
        let coarse = coarse.unwrap_or_default();
        format!("{settings:?} {terms} unsimulated {each} {coarse}start {:016x} data {:016x}", self.start, self.data)
    }
}
