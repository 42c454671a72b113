//! Model files that are cut, flipped or lying: each has its kind of error; none panics, none yields NaN.

use ctsn_core::file::{Tensor, Tensors};
use ctsn_core::model::{HostModel, Storage};
use ctsn_core::{Predictor, Result};
use ctsn_tests::finite::{pose, predict};
use ctsn_tests::{golden, layered, sphere};
#[cfg(target_arch = "wasm32")]
use wasm_bindgen_test::{wasm_bindgen_test as test, wasm_bindgen_test_configure};

#[cfg(target_arch = "wasm32")]
wasm_bindgen_test_configure!(run_in_browser);

const TINY: &[u8] = golden::ALL[0].model;
/// Rounds of bit flips.
const FLIPS: usize = 4000;

/// Length of the header and offset of the payload.
fn header(bytes: &[u8]) -> (usize, usize) {
    let length = u64::from_le_bytes(bytes[..8].try_into().expect("8 bytes")) as usize;
    (length, 8 + length)
}

#[test]
fn truncated_files_are_refused() {
    let kind = |length: usize| HostModel::parse(&TINY[..length]).expect_err("wanted a refusal").kind();
    let (_, payload) = header(TINY);
    for length in 0..payload {
        assert_eq!(kind(length), "not_safetensors", "{length} bytes");
    }
    for length in (payload..TINY.len()).step_by(61).chain([TINY.len() - 1]) {
        assert_eq!(kind(length), "truncated", "{length} bytes");
    }
    let message = HostModel::parse(&TINY[..TINY.len() - 1]).expect_err("wanted a refusal").to_string();
    let (wanted, found) = (TINY.len() - payload, TINY.len() - payload - 1);
    assert_eq!(message, format!("truncated file: reference.index ends at byte {wanted}, the file has {found}"));
}

#[test]
fn flipped_files_are_refused_or_finite() {
    let mut random = 0x9E37_79B9_7F4A_7C15_u64;
    let mut next = |below: usize| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as usize % below
    };
    let mut whole = HostModel::parse(TINY).expect("golden model");
    whole.body = Some(sphere::body(whole.sizes.vertices));
    let whole = layered::itself(&whole).to_bytes(Storage::F32);
    let (length, payload) = header(&whole);
    let (mut refused, mut finite) = (0, 0);
    for round in 0..FLIPS {
        let mut bytes = whole.clone();
        // Half of the flips in the header, where a digit makes a size lie; half in the numbers.
        let place = if round % 2 == 0 { 8 + next(length) } else { payload + next(whole.len() - payload) };
        if round % 4 == 0 && bytes[place].is_ascii_digit() {
            bytes[place] = b'0' + next(10) as u8;
        } else {
            bytes[place] ^= 1 << next(8);
        }
        match Predictor::new(&bytes) {
            Ok(mut predictor) => {
                let pose = pose(predictor.sizes().joints);
                finite += usize::from(predict(&mut predictor, &pose));
            }
            Err(_) => refused += 1,
        }
    }
    assert!(refused > FLIPS / 10 && finite > FLIPS / 10, "{refused} refused, {finite} finite of {FLIPS}");
}

/// What reading says of tiny's tensors and metadata after a change to them.
fn lie(change: impl FnOnce(&mut Tensors)) -> Result<HostModel> {
    let mut file = Tensors::parse(TINY).expect("golden model");
    change(&mut file);
    HostModel::parse(&file.to_bytes())
}

/// What reading says of tiny with a part of its header's text replaced.
fn lie_in_header(from: &str, to: &str) -> Result<HostModel> {
    let (_, payload) = header(TINY);
    let text = std::str::from_utf8(&TINY[8..payload]).expect("golden header");
    assert!(text.contains(from), "the header has no {from}");
    let text = text.replacen(from, to, 1);
    let length = (text.len() as u64).to_le_bytes();
    HostModel::parse(&[&length, text.as_bytes(), &TINY[payload..]].concat())
}

#[track_caller]
fn assert_kind(found: Result<HostModel>, kind: &str, says: &str) {
    let error = found.err().unwrap_or_else(|| panic!("wanted {kind} with {says:?}, found a model"));
    assert_eq!(error.kind(), kind, "{error}");
    assert!(error.to_string().contains(says), "wanted {says:?} in {error}");
}

#[test]
fn headers_that_lie_are_refused() {
    let huge = usize::MAX.to_string();
    let half = (usize::MAX / 2 + 1).to_string();
    let cases: [(&str, &str, &str, &str); 14] = [
        ("[24,3],\"data_offsets\":[0,288]", "[24,3],\"data_offsets\":[288,0]", "not_safetensors", "no range"),
        ("[0,288]", "[0]", "not_safetensors", "no range"),
        ("[0,288]", "[-288,0]", "not_safetensors", "no range"),
        ("[0,288]", "[0.0,288]", "not_safetensors", "no range"),
        ("[0,288]", "[0,289]", "not_safetensors", "does not fill 289 bytes"),
        ("[288,576]", "[0,288]", "not_safetensors", "share bytes"),
        ("[288,576]", "[284,572]", "not_safetensors", "share bytes"),
        ("[288,576]", "[99999900,100000188]", "truncated", "100000188"),
        ("\"shape\":[24,3]", &format!("\"shape\":[{huge},3]"), "not_safetensors", "does not fill"),
        ("\"shape\":[24,3]", &format!("\"shape\":[{half},2]"), "not_safetensors", "does not fill"),
        ("\"shape\":[24,3]", "\"shape\":[99999999999999999999,3]", "not_safetensors", "shape"),
        ("\"shape\":[24,3]", "\"shape\":\"24,3\"", "not_safetensors", "shape"),
        ("\"F32\"", "\"F64\"", "not_safetensors", "dtype"),
        ("\"F32\"", "\"U32\"", "shape", "U32"),
    ];
    for (from, to, kind, says) in cases {
        assert_kind(lie_in_header(from, to), kind, says);
    }
    for length in [u64::MAX, u64::MAX - 7, 1 << 32, TINY.len() as u64] {
        let bytes = [&length.to_le_bytes(), &TINY[8..]].concat();
        assert_kind(HostModel::parse(&bytes), "not_safetensors", "header of");
    }
    let deep = "[".repeat(1_000_000);
    let bytes = [&(deep.len() as u64).to_le_bytes(), deep.as_bytes()].concat();
    assert_kind(HostModel::parse(&bytes), "not_safetensors", "JSON");
}

#[test]
fn every_tensor_is_needed() {
    let names: Vec<String> = Tensors::parse(TINY).expect("golden model").tensors.into_keys().collect();
    for name in &names {
        assert_kind(lie(|file| drop(file.tensors.remove(name))), "missing_tensor", name);
    }
}

#[test]
fn every_shape_and_number_is_checked() {
    let whole = Tensors::parse(TINY).expect("golden model");
    for (name, tensor) in &whole.tensors {
        let long = |file: &mut Tensors| {
            let found = file.tensors.get_mut(name).expect("tensor");
            found.shape.push(1);
        };
        assert_kind(lie(long), "shape", name);
        let mut empty = Tensor { bytes: Vec::new().into(), ..tensor.clone() };
        empty.shape[0] = 0;
        let found = lie(|file| drop(file.tensors.insert(name.clone(), empty)));
        // A cloth without triangles is a cloth; everything else has a size.
        assert_eq!(found.is_ok(), name == "cloth.triangles", "{name} without elements");
        let Some(mut values) = tensor.to_f32() else { continue };
        for value in [f32::NAN, f32::INFINITY] {
            *values.last_mut().expect("a value") = value;
            let not_finite = Tensor::f32(&tensor.shape, &values);
            assert_kind(lie(|file| drop(file.tensors.insert(name.clone(), not_finite))), "not_finite", name);
        }
    }
}

/// Sizes that agree with each other, and still are no network.
#[test]
fn layers_without_width_are_refused() {
    let empty = |file: &mut Tensors, name: &str, shape: &[usize]| {
        file.tensors.insert(name.to_owned(), Tensor::f32(shape, &[]));
    };
    let embedding = lie(|file| {
        empty(file, "embedding.0.weight", &[0, 36]);
        empty(file, "embedding.0.bias", &[0]);
        empty(file, "embedding.1.weight", &[4, 0]);
    });
    assert_kind(embedding, "shape", "embedding.0.weight");
    let graph = lie(|file| {
        for part in ["query", "key", "value", "skip"] {
            empty(file, &format!("graph.0.{part}.weight"), &[0, 3]);
            empty(file, &format!("graph.0.{part}.bias"), &[0]);
        }
    });
    assert_kind(graph, "shape", "graph.0.query.weight");
}

#[test]
fn indices_out_of_range_are_refused() {
    for (name, shape) in [("cloth.triangles", &[36, 3][..]), ("reference.index", &[24])] {
        for index in [24, u32::MAX] {
            let mut values = Tensors::parse(TINY).expect("golden model").tensors[name].to_u32().expect("indices");
            values[7] = index;
            let found = lie(|file| drop(file.tensors.insert(name.to_owned(), Tensor::u32(shape, &values))));
            assert_kind(found, "index", &format!("{index} at element 7"));
        }
    }
    let surface = |vertex: u32, corner: u32| {
        lie(|file| {
            file.tensors.insert("draw.vertex".to_owned(), Tensor::u32(&[3], &[0, 1, vertex]));
            file.tensors.insert("draw.uv".to_owned(), Tensor::f32(&[3, 2], &[0.0; 6]));
            file.tensors.insert("draw.triangles".to_owned(), Tensor::u32(&[1, 3], &[0, 1, corner]));
        })
    };
    assert!(surface(23, 2).is_ok());
    assert_kind(surface(24, 2), "index", "draw.vertex");
    assert_kind(surface(23, 3), "index", "draw.triangles");
}

#[test]
fn drawn_meshes_that_ride_on_nothing_are_refused() {
    type Change = (&'static str, Tensor<'static>);
    let riding = |changes: &[Change], without: &str| {
        lie(|file| {
            file.tensors.insert("draw.vertex".to_owned(), Tensor::u32(&[3], &[0, 1, 1]));
            file.tensors.insert("draw.uv".to_owned(), Tensor::f32(&[3, 2], &[0.0; 6]));
            file.tensors.insert("draw.triangles".to_owned(), Tensor::u32(&[1, 3], &[0, 1, 2]));
            file.tensors.insert("draw.corners".to_owned(), Tensor::u32(&[2, 3], &[0, 1, 2, 3, 4, 23]));
            let coordinates = [0.5, 0.25, 0.25, 0.01, 1.5, -0.5, 0.0, -0.01];
            file.tensors.insert("draw.coordinates".to_owned(), Tensor::f32(&[2, 4], &coordinates));
            changes.iter().for_each(|(name, tensor)| drop(file.tensors.insert((*name).to_owned(), tensor.clone())));
            file.tensors.remove(without);
        })
    };
    assert!(riding(&[], "").is_ok());
    for name in ["draw.vertex", "draw.corners", "draw.coordinates"] {
        assert_kind(riding(&[], name), "missing_tensor", name);
    }
    let corners = |corner: u32| ("draw.corners", Tensor::u32(&[2, 3], &[0, 1, 2, 3, 4, corner]));
    assert_kind(riding(&[corners(24)], ""), "index", "draw.corners");
    assert_kind(riding(&[("draw.vertex", Tensor::u32(&[3], &[0, 1, 2]))], ""), "index", "draw.vertex");
    assert_kind(riding(&[("draw.corners", Tensor::u32(&[3, 2], &[0; 6]))], ""), "shape", "draw.corners");
    let coordinates = |first: [f32; 4]| {
        let values = [first, [1.0, 0.0, 0.0, 0.0]].concat();
        riding(&[("draw.coordinates", Tensor::f32(&[2, 4], &values))], "")
    };
    assert_kind(coordinates([0.5, 0.5, 0.5, 0.0]), "not_model", "draw.coordinates");
    assert_kind(coordinates([20.0, -19.0, 0.0, 0.0]), "not_model", "draw.coordinates");
    for value in [f32::NAN, f32::INFINITY] {
        assert_kind(coordinates([1.0, 0.0, 0.0, value]), "not_finite", "draw.coordinates");
    }
    let none = [("draw.corners", Tensor::u32(&[0, 3], &[])), ("draw.coordinates", Tensor::f32(&[0, 4], &[]))];
    assert_kind(riding(&none, ""), "shape", "draw.coordinates");
    // Where riders alone overflow, the prediction is refused.
    let mut model = layered::itself(&HostModel::parse(TINY).expect("golden model"));
    let ride = model.ride.as_mut().expect("riders");
    ride.coordinates[..4].copy_from_slice(&[16.0, -15.0, 0.0, f32::MAX]);
    model.rest[..6].copy_from_slice(&[1e38, 1e38, 1e38, -1e38, -1e38, -1e38]);
    model.skeleton_basis.fill(0.0);
    let mut predictor = Predictor::new(&model.to_bytes(Storage::F32)).expect("a predictor");
    assert!(!predict(&mut predictor, &pose(3)));
}

#[test]
fn standard_deviations_are_positive() {
    for (name, count) in [("pose.std", 36), ("reference.std", 3)] {
        for value in [0.0, -0.0, -1.0] {
            let mut values = vec![1.0; count];
            values[2] = value;
            let found = lie(|file| drop(file.tensors.insert(name.to_owned(), Tensor::f32(&[count], &values))));
            assert_kind(found, "not_positive", name);
        }
    }
}

#[test]
fn descriptions_that_lie_are_refused() {
    let described = |from: &str, to: &str| {
        lie(|file| {
            let text = file.metadata.get_mut("ctsn").expect("description");
            assert!(text.contains(from), "the description has no {from}");
            *text = text.replacen(from, to, 1);
        })
    };
    let cases = [
        ("\"version\": 1", "\"version\": 3", "not_model", "wanted version 1 or 2, found 3"),
        ("\"hip_yaw\"", "\"toe\"", "not_model", "toe"),
        ("\"root\": 0", "\"root\": 3", "not_model", "root 3"),
        ("\"root\": 0", "\"root\": -1", "not_model", "root"),
        ("\"root\"", "\"boot\"", "not_model", "root"),
        ("\"heads\": 2", "\"heads\": 3", "not_model", "3 heads do not divide"),
        ("\"heads\": 2", "\"heads\": 0", "not_model", "0 heads do not divide"),
        ("[\"hip\", \"leg0\", \"leg1\"]", "[]", "not_model", "joints"),
        ("[\"hip\", \"leg0\", \"leg1\"]", "[\"hip\"]", "shape", "cloth.weights"),
        ("[[0.0708702877163887, ", "[[", "not_model", "inverse_bind"),
        ("[[0.0708702877163887", "[[1e39", "not_finite", "inverse_bind"),
        ("\"edge_scale\": 0.", "\"edge_scale\": -0.", "not_positive", "edge_scale"),
        ("\"edge_scale\": 0.3", "\"edge_scale\": 1e99, \"x\": 0.3", "not_positive", "edge_scale"),
    ];
    for (from, to, kind, says) in cases {
        assert_kind(described(from, to), kind, says);
    }
    assert_kind(lie(|file| file.metadata.clear()), "not_model", "ctsn");
    let other = lie(|file| drop(file.metadata.insert("ctsn".to_owned(), "a picture".to_owned())));
    assert_kind(other, "not_model", "lacks");
}
