//! Physics the solver must reproduce, on small scenes made here. simulation.md §3.

mod capstan;
mod cusick;
mod energy;
mod fabric;
mod fitted;
mod friction;
mod hostile;
mod layers;
mod obstacle;
mod part;
mod pose;
mod relaxed;
mod rescue;
pub(super) mod scene;
mod sphere;
mod through;
mod wrinkles;
