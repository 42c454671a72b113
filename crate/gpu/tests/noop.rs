//! wgpu's noop backend validates every command, at WebGPU's default limits, without any GPU.

use ctsn_core::Streams;
use ctsn_core::model::HostModel;
use ctsn_gpu::{Gpu, Model, Predictor, wgpu};
use pollster::block_on;

const SMALL: &[u8] = include_bytes!("../../../tests/golden/small.safetensors");

#[test]
fn a_recorded_frame_is_accepted_at_default_limits() {
    let limits = wgpu::Limits::default();
    let descriptor = wgpu::DeviceDescriptor { required_limits: limits.clone(), ..Default::default() };
    let (device, queue) = wgpu::Device::noop(&descriptor);
    assert_eq!(device.limits(), limits);
    assert_eq!(limits.max_storage_buffers_per_shader_stage, 8);
    let gpu = Gpu::from_device(device.clone(), queue.clone());
    let model = HostModel::parse(SMALL).expect("golden model");
    let model = block_on(Model::new(&gpu, &model)).expect("a recorded model");
    let mut predictor = block_on(Predictor::new(&model)).expect("a predictor");
    let pose = vec![0.5; 12 * model.sizes().joints];
    let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
    for streams in [Streams::Both, Streams::Skeleton, Streams::None] {
        predictor.predict_row_major(&pose, streams).expect("a frame");
    }
    block_on(predictor.read()).expect("a read-back");
    assert!(block_on(scope.pop()).is_none());
    // And it does refuse: a buffer larger than the limits.
    let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let _refused = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: limits.max_buffer_size + 4,
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    });
    assert!(block_on(scope.pop()).is_some());
    drop((predictor, model, gpu));
    // A lent device lives on.
    queue.submit([device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default()).finish()]);
    assert!(device.poll(wgpu::PollType::wait_indefinitely()).is_ok());
}
