//! Small model files that ask for a machine's whole memory or time: refused when they are read.

use ctsn_core::file::Tensors;
use ctsn_core::model::{HostModel, Linear, Storage};
use ctsn_tests::random::{self, Shape};
use ctsn_tests::{golden, sphere};
#[cfg(target_arch = "wasm32")]
use wasm_bindgen_test::{wasm_bindgen_test as test, wasm_bindgen_test_configure};

#[cfg(target_arch = "wasm32")]
wasm_bindgen_test_configure!(run_in_browser);

/// Asserts that reading refuses a file, with `says` in its message.
#[track_caller]
fn refuses(bytes: &[u8], says: &str) {
    let error = HostModel::parse(bytes).err().unwrap_or_else(|| panic!("wanted {says:?}, found a model"));
    assert_eq!(error.kind(), "not_model", "{error}");
    assert!(error.to_string().contains(says), "wanted {says:?} in {error}");
}

#[test]
fn layers_too_wide_for_memory_are_refused() {
    let shape = Shape { vertices: 60_000, joints: 1, embedding: 1, basis: 1, heads: 1, per_head: 2, layers: 1 };
    let mut model = random::model(&mut fastrand::Rng::with_seed(1), shape);
    let linear = |inputs: usize, outputs: usize| Linear {
        weight: vec![0.0; inputs * outputs],
        bias: vec![0.0; outputs],
        inputs,
        outputs,
    };
    let mut wide = |outputs: usize| {
        model.vertex_mlp = vec![linear(2, outputs), linear(outputs, 1)];
        model.to_bytes(Storage::F32)
    };
    // Of 2^28 numbers each vertex may have 4,473: 12 are the graph layer's, one is the last layer's.
    refuses(&wide(4461), "wanted at most 268435456 numbers between the layers, found 4474 for each of 60000 vertices");
    assert!(HostModel::parse(&wide(4460)).is_ok());
}

#[test]
fn a_polish_without_end_is_refused() {
    let described = |steps: &str| {
        let mut file = Tensors::parse(golden::ALL[0].model).expect("golden model");
        let text = file.metadata.get_mut("ctsn").expect("description");
        *text = text.replacen("\"heads\"", &format!("\"polish\": {steps}, \"heads\""), 1);
        file.to_bytes()
    };
    refuses(&described("257"), "polish: wanted at most 256 steps, found 257");
    refuses(&described("4294967295"), "found 4294967295");
    assert!(HostModel::parse(&described("256")).is_ok());
}

#[test]
fn bodies_whose_triangles_pile_up_are_refused() {
    let piled = |triangles: usize| {
        let places = vec![0.0, 0.0, 0.1, 0.1, 0.0, 0.1];
        let corners = vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1, 0.0];
        let rng = &mut fastrand::Rng::with_seed(1);
        sphere::model(rng, places, corners, [0, 1, 2].repeat(triangles)).to_bytes(Storage::F32)
    };
    refuses(&piled(257), "body.triangles: wanted at most 256 around a vertex, found 257 around 0");
    assert!(HostModel::parse(&piled(256)).is_ok());
}
