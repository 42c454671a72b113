//! Quasi-static cloth: a garment draped on the canonical body, and brought from there to any pose.
//! Implicit Newton on the true elastic energy, f64, fixed order of sums: the same pose gives the same bits.

mod bending;
mod burial;
mod cloth;
mod collider;
mod contact;
mod cover;
mod crossing;
mod distance;
mod grain;
mod hull;
mod material;
mod matrix;
mod membrane;
mod neighbourhood;
mod newton;
mod outcome;
mod path;
mod posed;
mod proximity;
mod settings;
mod simulator;
mod transport;

#[cfg(test)]
mod tests;

pub use distance::{BodyDistance, felt};
pub use hull::{covering, hull};
pub use material::{GRAVITY, Material};
pub use outcome::{Outcome, Status};
pub(crate) use path::is_sound;
pub use path::{between, body_frame, path, to_body_frame};
pub use settings::Settings;
pub use simulator::Simulator;
