//! One operation by itself, for tests.

use crate::predictor::{Step, buffers};
use crate::read::Reader;
use crate::recorder::Recorder;
use crate::{Gpu, Result, pack};
use ctsn_core::device::Device;
use ctsn_core::operation::Operation;
use std::cell::RefCell;

/// Runs one operation on `gpu`: uploads its operands, and replaces those it writes, unless this device leaves them as
/// they are.
///
/// # Errors
/// [`Error::Limit`](crate::Error::Limit), [`Error::OutOfMemory`](crate::Error::OutOfMemory),
/// [`Error::Lost`](crate::Error::Lost).
pub async fn evaluate(gpu: &Gpu, operation: &mut Operation<Vec<f32>, Vec<f32>, Vec<u32>>) -> Result<()> {
    let mut written = Vec::new();
    let run = || {
        let recorder = RefCell::new(Recorder::new(gpu));
        let mut recorded = operation.lend().map(
            |values| recorder.borrow_mut().constant(values),
            |values| {
                let id = recorder.borrow_mut().activation("operation", values.len());
                written.push((id, values));
                id
            },
            |values| recorder.borrow_mut().index(values),
        );
        let mut recorder = recorder.into_inner();
        recorder.run(recorded.lend());
        let frame = recorder.take()?;
        let buffers = buffers(gpu, &recorder.rooms, |_| false);
        let written = written.into_iter().filter_map(|(id, values)| Some((recorder.room(id)?, values)));
        let written: Vec<_> =
            written.map(|(room, values)| (recorder.rooms[room].clone(), &buffers[room], values)).collect();
        for (room, buffer, values) in &written {
            let packed = pack::strided(values, room.columns, room.stride);
            gpu.queue().write_buffer(buffer, 0, bytemuck::cast_slice(&packed));
        }
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        for dispatch in &frame {
            Step::new(gpu, dispatch, &recorder.constants, &buffers).encode(&mut pass);
        }
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
        let results: Vec<&wgpu::Buffer> = written.iter().map(|(_, buffer, _)| *buffer).collect();
        let read = Reader::default().read::<f32>(gpu, &results);
        Ok((read, written.into_iter().map(|(room, _, values)| (room, values)).collect::<Vec<_>>()))
    };
    let (read, written) = gpu.scoped(run).await?;
    for ((room, values), found) in written.into_iter().zip(read.await?) {
        *values = room.unpad(&found);
    }
    Ok(())
}
