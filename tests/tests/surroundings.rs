//! Models whose mesh stream sees the coarse cloth around each vertex: their files, and that it is what they see.

use ctsn_core::cpu::Level;
use ctsn_core::file::{Tensor, Tensors};
use ctsn_core::model::{HostModel, Storage};
use ctsn_core::{Predictor, Streams};
use ctsn_tests::random::{self, Shape};
use fastrand::Rng;
#[cfg(target_arch = "wasm32")]
use wasm_bindgen_test::{wasm_bindgen_test as test, wasm_bindgen_test_configure};

#[cfg(target_arch = "wasm32")]
wasm_bindgen_test_configure!(run_in_browser);

const SHAPE: Shape = Shape { vertices: 67, joints: 5, embedding: 7, basis: 13, heads: 3, per_head: 5, layers: 2 };

/// As it is read.
fn model() -> HostModel {
    let mut rng = Rng::with_seed(21);
    let model = random::model(&mut rng, SHAPE);
    HostModel::parse(&random::surrounded(&mut rng, model).to_bytes(Storage::F32)).expect("a model")
}

#[test]
fn a_file_tells_all_of_them() {
    let model = model();
    assert_eq!(model.surroundings.as_ref().map(Vec::len), Some(16 * SHAPE.vertices));
    assert_eq!(model.layers[0].project.inputs, 54);
    assert_eq!(HostModel::parse(&model.to_bytes(Storage::F32)).expect("the same"), model);
}

#[test]
fn a_compass_that_lies_is_refused() {
    let bytes = model().to_bytes(Storage::F32);
    let lie = |change: &dyn Fn(&mut Tensors)| {
        let mut file = Tensors::parse(&bytes).expect("a model's file");
        change(&mut file);
        let error = HostModel::parse(&file.to_bytes()).expect_err("wanted a refusal");
        (error.kind(), error.to_string())
    };
    let compass = |shape: &[usize], vertex: u32| {
        let tensor = Tensor::u32(shape, &vec![vertex; shape.iter().product()]);
        lie(&|file| drop(file.tensors.insert("graph.compass".to_owned(), tensor.clone())))
    };
    for (found, kind, says) in [
        (compass(&[67, 4], 67), "index", "graph.compass"),
        (compass(&[66, 4], 0), "shape", "graph.compass"),
        (compass(&[67, 5], 0), "shape", "graph.compass"),
        // Without it the first layer has the wrong width.
        (lie(&|file| drop(file.tensors.remove("graph.compass"))), "shape", "graph.0.query.weight"),
    ] {
        assert!(found.0 == kind && found.1.contains(says), "wanted {kind}, {says}, found {found:?}");
    }
}

#[test]
fn the_mesh_stream_sees_the_coarse_cloth_and_not_the_body() {
    let (model, mut rng) = (model(), Rng::with_seed(22));
    let pose = random::pose(&mut rng, SHAPE.joints);
    let residual = |model: &HostModel| {
        let mut predictor = Predictor::from_model(model.clone(), Level::new());
        predictor.predict_row_major(&pose, Streams::Both).expect("a pose");
        predictor.activations().mesh.clone()
    };
    let mut other = model.clone();
    other.reference.rest.iter_mut().for_each(|place| *place += rng.f32());
    assert_eq!(residual(&model), residual(&other));
    let mut other = model.clone();
    other.skeleton_basis.iter_mut().for_each(|number| *number *= 2.0);
    assert_ne!(residual(&model), residual(&other));
}
