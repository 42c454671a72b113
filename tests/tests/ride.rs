//! A drawn mesh that rides on the cloth: where it is, on both devices, and in the file.
#![cfg(feature = "machine")]

use ctsn_core::cpu::Level;
use ctsn_core::file::Tensors;
use ctsn_core::model::pack::{packable, quantise};
use ctsn_core::model::{HostModel, Storage};
use ctsn_core::{Predictor, Streams};
use ctsn_gpu::Gpu;
use ctsn_tests::finite::largest;
use ctsn_tests::{layered, random};
use fastrand::Rng;
use pollster::block_on;

/// Largest difference allowed between devices, metres.
const TOLERANCE: f32 = 1e-4;

fn on_gpu(gpu: &Gpu, model: &HostModel) -> ctsn_gpu::Predictor {
    let model = block_on(ctsn_gpu::Model::new(gpu, model)).expect("a model");
    block_on(ctsn_gpu::Predictor::new(&model)).expect("a predictor")
}

#[test]
fn two_layers_with_pockets_are_the_same_on_both_devices() {
    let mut rng = Rng::with_seed(11);
    let model = layered::model(&mut rng);
    let surface = model.surface.as_ref().expect("a surface");
    let riders = model.ride.as_ref().expect("riders").corners.len() / 3;
    assert!((model.sizes.vertices, riders) == (4000, 21_338) && surface.vertex.len() > riders);
    let mut on_cpu = Predictor::from_model(model.clone(), Level::new());
    // Vertices that meet in one place, side by side as they are drawn.
    let split = |values: &[f32]| -> Vec<f32> {
        surface.vertex.iter().flat_map(|vertex| &values[3 * *vertex as usize..][..3]).copied().collect()
    };
    for software in [true, false] {
        let gpu = block_on(Gpu::new()).expect("a Vulkan adapter (Debian: mesa-vulkan-drivers)");
        let mut on_gpu = on_gpu(&gpu.treated_as_software(software), &model);
        for streams in [Streams::Both, Streams::Skeleton, Streams::None] {
            let pose = random::pose(&mut rng, 2);
            on_cpu.predict_row_major(&pose, streams).expect("a pose");
            on_gpu.predict_row_major(&pose, streams).expect("a pose");
            let shown = block_on(on_gpu.read_shown()).expect("a prediction");
            let off = largest(&shown.positions, on_cpu.shown_positions());
            assert!(off <= TOLERANCE, "{streams:?}: {off:e}");
            let drawn = block_on(on_gpu.read_drawn()).expect("a prediction");
            assert_eq!(drawn.positions.len(), 3 * surface.vertex.len());
            // Where cloth is crumpled, the normals around a vertex nearly cancel out, and what is left of them turns.
            let parts = [
                (&drawn.positions, split(on_cpu.shown_positions()), TOLERANCE),
                (&drawn.normals, split(on_cpu.shown_normals()), 100.0 * TOLERANCE),
            ];
            for (found, wanted, tolerance) in parts {
                let off = largest(found, &wanted);
                assert!(off <= tolerance, "{streams:?}: {off:e}");
            }
        }
    }
}

#[test]
fn riders_keep_their_distance_from_the_cloth() {
    let mut rng = Rng::with_seed(12);
    let model = layered::model(&mut rng);
    let ride = model.ride.clone().expect("riders");
    let mut predictor = Predictor::from_model(model, Level::new());
    predictor.predict_row_major(&random::pose(&mut rng, 2), Streams::None).expect("a pose");
    let cloth = predictor.positions().as_chunks::<3>().0;
    let riders = predictor.shown_positions().as_chunks::<3>().0;
    let each = riders.iter().zip(ride.corners.as_chunks::<3>().0).zip(ride.coordinates.as_chunks::<4>().0);
    for ((rider, corners), [u, v, w, offset]) in each {
        let [a, b, c] = corners.map(|corner| cloth[corner as usize]);
        let away = (0..3).map(|k| rider[k] - (u * a[k] + v * b[k] + w * c[k])).map(|gap| gap * gap).sum::<f32>().sqrt();
        assert!((away - offset.abs()).abs() < 1e-5, "{away} m away, wanted {offset}");
    }
    // The layers' normals are those of their triangles, which look one way.
    let outer = predictor.shown_normals()[..3].to_vec();
    let lining = &predictor.shown_normals()[3 * 150 * 70..][..3];
    assert!(outer.iter().zip(lining).map(|(a, b)| a * b).sum::<f32>() > 0.9);
}

#[test]
fn cloth_that_rides_on_itself_is_where_it_was() {
    let mut rng = Rng::with_seed(13);
    let plain = HostModel { ride: None, surface: None, ..layered::model(&mut rng) };
    let itself = layered::itself(&plain);
    let pose = random::pose(&mut rng, 2);
    let mut predictors = [plain, itself].map(|model| Predictor::from_model(model, Level::new()));
    for predictor in &mut predictors {
        predictor.predict_row_major(&pose, Streams::Both).expect("a pose");
    }
    let [plain, itself] = predictors;
    let pairs = [(plain.positions(), itself.shown_positions()), (plain.normals(), itself.shown_normals())];
    pairs.iter().for_each(|(plain, itself)| assert_eq!(plain, itself));
    assert_eq!(plain.triangles(), itself.shown_triangles());
}

#[test]
fn the_file_keeps_what_rides() {
    let model = layered::model(&mut Rng::with_seed(14));
    let read = HostModel::parse(&model.to_bytes(Storage::F32)).expect("a model");
    assert_eq!((&read.ride, &read.surface), (&model.ride, &model.surface));
    // A packed file keeps places and offsets as they are: they would not add up.
    let bytes = model.to_bytes(Storage::F32);
    let mut file = Tensors::parse(&bytes).expect("a file");
    let names = packable(&file);
    assert!(names.iter().any(|name| name == "cloth.rest"));
    names.iter().for_each(|name| quantise(&mut file, name, 127, None).expect("real numbers"));
    assert_eq!(HostModel::read(&file).expect("a model").ride, model.ride);
    let without = HostModel { ride: None, surface: None, ..model };
    let read = HostModel::parse(&without.to_bytes(Storage::F32)).expect("a model");
    assert_eq!((read.ride, read.surface), (None, None));
}
