//! Quasi-static cloth: a garment draped on the canonical body, and brought from there to any pose.
//! Implicit Newton on the true elastic energy, f64, fixed order of sums: the same pose gives the same bits.

mod bones;
mod burial;
mod cloth;
mod coarse;
mod collider;
mod contact;
mod cover;
mod crossing;
mod distance;
mod elastic;
mod fitted;
mod grain;
mod level;
mod material;
mod matrix;
mod neighbourhood;
mod newton;
mod outcome;
mod outer_skin;
mod part;
mod posed;
mod proximity;
mod relaxed;
mod rescue;
mod settings;
mod simulator;
mod transport;
mod untangle;
mod way;

#[cfg(test)]
mod tests;

pub use cloth::{FINE, is_fine};
pub use coarse::Embedding;
pub use distance::{BodyDistance, felt};
pub use elastic::{Elastic, Hinge, Membrane, Triangle, Wrinkling};
pub use fitted::fitted;
pub use material::{Fabric, GRAVITY, Material};
pub use outcome::{Outcome, Status};
pub use outer_skin::{covering, outer_skin};
pub use settings::Settings;
pub use simulator::Simulator;

pub(crate) use neighbourhood::Elements;
pub(crate) use untangle::untangle;
