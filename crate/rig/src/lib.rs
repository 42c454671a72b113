//! What authoring passes from stage to stage: rigged characters, poses, meshes; read from and written to glTF.
//! Units: metres, right-handed, +Y up (glTF). All of it f64; the network's f32 begins at the dataset.

#![forbid(unsafe_code)]

mod character;
mod error;
pub mod file;
pub mod gltf;
pub mod mesh;
pub mod mixed;
pub mod path;
mod skinned;
pub mod statistics;

pub use character::*;
pub use error::{Error, Result};
pub use mesh::Mesh;
pub use skinned::*;
