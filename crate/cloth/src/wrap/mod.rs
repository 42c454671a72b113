//! What wraps a body: its voxel field, the shell cut from it, its outer skin. Below garments and the simulator, which
//! both use it. f = |x - body| - looseness, hollows bridged, smoothed; the shell is {f = 0}. simulation.md §4.2.

mod anatomy;
mod apart;
mod bones;
mod cut;
mod field;
mod nearest;
mod outer_skin;
mod proxy;
mod region;
mod remesh;
mod solid;

pub use apart::apart;
pub use outer_skin::{SKIN, outer_skin};

pub(crate) use anatomy::{Anatomy, Limb, anatomy, below, joint_positions, membership};
pub(crate) use bones::{Bone, bones};
pub(crate) use cut::{Piece, cut, extract};
pub(crate) use field::Field;
pub(crate) use nearest::{Faces, bounds, squared_distance};
pub(crate) use proxy::complete;
pub(crate) use region::{Plane, Region};
pub(crate) use remesh::{even, remesh};
pub(crate) use solid::{Solid, cell, split};
