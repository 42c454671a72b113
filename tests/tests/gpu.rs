//! The GPU device natively: every stage of every golden model within the given tolerances. A machine without any adapter fails.
#![cfg(not(target_arch = "wasm32"))]

use ctsn_core::Streams;
use ctsn_gpu::{Gpu, Model, Predictor};
use ctsn_tests::golden;
use pollster::block_on;

fn gpu() -> Gpu {
    let gpu = block_on(Gpu::new()).expect("a Vulkan adapter (Debian: mesa-vulkan-drivers)");
    println!("on {}", gpu.name());
    gpu
}

#[test]
fn golden() {
    let gpu = gpu();
    for golden in &golden::ALL {
        let expected = golden.read();
        let model = block_on(Model::new(&gpu, &golden.host_model())).expect("a golden model");
        let mut predictor = block_on(Predictor::new(&model)).expect("a predictor");
        for (p, pose) in expected.poses.iter().enumerate() {
            predictor.predict_row_major(pose, Streams::Both).expect("a golden pose");
            let stages = block_on(predictor.stages()).expect("its stages");
            expected.compare(p, stages.iter().map(|(name, values)| (name.as_str(), values)));
        }
    }
}
