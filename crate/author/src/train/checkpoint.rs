//! Checkpoints: parameters, moments and epoch. Training resumed from one goes on as if it had not been interrupted.

use super::{Settings, Trainer};
use crate::dataset::{tensors, write};
use crate::{Error, Result};
use ctsn_core::file::{Tensor, Tensors};
use std::path::Path;

impl Trainer {
    /// Writes a checkpoint.
    pub fn save(&self, path: &Path) -> Result<()> {
        let mut file = Tensors::default();
        file.metadata.insert("settings".to_owned(), key(&self.settings));
        file.metadata.insert("epoch".to_owned(), self.epoch.to_string());
        for (i, (id, moments)) in self.parameters.iter().zip(&self.moments).enumerate() {
            let parts = [("value", self.shared.get(*id)), ("mean", &moments.mean), ("square", &moments.square)];
            for (name, values) in parts {
                file.tensors.insert(format!("{i:03}.{name}"), Tensor::f32(&[values.len()], values));
            }
        }
        write(path, &file.to_bytes())
    }

    /// Goes on from a checkpoint of the same training.
    pub fn resume(&mut self, path: &Path) -> Result<()> {
        let wrong = |reason: String| Error::File { path: path.to_owned(), reason };
        let file = tensors(path)?;
        let epoch = file.metadata.get("epoch").and_then(|text| text.parse().ok());
        if file.metadata.get("settings") != Some(&key(&self.settings)) {
            return Err(wrong("is a checkpoint of a training with other settings; delete it to start anew".to_owned()));
        }
        for (i, (id, moments)) in self.parameters.iter().zip(&mut self.moments).enumerate() {
            for (name, values) in
                [("value", self.shared.get_mut(*id)), ("mean", &mut moments.mean), ("square", &mut moments.square)]
            {
                let shape = [Some(values.len())];
                let stored = file.f32(&format!("{i:03}.{name}"), &shape).map_err(|error| wrong(error.to_string()))?;
                values.copy_from_slice(&stored.0);
            }
        }
        self.epoch = epoch.ok_or_else(|| wrong("names no epoch".to_owned()))?;
        Ok(())
    }
}

fn key(settings: &Settings) -> String {
    format!("{settings:?}")
}
