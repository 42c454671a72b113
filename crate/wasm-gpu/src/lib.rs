//! The boundary to JavaScript of `ctsn_gpu`, a module of its own beside that of `crate/wasm`, with a memory of its own.
//! What takes time is a promise that borrows nothing, so that JavaScript may call and free these objects meanwhile. The
//! other side of it is `web/src/raw-gpu.ts`, the one file that imports this module's glue.
// On other targets there is no JavaScript.
#![cfg(target_arch = "wasm32")]

use ctsn_core::Streams;
use ctsn_core::model::HostModel;
use ctsn_gpu::Error;
use js_sys::futures::future_to_promise;
use js_sys::{Array, Float32Array, Promise};
use wasm_bindgen::prelude::*;

/// The network's streams by their numbers in `crate/wasm`.
const STREAMS: [Streams; 3] = [Streams::Both, Streams::Skeleton, Streams::None];

/// A JavaScript `Error` whose `name` is the stable code of the core or of the GPU device.
fn to_js(error: &Error) -> js_sys::Error {
    let js = js_sys::Error::new(&error.to_string());
    js.set_name(error.kind());
    js
}

/// A promise of the outcome of `work`. It rejects with a JavaScript `Error` whose `name` is a stable code.
fn promise<T: Into<JsValue>>(work: impl Future<Output = ctsn_gpu::Result<T>> + 'static) -> Promise {
    future_to_promise(async move { work.await.map(Into::into).map_err(|error| to_js(&error).into()) })
}

/// Has a panic, which would be a fault of ours, reported on the console with its place in the source.
#[wasm_bindgen(start)]
pub fn start() {
    console_error_panic_hook::set_once();
}

/// A device of the page, with the pipelines compiled on it.
#[wasm_bindgen]
pub struct Gpu(ctsn_gpu::Gpu);

#[wasm_bindgen]
impl Gpu {
    /// Borrows the device that `navigator.gpu` hands out during this very call: wgpu reads that property only here.
    #[wasm_bindgen(unchecked_return_type = "Promise<Gpu>")]
    pub fn adopt() -> Promise {
        let instance = ctsn_gpu::wgpu::Instance::new(ctsn_gpu::wgpu::InstanceDescriptor::new_without_display_handle());
        promise(async move { ctsn_gpu::Gpu::from_instance(&instance).await.map(Self) })
    }
}

/// A model's weights on a device, shared by its predictors.
#[wasm_bindgen]
pub struct GpuModel(ctsn_gpu::Model);

#[wasm_bindgen]
impl GpuModel {
    /// Reads a model file and uploads its weights; `polish`: steps of the polish, if not the file's own number.
    #[wasm_bindgen(unchecked_return_type = "Promise<GpuModel>")]
    pub fn load(gpu: &Gpu, bytes: &[u8], polish: Option<usize>) -> Promise {
        let (gpu, model) = (gpu.0.clone(), HostModel::parse(bytes).map(|model| model.polish(polish)));
        promise(async move { ctsn_gpu::Model::new(&gpu, &model?).await.map(Self) })
    }

    /// Room for one cloth, warmed up.
    #[wasm_bindgen(unchecked_return_type = "Promise<GpuPredictor>")]
    pub fn predictor(&self) -> Promise {
        let model = self.0.clone();
        promise(async move { ctsn_gpu::Predictor::new(&model).await.map(GpuPredictor) })
    }
}

/// One cloth on a device. Freeing it destroys its buffers.
#[wasm_bindgen]
pub struct GpuPredictor(ctsn_gpu::Predictor);

#[wasm_bindgen]
impl GpuPredictor {
    /// Submits the prediction for the joint world matrices `pose` [16·J], column-major, metres, with
    /// that share of the mesh stream's residual.
    ///
    /// # Errors
    /// A JavaScript `Error` whose `name` is the code of what is wrong with the pose or the device.
    pub fn predict(&mut self, pose: &[f32], streams: usize, mesh: f32) -> Result<(), js_sys::Error> {
        self.0.predict_faded(pose, STREAMS[streams], mesh).map_err(|error| to_js(&error))
    }

    /// How much of the network's folds the prediction last submitted shows, as on the processor.
    pub fn confidence(&self) -> f32 {
        self.0.confidence()
    }

    /// The last prediction, read back: positions and normals, each [3·n].
    #[wasm_bindgen(unchecked_return_type = "Promise<[Float32Array, Float32Array]>")]
    pub fn read(&self) -> Promise {
        let read = self.0.read_shown();
        promise(async move {
            let prediction = read.await?;
            let arrays = [prediction.positions, prediction.normals].map(|values| Float32Array::from(values.as_slice()));
            Ok(arrays.into_iter().collect::<Array>())
        })
    }

    /// Four buffers: positions of the shown mesh's vertices [3·n] and of the drawn ones [3·d], world, metres; then
    /// their unit normals likewise. Tightly packed, to be used as vertex or storage buffers.
    #[wasm_bindgen(unchecked_return_type = "[object, object, object, object]")]
    pub fn buffers(&self) -> Array {
        let it = &self.0;
        let buffers = [it.shown_positions(), it.drawn_positions(), it.shown_normals(), it.drawn_normals()];
        buffers.into_iter().map(handle).collect()
    }
}

/// The browser's own object behind a buffer.
fn handle(buffer: &ctsn_gpu::wgpu::Buffer) -> JsValue {
    buffer.as_webgpu().map(JsValue::from).unwrap_or_default()
}
