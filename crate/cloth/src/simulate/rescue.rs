//! Poses that would be left out for a few vertices. Where the body passes into itself cloth is held softly, by one side
//! of it, and tight cloth may pull it on, deep into a knee and out of the crease's reach. Such vertices are put out of
//! the body again and held there, as what grips them would; what crosses is smoothed apart; and the cloth is relaxed
//! once more. simulation.md §2.3.

use glam::{DAffine3, DVec3};

use super::contact::Pin;
use super::newton::Solver;
use super::outcome::Outcome;
use super::posed::PosedBody;
use super::simulator::{Inside, Simulator};
use super::untangle::untangle;
use ctsn_rig::Pose;

/// How often a pose is tried again: what is held may draw its neighbours in, which are then held as well.
pub(super) const ROUNDS: usize = 4;
/// How far a vertex is put out at most, metres. Tight trousers are pulled 30 mm into a bent knee.
const FURTHEST: f64 = 0.06;
/// Stiffness of what holds it, N/m: that of a few contacts, so that a stretch of a tenth moves it by millimetres.
const GRIP: f64 = 1000.0;

impl Simulator {
    /// Relaxes the cloth on the posed body; again, so many times at most, where the outcome would be left out.
    /// `to_body`: from the solver's space to the body frame of `pose`.
    pub(super) fn settle<'a>(
        &'a self,
        mut solver: Solver<'a>,
        body: &PosedBody,
        iterations: usize,
        rounds: usize,
        pose: &Pose,
        to_body: DAffine3,
    ) -> Outcome {
        let relaxed = solver.relax(Some(body), iterations);
        let mut outcome = self.outcome(&solver, relaxed, pose, to_body);
        for round in 0..rounds {
            // Predicted cloth that is jammed parts sooner where its thinned form comes to rest: of a tight skirt in
            // 14 s of a core. Of six that were smoothed anew three jammed again, three took 17 to 39 s.
            if outcome.converged() || rounds < ROUNDS && !outcome.drift.is_finite() {
                break;
            }
            let Some((mut positions, held)) = self.put_out(&solver, pose, to_body) else { break };
            if !untangle(&self.level.cloth.elements, &self.level.rings, &mut positions) {
                break;
            }
            // Where there is nothing to put out, more iterations help at most once: four times as many took 250 s for a
            // pose of 4,947 vertices that was left out at last. Predicted cloth goes along the path next.
            if positions == solver.positions && (round > 0 || rounds < ROUNDS) {
                break;
            }
            let mut again = self.level.solver(&self.settings, positions);
            again.iterations = solver.iterations;
            again.pins = std::mem::take(&mut solver.pins);
            again.pins.extend(held);
            let relaxed = again.relax(Some(body), iterations);
            (outcome, solver) = (self.outcome(&again, relaxed, pose, to_body), again);
        }
        outcome
    }

    /// The cloth with every vertex outside that is inside the body and has a way out; what holds those that it had no
    /// room for. `None` where too many have no way out, or a limb is out: nothing helps them.
    pub(super) fn put_out(&self, solver: &Solver, pose: &Pose, to_body: DAffine3) -> Option<(Vec<DVec3>, Vec<Pin>)> {
        let mut placed: Vec<DVec3> = solver.positions.iter().map(|p| to_body.transform_point3(*p)).collect();
        let Inside { free, pinched, out, .. } = self.inside(pose, &placed);
        if out.is_some() || free.is_empty() && self.too_pinched(pinched) {
            return None;
        }
        self.body.lift(pose, &mut placed, FURTHEST, |vertex| free.contains(&vertex));
        let from_body = to_body.inverse();
        let mut positions = solver.positions.clone();
        free.iter().for_each(|&vertex| positions[vertex] = from_body.transform_point3(placed[vertex]));
        let held = free.into_iter().filter(|&vertex| solver.has_no_room(vertex));
        let held = held.map(|vertex| Pin { vertex, target: positions[vertex], stiffness: GRIP }).collect();
        Some((positions, held))
    }
}
