//! Packed model files: they predict what the model does, stand coarse first, and what is wrong with one is refused.

use ctsn_core::cpu::Level;
use ctsn_core::file::{Dtype, Tensor, Tensors};
use ctsn_core::model::pack::{MOST_LEVELS, packable, quantise};
use ctsn_core::model::{HostModel, MESH_BASIS, SKELETON_BASIS, Storage, file_bytes};
use ctsn_core::{Predictor, Result, Streams};
use ctsn_tests::finite::{largest, pose, predict};
use ctsn_tests::golden::ALL;
use ctsn_tests::packed::{packed, packed_bytes};
#[cfg(target_arch = "wasm32")]
use wasm_bindgen_test::{wasm_bindgen_test as test, wasm_bindgen_test_configure};

#[cfg(target_arch = "wasm32")]
wasm_bindgen_test_configure!(run_in_browser);

/// The rounding of 14 bits on each side of zero, through two streams of the golden networks.
const NEAR: f32 = 2e-4;

#[test]
fn a_packed_model_predicts_what_the_model_does() {
    for golden in &ALL {
        let expected = golden.read();
        let plain = HostModel::parse(golden.model).expect("a model");
        let small = HostModel::read(&packed(golden.model, MOST_LEVELS)).expect("a packed model");
        assert_eq!((small.sizes, &small.triangles, &small.graph), (plain.sizes, &plain.triangles, &plain.graph));
        let [mut plain, mut small] = [plain, small].map(|model| Predictor::from_model(model, Level::new()));
        for pose in &expected.poses {
            for streams in [Streams::Both, Streams::Skeleton, Streams::None] {
                for one in [&mut plain, &mut small] {
                    one.predict_row_major(pose, streams).expect("a prediction");
                }
                let apart = largest(plain.positions(), small.positions());
                assert!(apart < NEAR, "{}, {streams:?}: {apart}", golden.name);
                assert!(apart > 0.0 || streams == Streams::None, "{}: nothing was packed", golden.name);
            }
        }
    }
}

const BASES: [&str; 2] = [SKELETON_BASIS, MESH_BASIS];
/// Half a step, and what f32 rounds in the product.
const HALF: f32 = 0.502;

#[test]
fn every_number_is_within_half_a_step_of_what_it_was() {
    let small = &ALL[1];
    let before = Tensors::parse(small.model).expect("a model");
    for levels in [7, 127, 128, 1000, MOST_LEVELS] {
        let mut file = Tensors::parse(small.model).expect("a model").into_owned();
        let names = packable(&file);
        assert!(names.contains(&"embedding.0.weight".to_owned()) && names.contains(&"cloth.weights".to_owned()));
        for name in names.iter().filter(|name| !BASES.contains(&name.as_str())) {
            quantise(&mut file, name, levels, None).expect("a real tensor");
            let shape = &before.tensors[name].shape;
            let any = vec![None; shape.len()];
            let [was, is] = [&before, &file].map(|file| file.f32(name, &any).expect("a tensor").0);
            let scale = file.tensors[&format!("{name}.scale")].to_f32().expect("scales");
            let width = was.len() / scale.len();
            for (at, (was, is)) in was.iter().zip(&is).enumerate() {
                let step = scale[at / width];
                assert!((was - is).abs() <= HALF * step + 1e-12, "{name}, {levels} levels: {was} became {is}");
            }
            let greatest = was.iter().fold(0.0_f32, |most, value| most.max(value.abs()));
            assert!(scale.iter().all(|scale| *scale <= 1.0001 * greatest / levels as f32), "{name}: {levels} levels");
            assert_eq!(file.tensors.contains_key(&format!("{name}.fine")), levels > 127, "{name}: {levels} levels");
        }
    }
}

/// Bases are kept as differences from neighbours; what is read is the rounded basis all the same.
#[test]
fn a_basis_survives_being_foretold() {
    let before = HostModel::parse(ALL[1].model).expect("a model");
    let levels = [7, 127, 128, 1000, 4000, MOST_LEVELS];
    for (name, levels) in BASES.into_iter().flat_map(|name| levels.map(|levels| (name, levels))) {
        let of = |model: &HostModel| {
            let arrays = model.parameters();
            arrays.into_iter().find(|(array, _)| array == name).expect("a basis").1.clone()
        };
        let mut file = Tensors::parse(ALL[1].model).expect("a model").into_owned();
        let importance: Vec<f32> = (0..file.tensors[name].shape[0]).map(|row| (row % 3) as f32).collect();
        quantise(&mut file, name, levels, Some(&importance)).expect("a basis");
        let after = HostModel::read(&file).expect("a model");
        let scale = file.tensors[&format!("{name}.scale")].to_f32().expect("scales");
        for (at, (was, is)) in of(&before).iter().zip(&of(&after)).enumerate() {
            let row = at % importance.len();
            // A matrix that nothing multiplies needs no numbers.
            let wanted = if importance[row] == 0.0 { was.abs() } else { HALF * scale[row] };
            assert!((was - is).abs() <= wanted + 1e-12, "{name} {row}, {levels} levels: {was} became {is}");
        }
        let again = {
            let mut file = Tensors::parse(&file_bytes(file.clone())).expect("a file").into_owned();
            quantise(&mut file, name, levels, Some(&importance)).expect("a basis");
            HostModel::read(&file).expect("a model")
        };
        assert!(largest(&of(&again), &of(&after)) <= 1e-6, "{name} packed twice, {levels} levels");
    }
}

/// Files packed before 2026-11-28 are of version 1, and keep the mesh stream's basis as it is.
#[test]
fn a_file_of_version_1_has_no_differences_in_its_mesh_basis() {
    let small = packed(ALL[1].model, 500);
    assert!(small.metadata["ctsn"].contains("\"version\":2"));
    let whole = |file: &Tensors| file.whole(MESH_BASIS, &[None; 3]).expect("whole numbers").expect("whole numbers").0;
    let mut older = small.clone();
    let version = |text: &str| text.replace("\"version\":2", "\"version\":1");
    older.metadata.insert("ctsn".to_owned(), version(&small.metadata["ctsn"]));
    let [newer, older] = [&small, &older].map(|file| HostModel::read(file).expect("a model"));
    let scale = small.tensors["mesh.basis.scale"].to_f32().expect("scales");
    let (count, differences) = (scale.len(), whole(&small));
    let width = differences.len() / count;
    for (at, difference) in differences.iter().enumerate() {
        let (row, place) = (at / width, at % width);
        assert_eq!(older.mesh_basis[place * count + row], difference * scale[row]);
    }
    assert_ne!(older.mesh_basis, newer.mesh_basis);
}

#[test]
fn the_mesh_stream_stands_last_and_the_file_says_where() {
    let plain = HostModel::parse(ALL[1].model).expect("a model").to_bytes(Storage::F16);
    for bytes in [plain, packed_bytes(ALL[1].model, 500)] {
        let file = Tensors::parse(&bytes).expect("a model");
        let length = u64::from_le_bytes(bytes[..8].try_into().expect("8 bytes")) as usize;
        let coarse: usize = file.metadata["coarse"].parse().expect("a number");
        let at = |tensor: &Tensor| tensor.bytes.as_ptr() as usize - bytes.as_ptr() as usize - 8 - length;
        for (name, tensor) in &file.tensors {
            let folds = ["graph.", "vertex.", "mesh."].iter().any(|prefix| name.starts_with(prefix));
            assert_eq!(at(tensor) >= coarse, folds, "{name} at {} of {coarse}", at(tensor));
        }
        // What a page does with the part that has come: the rest is zero, and there is no mesh stream.
        let mut part = bytes.clone();
        part[8 + length + coarse..].fill(0);
        let [mut whole, mut part] = [&bytes, &part].map(|bytes| Predictor::new(bytes).expect("a model"));
        assert!(whole.model().mesh_stream && !part.model().mesh_stream);
        let pose = &ALL[1].read().poses[0];
        for one in [&mut whole, &mut part] {
            one.predict_row_major(pose, Streams::Skeleton).expect("a prediction");
        }
        assert_eq!(whole.positions(), part.positions());
        part.predict_row_major(pose, Streams::Both).expect("a prediction");
        assert!(part.positions().iter().all(|value| value.is_finite()));
    }
}

#[test]
fn a_packed_file_cut_at_any_tensor_is_refused() {
    let bytes = packed_bytes(ALL[0].model, 500);
    let file = Tensors::parse(&bytes).expect("a model");
    let ends = file.tensors.values().map(|tensor| tensor.bytes.as_ptr() as usize - bytes.as_ptr() as usize);
    for end in ends {
        let error = HostModel::parse(&bytes[..end]).expect_err("wanted a refusal");
        assert_eq!(error.kind(), "truncated", "{end} of {} bytes: {error}", bytes.len());
    }
}

/// What reading says of a packed model after a change to its tensors.
fn lie(change: impl FnOnce(&mut Tensors)) -> Result<HostModel> {
    let mut file = packed(ALL[0].model, 500);
    change(&mut file);
    HostModel::parse(&file.to_bytes())
}

#[test]
fn packed_tensors_that_lie_are_refused() {
    assert!(lie(|_| ()).is_ok());
    let file = packed(ALL[0].model, 500);
    let packed: Vec<_> =
        file.tensors.iter().filter(|(name, t)| t.dtype == Dtype::I8 && !name.ends_with(".fine")).collect();
    assert!(packed.len() > 10);
    let check = |found: Result<HostModel>, kind: &str, says: &str| {
        let error = found.err().unwrap_or_else(|| panic!("wanted {kind} with {says:?}, found a model"));
        assert_eq!(error.kind(), kind, "{error}");
        assert!(error.to_string().contains(says), "wanted {says:?} in {error}");
    };
    for (name, tensor) in packed {
        let [scale, fine] = ["scale", "fine"].map(|part| format!("{name}.{part}"));
        let put = |part: &String, tensor: Tensor<'static>| lie(|file| drop(file.tensors.insert(part.clone(), tensor)));
        check(lie(|file| drop(file.tensors.remove(&scale))), "missing_tensor", &scale);
        let rows = tensor.shape[0];
        check(put(&scale, Tensor::f32(&[rows + 1], &vec![1.0; rows + 1])), "shape", &scale);
        check(put(&scale, Tensor::f32(&[0], &[])), "shape", &scale);
        check(put(&scale, Tensor::f32(&[rows, 1], &vec![1.0; rows])), "shape", &scale);
        check(put(&scale, Tensor::i8(&[1], &[1])), "shape", &scale);
        check(put(&scale, Tensor::f32(&[1], &[f32::NAN])), "not_finite", name);
        check(put(&scale, Tensor::f32(&[1], &[f32::MAX])), "not_finite", name);
        check(put(&fine, Tensor::i8(&[1], &[1])), "shape", &fine);
        check(put(&fine, Tensor::f32(&tensor.shape, &vec![0.0; tensor.bytes.len()])), "shape", &fine);
    }
    for name in ["cloth.triangles", "reference.index"] {
        let shape = file.tensors[name].shape.clone();
        let count = shape.iter().product();
        let found = lie(|file| drop(file.tensors.insert(name.to_owned(), Tensor::narrow(&shape, &vec![200; count]))));
        check(found, "index", name);
        let found = lie(|file| drop(file.tensors.insert(name.to_owned(), Tensor::i8(&shape, &vec![1; count]))));
        check(found, "shape", "U32, U16 or U8");
    }
}

#[test]
fn flipped_packed_files_are_refused_or_finite() {
    let whole = packed_bytes(ALL[0].model, 500);
    let mut random = fastrand::Rng::with_seed(25);
    let (mut refused, mut finite) = (0, 0);
    for round in 0..2000 {
        let mut bytes = whole.clone();
        let place = if round % 3 == 0 { random.usize(8..2500) } else { random.usize(2500..whole.len()) };
        bytes[place] ^= 1 << random.u8(0..8);
        match Predictor::new(&bytes) {
            Ok(mut predictor) => {
                let pose = pose(predictor.sizes().joints);
                finite += usize::from(predict(&mut predictor, &pose));
            }
            Err(_) => refused += 1,
        }
    }
    assert!(refused > 200 && finite > 200, "{refused} refused, {finite} finite");
}

#[test]
fn a_mesh_basis_of_zeros_packs_to_none() {
    let mut model = HostModel::parse(ALL[0].model).expect("a model");
    model.mesh_basis.fill(0.0);
    let small = HostModel::read(&packed(&model.to_bytes(Storage::F32), 500)).expect("a packed model");
    assert!(!small.mesh_stream && !HostModel::read(&packed(ALL[0].model, 500)).is_ok_and(|model| !model.mesh_stream));
    assert_eq!(Tensors::parse(&model.to_bytes(Storage::F16)).expect("a model").tensors[MESH_BASIS].dtype, Dtype::F16);
}
