//! The boundary to JavaScript of `ctsn_core::Predictor`: no arithmetic. The other side of it is `web/src/raw.ts`, the
//! one file that imports the glue which wasm-bindgen generates. WebGPU is a module of its own: `crate/wasm-gpu`.
// On other targets there is no JavaScript.
#![cfg(target_arch = "wasm32")]

mod info;
#[cfg(feature = "threads")]
mod team;

use ctsn_core::cpu::Level;
use ctsn_core::model::HostModel;
use ctsn_core::{Error, Shares};
use wasm_bindgen::prelude::*;

/// Which of the network's streams act.
#[wasm_bindgen]
#[derive(Clone, Copy, Debug)]
pub enum Streams {
    /// The whole network.
    Both = 0,
    /// The skeleton-based stream only.
    Skeleton = 1,
    /// No stream: plain skinning.
    None = 2,
}

impl From<Streams> for ctsn_core::Streams {
    fn from(streams: Streams) -> Self {
        match streams {
            Streams::Both => Self::Both,
            Streams::Skeleton => Self::Skeleton,
            Streams::None => Self::None,
        }
    }
}

/// A JavaScript `Error` whose `name` is the stable code of the core.
fn to_js(error: &Error) -> js_sys::Error {
    let js = js_sys::Error::new(&error.to_string());
    js.set_name(error.kind());
    js
}

/// Has a panic, which would be a fault of ours, reported on the console with its place in the source.
#[wasm_bindgen(start)]
pub fn start() {
    console_error_panic_hook::set_once();
}

/// What one cloth shows of the mesh stream between calls that compute it.
#[wasm_bindgen]
pub struct Folds(ctsn_core::Folds);

/// One model with its buffers. JavaScript reaches the large ones by address, so that a prediction copies nothing.
#[wasm_bindgen]
pub struct Predictor {
    inner: ctsn_core::Predictor,
    pose: Vec<f32>,
    failure: Option<Error>,
}

#[wasm_bindgen]
impl Predictor {
    /// Reads a model file; `polish`: steps of the polish, if not the file's own number.
    ///
    /// # Errors
    /// A JavaScript `Error` whose `name` is the code of what is wrong with the file.
    #[wasm_bindgen(constructor)]
    pub fn new(bytes: Vec<u8>, polish: Option<usize>) -> Result<Predictor, js_sys::Error> {
        let model = HostModel::parse(&bytes).map_err(|error| to_js(&error))?;
        // Its place is taken by what a prediction computes: memory that has grown is never given back.
        drop(bytes);
        let model = model.polish(polish);
        #[cfg(feature = "threads")]
        let inner = ctsn_core::Predictor::on_threads(model, Level::new(), team::threads());
        #[cfg(not(feature = "threads"))]
        let inner = ctsn_core::Predictor::from_model(model, Level::new());
        let pose = vec![0.0; inner.joints().len() * 16];
        Ok(Self { inner, pose, failure: None })
    }

    /// Joint names, in the order of the pose [J].
    pub fn joints(&self) -> Vec<String> {
        self.inner.joints().to_vec()
    }

    /// Index of the root joint.
    pub fn root(&self) -> usize {
        self.inner.root()
    }

    /// Inverse bind matrices, row-major 3×4, one after the other [12·J].
    pub fn inverse_bind(&self) -> Vec<f32> {
        self.inner.inverse_bind().as_flattened().to_vec()
    }

    /// Triangles of the welded mesh that is shown [3·t].
    pub fn triangles(&self) -> Vec<u32> {
        self.inner.shown_triangles().to_vec()
    }

    /// Drawn vertex -> vertex of the welded mesh [d]; nothing if the file holds no surface to draw.
    pub fn surface_vertex(&self) -> Option<Vec<u32>> {
        self.inner.surface().map(|surface| surface.vertex.clone())
    }

    /// Texture coordinates of the drawn vertices [2·d].
    pub fn surface_uv(&self) -> Option<Vec<f32>> {
        self.inner.surface().map(|surface| surface.uv.clone())
    }

    /// Triangles of the drawn surface [3·t].
    pub fn surface_triangles(&self) -> Option<Vec<u32>> {
        self.inner.surface().map(|surface| surface.triangles.clone())
    }

    /// Sizes, cost and origin of the model.
    #[wasm_bindgen(unchecked_return_type = "object")]
    pub fn info(&self) -> JsValue {
        serde_wasm_bindgen::to_value(&info::Info::of(&self.inner)).unwrap_or_default()
    }

    /// Vertices of the mesh that is shown: of the cloth, or of what rides on it.
    pub fn vertex_count(&self) -> usize {
        self.inner.shown_positions().len() / 3
    }

    /// Address of the joint world matrices [16·J], column-major, metres. The caller writes them before
    /// [`Self::predict`].
    pub fn pose_address(&mut self) -> *mut f32 {
        self.pose.as_mut_ptr()
    }

    /// Address of the predicted positions [3·n], world, metres.
    pub fn positions_address(&self) -> *const f32 {
        self.inner.shown_positions().as_ptr()
    }

    /// Address of the vertex normals [3·n], world, unit length.
    pub fn normals_address(&self) -> *const f32 {
        self.inner.shown_normals().as_ptr()
    }

    /// Predicts from the pose at [`Self::pose_address`], with those shares of the two streams' residuals. False if that
    /// failed: then [`Self::take_failure`] says why. Not a `Result`: wasm-bindgen returns one as a fresh array, and a
    /// prediction shall allocate nothing.
    pub fn predict(&mut self, streams: Streams, skeleton: f32, mesh: f32) -> bool {
        let shares = Shares { skeleton, mesh };
        self.failure = self.inner.predict_faded(&self.pose, streams.into(), shares).err();
        self.failure.is_none()
    }

    /// The same by the whole network, for a cloth whose mesh stream is computed in some calls only: in this one if
    /// `aim`; `step`: how much of the way to the last aim the folds go on.
    pub fn predict_folds(&mut self, folds: &mut Folds, aim: bool, step: f32, skeleton: f32, mesh: f32) -> bool {
        let shares = Shares { skeleton, mesh };
        let done = self.inner.predict_folds(&self.pose, &mut folds.0, (aim, step), shares);
        self.failure = done.err();
        self.failure.is_none()
    }

    /// Room for the folds of one cloth.
    pub fn folds(&self) -> Folds {
        Folds(ctsn_core::Folds::new(self.inner.sizes().vertices))
    }

    /// How much of the network's folds the last prediction shows: 1 in poses like those of the training, 0 far away.
    pub fn confidence(&self) -> f32 {
        self.inner.confidence()
    }

    /// Why the last prediction failed.
    pub fn take_failure(&mut self) -> Option<js_sys::Error> {
        self.failure.take().map(|error| to_js(&error))
    }
}
