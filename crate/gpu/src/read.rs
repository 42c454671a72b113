//! Read-back: copies into buffers the host may map, which are kept and used again.

use crate::{Error, Gpu, Result};
use futures_channel::oneshot;
use std::sync::{Arc, Mutex, PoisonError};

/// Buffers for reading that no read uses at present.
#[derive(Clone, Default)]
pub(crate) struct Reader(Arc<Mutex<Vec<wgpu::Buffer>>>);

impl Reader {
    /// Orders a copy of `buffers` as they are after all that was submitted; their content, once it is there.
    pub fn read<T: bytemuck::Pod>(
        &self,
        gpu: &Gpu,
        buffers: &[&wgpu::Buffer],
    ) -> impl Future<Output = Result<Vec<Vec<T>>>> + use<T> {
        let sizes: Vec<u64> = buffers.iter().map(|buffer| buffer.size()).collect();
        let staging = self.take(gpu, sizes.iter().sum());
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut offset = 0;
        for (buffer, size) in buffers.iter().zip(&sizes) {
            encoder.copy_buffer_to_buffer(buffer, 0, &staging, offset, *size);
            offset += size;
        }
        let (sender, receiver) = oneshot::channel();
        encoder.map_buffer_on_submit(&staging, wgpu::MapMode::Read, 0..offset, move |result| {
            // A receiver that is gone wants no answer.
            drop(sender.send(result));
        });
        gpu.queue().submit([encoder.finish()]);
        let (this, gpu) = (self.clone(), gpu.clone());
        async move {
            // In a browser this does nothing: the event loop brings the answer.
            if let Err(error) = gpu.device().poll(wgpu::PollType::wait_indefinitely()) {
                return Err(Error::Lost(error.to_string()));
            }
            let lost = |reason: String| Error::Lost(gpu.lost().unwrap_or(reason));
            match receiver.await {
                Ok(Ok(())) => {}
                Ok(Err(error)) => return Err(lost(error.to_string())),
                Err(oneshot::Canceled) => return Err(lost("a read was dropped".to_owned())),
            }
            let mapped = staging.get_mapped_range(..offset).map_err(|error| lost(error.to_string()))?;
            let mut rest: &[u8] = &mapped;
            let mut results = Vec::with_capacity(sizes.len());
            for size in sizes {
                let (one, others) = rest.split_at(size as usize);
                results.push(bytemuck::pod_collect_to_vec(one));
                rest = others;
            }
            drop(mapped);
            staging.unmap();
            this.give(staging);
            Ok(results)
        }
    }

    /// A buffer of at least `size` bytes.
    fn take(&self, gpu: &Gpu, size: u64) -> wgpu::Buffer {
        let mut free = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = free.iter().position(|buffer| buffer.size() >= size) {
            return free.swap_remove(found);
        }
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let descriptor = wgpu::BufferDescriptor { label: Some("read-back"), size, usage, mapped_at_creation: false };
        gpu.device().create_buffer(&descriptor)
    }

    fn give(&self, buffer: wgpu::Buffer) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(buffer);
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        // The last one frees what is left; in a browser dropping alone frees nothing.
        if Arc::strong_count(&self.0) == 1 {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).iter().for_each(wgpu::Buffer::destroy);
        }
    }
}
