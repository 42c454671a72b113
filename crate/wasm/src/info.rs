//! What a page may want to know of a model, handed over as a typed object.

use ctsn_core::Predictor;
use miniserde::json;
use serde::Serialize;

/// Sizes, cost and origin of a model. `web/src/info.ts` says the same in TypeScript.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Info {
    vertices: usize,
    drawn_vertices: usize,
    joints: usize,
    skeleton_matrices: usize,
    mesh_matrices: usize,
    layers: usize,
    features: usize,
    heads: usize,
    polish: usize,
    body_vertices: usize,
    bytes: usize,
    knows_poses: bool,
    training: Option<Training>,
}

/// How it was trained, and how far from the truth it is in poses it was not trained on: metres, degrees.
#[derive(Serialize)]
struct Training {
    character: Option<String>,
    garment: Option<String>,
    fabric: Option<String>,
    clips: Option<Vec<String>>,
    poses: Option<usize>,
    mixed: Option<usize>,
    coarse: Option<usize>,
    distance: Option<f64>,
    angle: Option<f64>,
    version: Option<String>,
}

/// What `ctsn train` wrote of its work.
#[derive(miniserde::Deserialize)]
struct Written {
    character: Option<String>,
    garment: Option<String>,
    fabric: Option<String>,
    clips: Option<Vec<String>>,
    poses: Option<usize>,
    mixed: Option<usize>,
    coarse: Option<usize>,
    validation_metres: Option<f64>,
    validation_degrees: Option<f64>,
    ctsn: Option<String>,
}

impl From<Written> for Training {
    fn from(written: Written) -> Self {
        let Written { character, garment, fabric, clips, poses, mixed, coarse, .. } = written;
        let (distance, angle) = (written.validation_metres, written.validation_degrees);
        Self { character, garment, fabric, clips, poses, mixed, coarse, distance, angle, version: written.ctsn }
    }
}

impl Info {
    pub fn of(predictor: &Predictor) -> Self {
        let (model, sizes) = (predictor.model(), predictor.sizes());
        Self {
            vertices: sizes.vertices,
            drawn_vertices: model.surface.as_ref().map_or(sizes.vertices, |surface| surface.vertex.len()),
            joints: sizes.joints,
            skeleton_matrices: sizes.embedding,
            mesh_matrices: if model.mesh_stream { sizes.basis } else { 0 },
            layers: model.layers.len(),
            features: sizes.features,
            heads: sizes.heads,
            polish: model.cut.as_ref().map_or(0, |cut| cut.steps),
            body_vertices: model.body.as_ref().map_or(0, |body| body.vertices),
            bytes: predictor.bytes(),
            knows_poses: model.rig.range.is_some(),
            // Free in form: what cannot be read as this is not told.
            training: model
                .training
                .as_deref()
                .and_then(|text| json::from_str::<Written>(text).ok())
                .map(Training::from),
        }
    }
}
