//! Numerical settings of the simulator. They belong to a data set: another path is another ground truth.

use crate::{Error, Result};
use serde::{Deserialize, Serialize};

/// How poses are simulated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Distance at which the body begins to push, metres: cloth thickness plus a safety gap.
    pub thickness: f64,
    /// Contact stiffness per vertex mass, 1/s². At 1e5 sleeves slipped through raised arms.
    pub contact_stiffness: f64,
    /// Joints whose part of the body is further than this from the garment in the canonical pose are ignored, metres.
    pub reach: f64,
    /// Share of the garment's own dihedral angles kept as rest angles, 0 (flat cloth) to 1 (keeps its form).
    pub shape: f64,
    /// Steps from the canonical pose to every pose. 24 steps of two iterations took longer: what is left to relax is
    /// further off.
    pub path_steps: usize,
    /// Newton iterations per path step.
    pub path_iterations: usize,
    /// Proximal time step while the body moves, seconds.
    pub path_time_step: f64,
    /// Newton iterations the relaxation may take.
    pub relax_iterations: usize,
    /// Residual at which a pose counts as converged: RMS force per vertex over the mean vertex weight.
    pub residual: f64,
    /// Move over the last iterations under which a pose counts as settled although the residual is larger, metres RMS:
    /// forces at stiff contacts flicker where the cloth no longer moves.
    pub drift: f64,
    /// How far a vertex that the body pinches may be moved at the end to lie outside of it, metres; a pose that needs
    /// more is left out.
    pub lift: f64,
    /// Share of the vertices that may stay inside the body where it passes into itself: between an upper arm and the
    /// chest it is in, no place is outside.
    pub pinched: f64,
    /// Largest principal stretch a pose may have anywhere; above it the cloth is caught in the body.
    pub stretch_limit: f64,
    /// Cloth vertices sprung to the body, as a waistband or a collar is.
    pub attached: Vec<u32>,
    /// Stiffness of those springs, N/m.
    pub attachment: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            thickness: 0.004,
            contact_stiffness: 1e6,
            reach: 0.3,
            shape: 0.5,
            path_steps: 48,
            path_iterations: 1,
            path_time_step: 0.05,
            relax_iterations: 200,
            residual: 1e-2,
            drift: 1e-4,
            lift: 0.005,
            pinched: 0.0,
            stretch_limit: 2.0,
            attached: Vec::new(),
            attachment: 10.0,
        }
    }
}

impl Settings {
    /// Checks the ranges; `vertices`: number of cloth vertices.
    pub(super) fn check(&self, vertices: usize) -> Result<()> {
        let fields = [
            ("thickness", self.thickness, 1e-6, 1.0),
            ("contact_stiffness", self.contact_stiffness, 1.0, 1e9),
            ("reach", self.reach, self.thickness, f64::MAX),
            ("shape", self.shape, 0.0, 1.0),
            ("path_steps", self.path_steps as f64, 1.0, 1e4),
            ("path_iterations", self.path_iterations as f64, 1.0, 1e3),
            ("path_time_step", self.path_time_step, 1e-5, 1e3),
            ("relax_iterations", self.relax_iterations as f64, 1.0, 1e6),
            ("residual", self.residual, 1e-9, 1e3),
            ("drift", self.drift, 0.0, 1.0),
            ("lift", self.lift, 0.0, 1.0),
            ("pinched", self.pinched, 0.0, 1.0),
            ("stretch_limit", self.stretch_limit, 1.0, f64::MAX),
            ("attachment", self.attachment, 0.0, 1e6),
        ];
        for (name, value, low, high) in fields {
            if !(low..=high).contains(&value) {
                return Err(Error::Simulation(format!("setting {name}: wanted {low}..{high}, found {value}")));
            }
        }
        match self.attached.iter().find(|&&i| i as usize >= vertices) {
            Some(bad) => Err(Error::Simulation(format!("attached vertex: wanted below {vertices}, found {bad}"))),
            None => Ok(()),
        }
    }
}
