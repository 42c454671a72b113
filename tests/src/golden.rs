//! The golden models and every intermediate result, computed by code independent of ours. Tolerances stand in the files.

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

impl Golden {
    /// Runs every pose at `level` and compares every stage; panics with the first stage that is off.
    pub fn check(&self, level: Level) {
        let file = Tensors::parse(self.expected).expect("golden file");
        let tolerances: BTreeMap<String, f32> =
            miniserde::json::from_str(&file.metadata["tolerance"]).expect("tolerances");
        let model = HostModel::parse(self.model).expect("golden model");
        let (n, joints, layers) = (model.sizes.vertices, model.sizes.joints, model.layers.len());
        let poses = file.tensors["pose.joints"].to_f32().expect("poses");
        let mut predictor = Predictor::from_model(model, level);
        let mut stages = 0;
        for (p, pose) in poses.chunks_exact(12 * joints).enumerate() {
            predictor.predict_row_major(pose, Streams::Both).expect("a golden pose");
            let a = predictor.activations();
            let mut compare = |stage: &str, found: &[f32], first: usize| {
                let expected = file.tensors[&format!("expected.{stage}")].to_f32().expect("expected");
                let expected = &expected[first * found.len()..][..found.len()];
                let error = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, largest);
                let tolerance = tolerances[stage];
                assert!(error <= tolerance, "{} pose {p} {stage}: error {error:e}, tolerance {tolerance:e}", self.name);
                stages += 1;
            };
            compare("body_frame", &a.body_frame[..12 * joints], p);
            compare("embedding", a.embedding.last().expect("embedding"), p);
            compare("skeleton", &a.skeleton, p);
            compare("reference", &a.reference, p);
            compare("mesh", &a.mesh, p);
            compare("template", &a.template, p);
            compare("positions", &a.positions, p);
            if p == 0 {
                a.layers.iter().enumerate().for_each(|(l, layer)| compare(&format!("layer.{l}"), &layer.output, 0));
            }
        }
        assert_eq!(stages, 7 * poses.len() / (12 * joints) + layers, "{}: every stage of every pose", self.name);
        assert_eq!(predictor.normals().len(), 3 * n);
    }
}

/// Maximum that a NaN wins, so that a NaN never passes a comparison.
fn largest(a: f32, b: f32) -> f32 {
    if b > a || b.is_nan() { b } else { a }
}
