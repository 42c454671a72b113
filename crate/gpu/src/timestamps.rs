//! Stages timed by the GPU's own clock, where the adapter has one.

use crate::cost::stages;
use crate::{Error, Predictor, Result};
use ctsn_core::Streams;

impl Predictor {
    /// Runs the last pose once more, each dispatch in a pass of its own, and times the stages: milliseconds each, in
    /// the order of [`crate::Model::stages`]. Slower than a frame, whose dispatches share one pass.
    ///
    /// # Errors
    /// [`Error::Missing`] without timestamps; [`Error::Lost`].
    pub fn time_stages(&self, streams: Streams) -> Result<impl Future<Output = Result<Vec<f64>>> + use<>> {
        let (gpu, steps) = (self.model.gpu(), self.steps(streams));
        if !gpu.has_timestamps() {
            return Err(Error::Missing("timestamps"));
        }
        gpu.check()?;
        let count = 2 * steps.len() as u32;
        let device = gpu.device();
        let query_set = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("stages"),
            ty: wgpu::QueryType::Timestamp,
            count,
        });
        let resolved = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("stages"),
            size: 8 * u64::from(count),
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for (i, step) in (0..).zip(steps) {
            let timestamp_writes = Some(wgpu::ComputePassTimestampWrites {
                query_set: &query_set,
                beginning_of_pass_write_index: Some(2 * i),
                end_of_pass_write_index: Some(2 * i + 1),
            });
            let descriptor = wgpu::ComputePassDescriptor { label: None, timestamp_writes };
            step.encode(&mut encoder.begin_compute_pass(&descriptor));
        }
        encoder.resolve_query_set(&query_set, 0..count, &resolved, 0);
        gpu.queue().submit([encoder.finish()]);
        let read = self.reader.read::<u64>(gpu, &[&resolved]);
        let milliseconds = f64::from(gpu.queue().get_timestamp_period()) * 1e-6;
        let (stages, index) = stages(self.model.0.frame(streams));
        Ok(async move {
            let stamps = read.await?.pop().unwrap_or_default();
            let mut times = vec![0.0; stages.len()];
            for (stage, stamps) in index.into_iter().zip(stamps.as_chunks::<2>().0) {
                times[stage] += stamps[1].saturating_sub(stamps[0]) as f64 * milliseconds;
            }
            resolved.destroy();
            Ok(times)
        })
    }
}
