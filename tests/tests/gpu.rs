//! The GPU device natively, by Vulkan. A machine without any adapter fails.
#![cfg(feature = "machine")]

use ctsn_core::cpu::{Cpu, Level};
use ctsn_core::model::{HostModel, Storage};
use ctsn_core::operation::Normals;
use ctsn_core::{Predictor, Shares, Streams};
use ctsn_gpu::Gpu;
use ctsn_tests::finite::largest;
use ctsn_tests::golden;
use ctsn_tests::random::{self, Shape};
use pollster::block_on;
use std::sync::Arc;

/// Largest difference allowed between devices, metres.
const TOLERANCE: f32 = 1e-4;

fn gpu() -> Gpu {
    let gpu = block_on(Gpu::new()).expect("a Vulkan adapter (Debian: mesa-vulkan-drivers)");
    println!("on {}", gpu.name());
    gpu
}

fn predictor(gpu: &Gpu, model: &HostModel) -> ctsn_gpu::Predictor {
    let model = block_on(ctsn_gpu::Model::new(gpu, model)).expect("a model");
    block_on(ctsn_gpu::Predictor::new(&model)).expect("a predictor")
}

/// The shaders for software adapters and those for all others.
fn both() -> [Gpu; 2] {
    [true, false].map(|software| gpu().treated_as_software(software))
}

#[test]
fn golden() {
    for (gpu, golden) in both().iter().flat_map(|gpu| golden::ALL.iter().map(move |golden| (gpu, golden))) {
        let expected = golden.read();
        let mut predictor = predictor(gpu, &golden.host_model());
        for (p, pose) in expected.poses.iter().enumerate() {
            predictor.predict_row_major(pose, Streams::Both).expect("a golden pose");
            let stages = block_on(predictor.stages()).expect("its stages");
            expected.compare(p, stages.iter().map(|(name, values)| (name.as_str(), values)));
        }
    }
}

/// n, J, m, k, C, d, L: no multiples of 4 or of a workgroup; one vertex; more heads than lanes; one head wider than a
/// workgroup.
const SHAPES: [[usize; 7]; 7] = [
    [1, 1, 1, 1, 1, 1, 1],
    [2, 2, 1, 2, 1, 3, 1],
    [67, 5, 7, 13, 3, 5, 2],
    [130, 3, 4, 8, 2, 33, 1],
    [257, 65, 31, 129, 5, 26, 3],
    [99, 2, 3, 5, 70, 1, 2],
    [50, 4, 2, 3, 1, 130, 2],
];

#[test]
fn parity_with_the_cpu_at_awkward_sizes() {
    let (both, mut rng) = (both(), fastrand::Rng::with_seed(3));
    // With a range that the poses leave, residuals fade; without, they count in full. The mesh stream sees the body
    // under the cloth, or the coarse cloth around each vertex.
    let kinds = [(true, false), (false, false), (true, true), (false, true)];
    let cases = || SHAPES.into_iter().flat_map(move |shape| kinds.map(|kind| (shape, kind)));
    for (gpu, (shape, (range, surrounded))) in both.iter().flat_map(|gpu| cases().map(move |case| (gpu, case))) {
        let [vertices, joints, embedding, basis, heads, per_head, layers] = shape;
        let shape = Shape { vertices, joints, embedding, basis, heads, per_head, layers };
        let mut model = random::model(&mut rng, shape);
        if surrounded {
            model = random::surrounded(&mut rng, model);
        }
        let rig = Arc::make_mut(&mut model.rig);
        rig.range = rig.range.take().filter(|_| range);
        if vertices > 60 {
            let degrees: Vec<usize> = (0..vertices).map(|i| model.graph.of(i).len()).collect();
            assert!([0, 1, 40].iter().all(|degree| degrees.contains(degree)), "{degrees:?}");
        }
        let mut on_cpu = Predictor::from_model(model.clone(), Level::new());
        let mut on_gpu = predictor(gpu, &model);
        for streams in [Streams::Both, Streams::Skeleton, Streams::None, Streams::Both] {
            let pose = random::column_major(&random::pose(&mut rng, joints));
            let shares = Shares { skeleton: 1.0, mesh: rng.f32() };
            on_cpu.predict_faded(&pose, streams, shares).expect("a pose");
            on_gpu.predict_faded(&pose, streams, shares.mesh).expect("a pose");
            let found = block_on(on_gpu.read()).expect("a prediction");
            assert_eq!(on_gpu.confidence(), on_cpu.confidence());
            assert_eq!(found.positions.len(), 3 * vertices);
            let error = largest(&found.positions, on_cpu.positions());
            assert!(error <= TOLERANCE, "{shape:?} {streams:?}: positions {error:e}");
            let mut wanted = vec![0.0; 3 * vertices];
            let (positions, triangles, normals) = (&found.positions[..], &model.triangles[..], &mut wanted[..]);
            Cpu::new().compute(Normals { positions, triangles, normals });
            let error = largest(&found.normals, &wanted);
            assert!(error <= 1e-3, "{shape:?} {streams:?}: normals {error:e}");
            let drawn = block_on(on_gpu.read_drawn()).expect("a prediction");
            let surface = model.surface.as_ref().expect("a surface");
            for (i, vertex) in surface.vertex.iter().enumerate() {
                let (i, vertex) = (3 * i..3 * i + 3, 3 * *vertex as usize..3 * *vertex as usize + 3);
                assert_eq!(drawn.positions[i.clone()], found.positions[vertex.clone()]);
                assert_eq!(drawn.normals[i], found.normals[vertex]);
            }
        }
    }
}

/// Largest difference; a NaN wins.
#[test]
fn a_mesh_stream_that_adds_nothing_is_not_computed() {
    let (mut rng, gpu) = (fastrand::Rng::with_seed(5), gpu());
    let shape = Shape { vertices: 99, joints: 4, embedding: 3, basis: 1, heads: 1, per_head: 4, layers: 1 };
    let mut model = random::model(&mut rng, shape);
    model.mesh_basis.fill(0.0);
    // The skeleton stream alone is not polished.
    model.cut = None;
    let left_out = HostModel::parse(&model.to_bytes(Storage::F32)).expect("a model");
    let computed = HostModel { mesh_stream: true, ..left_out.clone() };
    let dispatches = |model: &HostModel, streams| {
        let model = block_on(ctsn_gpu::Model::new(&gpu, model)).expect("a model");
        model.stages(streams).iter().map(|stage| stage.dispatches).sum::<usize>()
    };
    assert_eq!(dispatches(&left_out, Streams::Both), dispatches(&computed, Streams::Skeleton));
    let pose = random::pose(&mut rng, shape.joints);
    let predict = |model: &HostModel| {
        let mut predictor = Predictor::from_model(model.clone(), Level::new());
        predictor.predict_row_major(&pose, Streams::Both).expect("a pose");
        predictor.positions().to_vec()
    };
    let mut on_gpu = predictor(&gpu, &left_out);
    on_gpu.predict_row_major(&pose, Streams::Both).expect("a pose");
    let found = block_on(on_gpu.read()).expect("a prediction").positions;
    assert_eq!(predict(&left_out), predict(&computed));
    assert!(largest(&found, &predict(&computed)) <= TOLERANCE);
    assert!(block_on(on_gpu.stages()).expect("its stages").iter().all(|(name, _)| name != "mesh"));
}

#[test]
fn a_frame_is_less_than_twenty_dispatches() {
    let gpu = gpu();
    let mut model = golden::ALL[1].host_model();
    assert_eq!((model.layers.len(), model.embedding.len(), model.vertex_mlp.len()), (3, 3, 2));
    let count = |model: &HostModel| -> usize {
        let model = block_on(ctsn_gpu::Model::new(&gpu, model)).expect("a model");
        model.stages(Streams::Both).iter().map(|stage| stage.dispatches).sum()
    };
    assert_eq!(count(&model), 18);
    model.surface = Some(ctsn_core::model::Surface { vertex: vec![0, 0], uv: vec![0.0; 4], triangles: vec![] });
    assert_eq!(count(&model), 19);
}

#[test]
fn stages_are_timed_and_costed() {
    for gpu in both() {
        assert!(gpu.has_timestamps(), "{} has no timestamps", gpu.name());
        let predictor = predictor(&gpu, &golden::ALL[1].host_model());
        let stages = predictor.model().stages(Streams::Both);
        let times = block_on(predictor.time_stages(Streams::Both).expect("timestamps")).expect("times");
        assert_eq!(times.len(), stages.len());
        let names: Vec<&str> = stages.iter().map(|stage| stage.name.as_str()).collect();
        let layers = ["layer.0", "layer.1", "layer.2"];
        let first = ["body_frame", "embedding", "skeleton", "reference"];
        assert_eq!(names, [&first[..], &layers, &["mesh", "positions", "normals"]].concat());
        println!("software {}: {:?} ms", gpu.is_software(), names.iter().zip(&times).collect::<Vec<_>>());
        assert!(times.iter().all(|time| *time > 0.0 && time.is_finite()), "{times:?}");
        // The second layer's products alone: 600 vertices, 64 features in, four times as many out.
        assert!(stages[5].cost.flops > 2.0 * 600.0 * 64.0 * 256.0, "{:?}", stages[5]);
        assert!(stages.iter().all(|stage| stage.cost.bytes > 0.0));
    }
}

#[test]
fn bad_poses_are_refused_and_overflow_is_found() {
    let gpu = gpu();
    let golden = &golden::ALL[0];
    let expected = golden.read();
    let mut predictor = predictor(&gpu, &golden.host_model());
    let kind = |result: ctsn_gpu::Result<()>| result.expect_err("wanted a refusal").kind();
    assert_eq!(kind(predictor.predict_row_major(&[0.0; 35], Streams::Both)), "joint_count");
    assert_eq!(kind(predictor.predict(&[f32::NAN; 48], Streams::Both)), "not_finite");
    predictor.predict_row_major(&[f32::MAX; 36], Streams::Both).expect("submitted");
    assert_eq!(block_on(predictor.read()).expect_err("wanted a refusal").kind(), "not_finite");
    predictor.predict_row_major(&expected.poses[0], Streams::Both).expect("a golden pose");
    block_on(predictor.read()).expect("the model lives on");
}

#[test]
fn what_the_device_does_not_allow_is_refused() {
    let gpu = gpu().treated_as_software(false);
    let shape = Shape { vertices: 3, joints: 1, embedding: 1, basis: 1, heads: 1, per_head: 2049, layers: 1 };
    let model = random::model(&mut fastrand::Rng::with_seed(1), shape);
    let error = block_on(ctsn_gpu::Model::new(&gpu, &model)).err().expect("wanted a refusal");
    assert_eq!(error.to_string(), "features of a graph layer: wanted 2049, the device allows 2048");
}

#[test]
fn a_lost_device_is_reported() {
    let gpu = gpu();
    let golden = &golden::ALL[0];
    let pose = &golden.read().poses[0];
    let mut predictor = predictor(&gpu, &golden.host_model());
    let read = predictor.read();
    gpu.device().destroy();
    block_on(read).map(drop).unwrap_or_else(|error| assert_eq!(error.kind(), "lost"));
    // The device says so when it is next asked for anything.
    drop(gpu.device().poll(ctsn_gpu::wgpu::PollType::Poll));
    let error = predictor.predict_row_major(pose, Streams::Both).expect_err("wanted a refusal");
    assert_eq!(error.kind(), "lost", "{error}");
    assert!(gpu.lost().is_some());
    let error = block_on(ctsn_gpu::Model::new(&gpu, &golden.host_model())).err().expect("wanted a refusal");
    assert_eq!(error.kind(), "lost", "{error}");
}

#[test]
fn models_come_and_go_without_a_trace() {
    let gpu = gpu();
    let golden = &golden::ALL[0];
    let (model, pose) = (golden.host_model(), &golden.read().poses[0]);
    let round = || {
        let mut predictor = predictor(&gpu, &model);
        predictor.predict_row_major(pose, Streams::Both).expect("a golden pose");
        block_on(predictor.read()).expect("a prediction");
        drop(predictor);
        gpu.device().poll(ctsn_gpu::wgpu::PollType::wait_indefinitely()).expect("a poll");
        gpu.device().generate_allocator_report().expect("Vulkan reports").total_allocated_bytes
    };
    let after_one = round();
    let most = (0..20).map(|_| round()).max();
    assert_eq!(most, Some(after_one));
}
