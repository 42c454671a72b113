//! Carries cloth along when the body takes a step: near the body by the blended rigid motion of the closest point,
//! weight `exp(-(d - d̂) / 4 cm)`, elsewhere by what the neighbours do, until cloth meets cloth. Without it every step
//! is pushed by contact.

use ctsn_core::topology::Graph;
use glam::{DAffine3, DVec3};

use super::collider::blend;
use super::newton::Solver;
use super::posed::PosedBody;

/// Decay length of the body's hold on the cloth, metres.
const DECAY: f64 = 0.04;
/// Beyond this distance a vertex only follows its neighbours, metres.
const RANGE: f64 = 0.12;
/// Weight of the neighbours' mean against the body's hold, and how often it is taken.
const SMOOTHING: f64 = 0.15;
const SWEEPS: usize = 12;

/// Moves positions and anchors from the body's current pose by `motion`, one transform per joint. `rings`: the cloth's
/// neighbours.
pub(super) fn transport(solver: &mut Solver, body: &PosedBody, motion: &[DAffine3], rings: &Graph<Vec<u32>>) {
    let n = solver.positions.len();
    let mut target = vec![DVec3::ZERO; n];
    let mut hold = vec![0.0; n];
    let mut lag = vec![DVec3::ZERO; n];
    for i in 0..n {
        let x = solver.positions[i];
        let Some(hit) = body.closest(x, solver.tracked[i], RANGE) else { continue };
        let rigid = blend(&body.collider.skin(hit.face, hit.barycentric), motion);
        target[i] = rigid.transform_point3(x) - x;
        hold[i] = (-(hit.distance - 0.004).max(0.0) / DECAY).exp();
        solver.tracked[i] = Some(hit.face);
        // The anchor keeps its offset from the vertex: at most the slip length, and turning with the body.
        lag[i] = rigid.transform_vector3(solver.anchors[i] - x);
    }
    let mut shift: Vec<DVec3> = target.iter().zip(&hold).map(|(t, h)| *t * *h).collect();
    for _ in 0..SWEEPS {
        let old = shift.clone();
        for i in 0..n {
            let around: DVec3 = rings.of(i).iter().map(|&j| old[j as usize]).sum();
            let mean = around / rings.of(i).len().max(1) as f64;
            shift[i] = (target[i] * hold[i] + mean * SMOOTHING) / (hold[i] + SMOOTHING);
        }
    }
    solver.carry(shift);
    for i in 0..n {
        solver.anchors[i] = solver.positions[i] + lag[i];
    }
    solver.moved();
}
