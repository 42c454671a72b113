//! A GPU: device and queue, made by us or lent to us, with one pipeline per shader.

use crate::{Error, Result};
use ctsn_shaders::{self as shaders, Access, Shader};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A device that models are loaded on; clones are the same device.
#[derive(Clone)]
pub struct Gpu {
    inner: Arc<Inner>,
    software: bool,
}

struct Inner {
    device: wgpu::Device,
    queue: wgpu::Queue,
    name: String,
    own: bool,
    /// Why the device is gone, once it is.
    loss: Arc<Mutex<Option<String>>>,
    pipelines: Mutex<HashMap<(&'static str, Option<u32>), Pipeline>>,
}

/// A compiled shader.
#[derive(Clone)]
pub(crate) struct Pipeline {
    pub pipeline: wgpu::ComputePipeline,
    pub layout: wgpu::BindGroupLayout,
}

/// A lock is only ever held for a few assignments, so what it guards is whole even after a panic elsewhere.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn lose(loss: &Mutex<Option<String>>, reason: String) {
    lock(loss).get_or_insert(reason);
}

impl Gpu {
    /// A device of our own on the machine's (or page's) best adapter.
    ///
    /// # Errors
    /// [`Error::NoAdapter`], [`Error::NoDevice`].
    pub async fn new() -> Result<Self> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        Self::request(&instance, true).await
    }

    /// The device that `instance` hands out, lent: it is never destroyed by us. For a page whose adapter resolves to
    /// the page's own `GPUDevice`.
    ///
    /// # Errors
    /// [`Error::NoAdapter`], [`Error::NoDevice`].
    pub async fn from_instance(instance: &wgpu::Instance) -> Result<Self> {
        Self::request(instance, false).await
    }

    /// A lent device. Who lends it hears of its loss and of its errors; this crate sets no handlers and never destroys
    /// it.
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        Self::wrap(device, queue, false)
    }

    async fn request(instance: &wgpu::Instance, own: bool) -> Result<Self> {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = instance.request_adapter(&options).await.map_err(|error| Error::NoAdapter(error.to_string()))?;
        let allowed = adapter.limits();
        // WebGPU's defaults are enough for everything but the size of large models.
        let required_limits = wgpu::Limits {
            max_buffer_size: allowed.max_buffer_size,
            max_storage_buffer_binding_size: allowed.max_storage_buffer_binding_size,
            ..wgpu::Limits::default()
        };
        let descriptor = wgpu::DeviceDescriptor {
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits,
            ..Default::default()
        };
        let refused = |error: wgpu::RequestDeviceError| Error::NoDevice {
            adapter: adapter.get_info().name,
            reason: error.to_string(),
        };
        let (device, queue) = adapter.request_device(&descriptor).await.map_err(refused)?;
        let gpu = Self::wrap(device, queue, own);
        let loss = gpu.inner.loss.clone();
        gpu.inner.device.set_device_lost_callback(move |reason, message| lose(&loss, format!("{reason:?}: {message}")));
        if own {
            // What nobody asked about, such as memory running out in a frame, must not end the process.
            let loss = gpu.inner.loss.clone();
            gpu.inner.device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| lose(&loss, error.to_string())));
        }
        Ok(gpu)
    }

    fn wrap(device: wgpu::Device, queue: wgpu::Queue, own: bool) -> Self {
        let info = device.adapter_info();
        let name = if info.name.is_empty() { info.backend.to_string() } else { info.name };
        let software = info.device_type == wgpu::DeviceType::Cpu;
        let (loss, pipelines) = (Arc::default(), Mutex::default());
        Self { inner: Arc::new(Inner { device, queue, name, own, loss, pipelines }), software }
    }

    /// Name of the adapter, or of its interface where that is kept secret.
    pub fn name(&self) -> &str {
        &self.inner.name
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.inner.device
    }

    /// Its queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.inner.queue
    }

    /// Whether the adapter computes on the processor: models loaded on this handle then use shaders without barriers.
    pub fn is_software(&self) -> bool {
        self.software
    }

    /// This device with the shaders meant for a software adapter, or for none: so that one machine can test both.
    pub fn treated_as_software(&self, software: bool) -> Self {
        Self { inner: self.inner.clone(), software }
    }

    /// Whether stages can be timed.
    pub fn has_timestamps(&self) -> bool {
        self.inner.device.features().contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// Why the device is lost, if it is.
    pub fn lost(&self) -> Option<String> {
        lock(&self.inner.loss).clone()
    }

    /// [`Error::Lost`] once the device is lost.
    pub(crate) fn check(&self) -> Result<()> {
        self.lost().map_or(Ok(()), |reason| Err(Error::Lost(reason)))
    }

    /// Runs `work`, whose commands the device may refuse: then that is the answer.
    pub(crate) async fn scoped<T>(&self, work: impl FnOnce() -> Result<T>) -> Result<T> {
        self.check()?;
        let scopes = [wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::Internal]
            .map(|filter| self.inner.device.push_error_scope(filter));
        let result = work();
        // The scopes are a stack: all leave it at once, last in, first out.
        let errors: Vec<_> = scopes.into_iter().rev().map(wgpu::ErrorScopeGuard::pop).collect();
        for error in errors {
            if let Some(error) = error.await {
                return Err(error.into());
            }
        }
        result
    }

    /// The compiled shader, compiled at its first use.
    pub(crate) fn pipeline(&self, shader: &'static Shader, room: Option<u32>) -> Pipeline {
        let compiled = || compile(&self.inner.device, shader, room);
        lock(&self.inner.pipelines).entry((shader.name, room)).or_insert_with(compiled).clone()
    }
}

fn compile(device: &wgpu::Device, shader: &Shader, room: Option<u32>) -> Pipeline {
    let label = Some(shader.name);
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label,
        source: wgpu::ShaderSource::Wgsl(shader.source().into()),
    });
    let storage =
        shader.bindings.iter().map(|access| wgpu::BufferBindingType::Storage { read_only: *access == Access::Read });
    let kinds = std::iter::once(wgpu::BufferBindingType::Uniform).chain(storage);
    let entry = |(binding, ty)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    };
    let entries: Vec<_> = (0..).zip(kinds).map(entry).collect();
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
    let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label,
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    let constants: Vec<_> = room.map(|room| (shaders::ROOM, f64::from(room))).into_iter().collect();
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label,
        layout: Some(&pipeline_layout),
        module: &module,
        entry_point: Some(shader.entry()),
        // No shader reads workgroup memory that it did not write.
        compilation_options: wgpu::PipelineCompilationOptions {
            constants: &constants,
            zero_initialize_workgroup_memory: false,
        },
        cache: None,
    });
    Pipeline { pipeline, layout }
}

impl Drop for Inner {
    fn drop(&mut self) {
        // In a browser dropping alone frees nothing.
        if self.own {
            self.device.destroy();
        }
    }
}
