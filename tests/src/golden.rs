//! The golden models and every intermediate result, computed by code independent of ours. Tolerances stand in the
//! files.

use ctsn_core::cpu::Level;
use ctsn_core::file::Tensors;
use ctsn_core::model::HostModel;
use ctsn_core::{Predictor, Streams};
use std::collections::BTreeMap;

/// One golden model and its expected results.
pub struct Golden {
    /// Name of the pair.
    pub name: &'static str,
    /// `NAME.safetensors`.
    pub model: &'static [u8],
    /// `NAME.golden.safetensors`.
    pub expected: &'static [u8],
}

macro_rules! golden {
    ($($name:literal),*) => {
        [$(Golden {
            name: $name,
            model: include_bytes!(concat!("../golden/", $name, ".safetensors")),
            expected: include_bytes!(concat!("../golden/", $name, ".golden.safetensors")),
        }),*]
    };
}

/// All golden models.
pub const ALL: [Golden; 4] = golden!["tiny", "small", "small_f16", "isolated"];

/// A golden file, read.
pub struct Expected {
    name: &'static str,
    file: Tensors<'static>,
    tolerances: BTreeMap<String, f32>,
    /// Poses [J, 3, 4].
    pub poses: Vec<Vec<f32>>,
}

impl Golden {
    /// The model.
    pub fn host_model(&self) -> HostModel {
        HostModel::parse(self.model).expect("golden model")
    }

    /// The poses and what is expected of them.
    pub fn read(&self) -> Expected {
        let file = Tensors::parse(self.expected).expect("golden file");
        let tolerances = miniserde::json::from_str(&file.metadata["tolerance"]).expect("tolerances");
        let numbers = 12 * file.tensors["pose.joints"].shape[1];
        let poses = file.tensors["pose.joints"].to_f32().expect("poses");
        Expected {
            name: self.name,
            file,
            tolerances,
            poses: poses.chunks_exact(numbers).map(<[f32]>::to_vec).collect(),
        }
    }

    /// Runs every pose at `level` and compares every stage; panics with the first stage that is off.
    pub fn check(&self, level: Level) {
        let expected = self.read();
        let mut predictor = Predictor::from_model(self.host_model(), level);
        for (p, pose) in expected.poses.iter().enumerate() {
            predictor.predict_row_major(pose, Streams::Both).expect("a golden pose");
            expected.compare(p, predictor.activations().stages().iter().map(|(name, values)| (name.as_str(), *values)));
        }
    }
}

impl Expected {
    /// Compares every stage of pose `p`, by name; panics with the first that is off, and if one is missing.
    pub fn compare<'a>(&self, p: usize, stages: impl Iterator<Item = (&'a str, &'a Vec<f32>)>) {
        let mut compared = Vec::new();
        for (stage, found) in stages {
            // Of the layers, the first pose alone is in the file.
            if stage.starts_with("layer.") && p > 0 {
                continue;
            }
            let expected = &self.file.tensors[&format!("expected.{stage}")];
            let size: usize = expected.shape[usize::from(!stage.starts_with("layer."))..].iter().product();
            let expected = &expected.to_f32().expect("expected")[p * size..][..size];
            assert!(found.len() >= size, "{} {stage}: {} numbers", self.name, found.len());
            let error = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, largest);
            let tolerance = self.tolerances[stage];
            assert!(error <= tolerance, "{} pose {p} {stage}: error {error:e}, tolerance {tolerance:e}", self.name);
            compared.push(stage.to_owned());
        }
        let names = self.file.tensors.keys().filter_map(|key| key.strip_prefix("expected."));
        let mut wanted: Vec<&str> = names.filter(|stage| p == 0 || !stage.starts_with("layer.")).collect();
        compared.sort_unstable();
        wanted.sort_unstable();
        assert_eq!(compared, wanted, "{}: every stage of pose {p}", self.name);
    }
}

/// Maximum that a NaN wins, so that a NaN never passes a comparison.
fn largest(a: f32, b: f32) -> f32 {
    if b > a || b.is_nan() { b } else { a }
}
