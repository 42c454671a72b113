//! What a simulated pose looks like, in numbers that decide whether it may be trained on.

use glam::DVec3;

use super::cloth::Cloth;
use ctsn_rig::statistics::Sorted;

/// Whether a pose may be used.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// Static equilibrium was reached.
    Converged,
    /// It was not; the reason in words.
    Rejected {
        /// What was wanted and what was found.
        reason: String,
    },
}

/// A simulated pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Vertex positions in the body frame, metres [n]; finite in every case.
    pub positions: Vec<DVec3>,
    /// RMS static force per vertex, in mean vertex weights.
    pub residual: f64,
    /// RMS move of the vertices over the last ten iterations, metres; zero where the residual alone says that it is at
    /// rest, infinite where the cloth was still held by a short time step.
    pub drift: f64,
    /// Pairs of cloth triangles that cross each other.
    pub crossings: usize,
    /// 99th percentile of the largest principal stretch over the triangles (1: unstretched).
    pub stretch_p99: f64,
    /// Largest principal stretch.
    pub stretch_max: f64,
    /// Least signed distance of a vertex to the body, metres; negative inside. Infinite where nothing touches.
    pub least_distance: f64,
    /// Vertices that the body pinched and that were moved out of it at the end, by at most
    /// [`Settings::lift`](super::Settings).
    pub lifted: usize,
    /// Newton iterations taken.
    pub iterations: usize,
    /// Whether the pose may be used.
    pub status: Status,
}

impl Outcome {
    /// Whether the pose reached equilibrium.
    pub fn converged(&self) -> bool {
        self.status == Status::Converged
    }
}

/// 99th percentile and maximum of the largest principal stretch.
pub(super) fn stretch(cloth: &Cloth, positions: &[DVec3]) -> (f64, f64) {
    let stretches = Sorted::new(cloth.elastic.triangles.iter().map(|t| t.stretches(positions)[0]));
    // Every pose of a dataset stores it: the rank below, not the nearest one, or old poses would differ from new ones.
    let below = (stretches.values().len() - 1) * 99 / 100;
    (stretches.values()[below], stretches.greatest())
}
