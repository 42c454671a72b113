//! Any numbers as a pose of a golden model: refused, or the positions are finite and the normals of unit length.
#![no_main]

use ctsn_core::{Predictor, Streams};
use libfuzzer_sys::fuzz_target;
use std::sync::{LazyLock, Mutex};

static PREDICTOR: LazyLock<Mutex<Predictor>> = LazyLock::new(|| {
    let bytes = include_bytes!("../../golden/tiny.safetensors");
    Mutex::new(Predictor::new(bytes).expect("the golden model"))
});

fuzz_target!(|bytes: &[u8]| {
    let mut predictor = PREDICTOR.lock().expect("one thread");
    let numbers: Vec<f32> = bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    if predictor.predict(&numbers, Streams::Both).is_err() {
        return;
    }
    assert!(numbers.iter().all(|number| number.is_finite()), "a pose that is not finite was taken");
    assert!(predictor.positions().iter().all(|value| value.is_finite()));
    for normal in predictor.normals().as_chunks::<3>().0 {
        let length = normal.iter().map(|value| value * value).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-3, "a normal of length {length}");
    }
});
