//! Relaxation from where the cloth is thought to be, a network's prediction, without a path. simulation.md §2.4.

use glam::{DAffine3, DVec3};

use super::coarse::Coarse;
use super::level::Level;
use super::newton::Solver;
use super::outcome::{Outcome, Status};
use super::posed::PosedBody;
use super::simulator::{Inside, Simulator};
use super::untangle::untangle;
use ctsn_rig::Pose;
use ctsn_rig::path::to_body_frame;

/// Iterations after which a pose is given up of which there are as many as one likes.
const TRIED: usize = 100;

/// How many times as many iterations as others thinned cloth may take. It is cheap, and what slides for long, such as a
/// tight skirt up the hips of legs astride, is what there is least of. docs/decisions/poses.md
const PATIENT: usize = 5;

/// Share of the vertices that may lie inside the body where cloth was relaxed coarsely: nothing kept them out between
/// those of the thinned garment. A hundredth left out 509 of 1,352 poses of a monster's robe, nine in ten of which had
/// at most two.
const ASTRAY: f64 = 0.03;

impl Simulator {
    /// Relaxes `pose` from `start` (body frame [n]), which may cross itself and the body a little. The equilibrium is
    /// as true as that which [`simulate`](Self::simulate) comes to, but of all there are the one nearest to the start.
    /// What is left out is tried again once only: a start on the wrong side of a limb stays there, and one
    /// that a limb has come out of is none. If it still is, a fine garment is relaxed once more from where its thinned
    /// form comes to rest: it may slide far.
    pub fn relax(&self, template: &[DVec3], pose: &Pose, start: &[DVec3]) -> Outcome {
        let relax = |start: &[DVec3]| self.relax_for(template, pose, start, self.settings.relax_iterations);
        let outcome = relax(start);
        let slid = (!outcome.converged()).then(|| self.slid(template, pose, start)).flatten();
        slid.map_or(outcome, |slid| relax(&slid))
    }

    /// The same, given up where it is not at rest soon: fourteen poses of a dress came to rest within 91 iterations,
    /// and what did not in 400 was left out after all. A fine garment begins where its thinned form comes to rest:
    /// layers of a prediction that are jammed part there, in a fifth of the time.
    pub fn try_relax(&self, template: &[DVec3], pose: &Pose, start: &[DVec3]) -> Outcome {
        let slid = self.slid(template, pose, start);
        let start = slid.as_deref().unwrap_or(start);
        self.relax_for(template, pose, start, TRIED.min(self.settings.relax_iterations))
    }

    /// A fine garment laid where its thinned form comes to rest, if it does.
    fn slid(&self, template: &[DVec3], pose: &Pose, start: &[DVec3]) -> Option<Vec<DVec3>> {
        let relaxed = self.relax_as(self.coarse.as_ref()?, template, pose, start);
        relaxed.converged().then_some(relaxed.positions)
    }

    fn relax_for(&self, template: &[DVec3], pose: &Pose, start: &[DVec3], iterations: usize) -> Outcome {
        if let Some(reason) = self.check_start(template, pose, start).err().or_else(|| self.out(pose, start)) {
            return self.refuse(reason);
        }
        let (solver, body) = self.begin(&self.level, template, start.to_vec(), pose);
        self.settle(solver, &body, iterations, 1, pose, DAffine3::IDENTITY)
    }

    /// The same on a garment that is thinned much, in a fraction of the time: where the cloth lies without its fine
    /// folds. `None` for a garment that is not fine.
    pub fn relax_coarse(&self, template: &[DVec3], pose: &Pose, start: &[DVec3]) -> Option<Outcome> {
        Some(self.relax_as(self.coarser.as_ref()?, template, pose, start))
    }

    /// The same as a thinned garment, the fine one laid on what comes of it. Where a limb is out through the start, or
    /// comes out, it is carried along the path instead: of 109 capes begun so all but one ended so, and nine in ten of
    /// those carried did not. docs/decisions/poses.md
    fn relax_as(&self, (coarse, level): &(Coarse, Level), template: &[DVec3], pose: &Pose, start: &[DVec3]) -> Outcome {
        if let Err(reason) = self.check_start(template, pose, start) {
            return self.refuse(reason);
        }
        let own = coarse.restrict(template);
        let is_in = |cloth: &[DVec3]| self.out(pose, cloth).is_none();
        let from_there = is_in(start).then(|| {
            let (solver, body) = self.begin(level, &own, coarse.restrict(start), pose);
            self.laid(coarse, template, pose, solver, &body)
        });
        from_there.filter(|outcome| is_in(&outcome.positions)).unwrap_or_else(|| {
            let (solver, body) = self.travel(level, &own, &self.way(pose));
            self.laid(coarse, template, pose, solver, &body)
        })
    }

    /// Thinned cloth relaxed on the posed body, the fine garment laid on it.
    fn laid(&self, coarse: &Coarse, template: &[DVec3], pose: &Pose, mut solver: Solver, body: &PosedBody) -> Outcome {
        let relaxed = solver.relax(Some(body), PATIENT * self.settings.relax_iterations);
        let mut laid = coarse.prolong(template, &solver.positions);
        untangle(&self.level.cloth.elements, &self.level.rings, &mut laid);
        let mut fine = self.level.solver(&self.settings, laid);
        fine.iterations = solver.iterations;
        let (mut outcome, Inside { free, out, .. }) = self.measured(&fine, relaxed, pose, DAffine3::IDENTITY);
        let most = (ASTRAY * template.len() as f64) as usize;
        let astray = || {
            (free.len() > most).then(|| format!("wanted at most {most} vertices inside the body, found {}", free.len()))
        };
        if let Some(reason) = self.unrest(&outcome).or(out).or_else(astray) {
            outcome.status = Status::Rejected { reason };
        }
        outcome
    }

    /// Why `pose` cannot be relaxed from there.
    fn check_start(&self, template: &[DVec3], pose: &Pose, start: &[DVec3]) -> std::result::Result<(), String> {
        self.check(template, pose).and_then(|()| self.check_cloth("start", start))
    }

    /// A garment at `start` (body frame), smoothed where it crosses itself, on the body in `pose`; `template` its own.
    fn begin<'a>(
        &'a self,
        level: &'a Level,
        template: &[DVec3],
        mut start: Vec<DVec3>,
        pose: &Pose,
    ) -> (Solver<'a>, PosedBody<'a>) {
        untangle(&level.cloth.elements, &level.rings, &mut start);
        let mut solver = level.solver(&self.settings, start);
        let end = self.character.skinning(&to_body_frame(&self.character, pose));
        let heights = self.cover.heights(&self.body.posed(pose), &self.collider, &end);
        let body = self.collider.raised(&end, &heights, 1.0);
        level.pin(&mut solver, template, &end);
        (solver, body)
    }
}
