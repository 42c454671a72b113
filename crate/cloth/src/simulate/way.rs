//! The way to a pose: the garment is carried along the fixed path, a fine one as its coarse one.

use glam::DVec3;

use super::coarse::Coarse;
use super::level::Level;
use super::newton::Solver;
use super::posed::PosedBody;
use super::simulator::Simulator;
use super::transport::transport;
use super::untangle::untangle;
use ctsn_rig::Pose;
use ctsn_rig::path::{body_frame, motion, path};

/// Newton iterations of the coarse garment at the end of its path.
const COARSE_ITERATIONS: usize = 100;

/// The poses from the canonical one to the wanted one, and how far the body's skin is raised at the end, metres.
pub(super) struct Way {
    poses: Vec<Pose>,
    heights: Vec<f64>,
}

impl Simulator {
    /// The path to a pose.
    pub(super) fn way(&self, pose: &Pose) -> Way {
        let poses = path(&self.character, pose, self.settings.path_steps);
        let end = self.character.skinning(&poses[self.settings.path_steps]);
        let heights = self.cover.heights(&self.body.posed(pose), &self.collider, &end);
        Way { poses, heights }
    }

    /// Carries a garment along the path, `template` its own.
    pub(super) fn travel<'a>(&'a self, level: &'a Level, template: &[DVec3], way: &Way) -> (Solver<'a>, PosedBody<'a>) {
        let start = body_frame(&self.character, &self.character.canonical_pose());
        let positions = template.iter().map(|p| start.transform_point3(*p)).collect();
        let mut solver = level.solver(&self.settings, positions);
        let mut body = self.collider.pose(&self.character.skinning(&way.poses[0]));
        for (step, pair) in way.poses.windows(2).enumerate() {
            transport(&mut solver, &body, &motion(&pair[0], &pair[1]), &level.rings);
            let skinning = self.character.skinning(&pair[1]);
            let share = (step + 1) as f64 / self.settings.path_steps as f64;
            body = self.collider.raised(&skinning, &way.heights, share);
            level.pin(&mut solver, template, &skinning);
            let mut share = 0.0;
            // Cloth that is held up by cloth gets more iterations.
            for iteration in 0..3 * self.settings.path_iterations {
                if iteration >= self.settings.path_iterations && share > 0.3 {
                    break;
                }
                solver.probe(Some(&body), self.settings.path_time_step);
                share = solver.advance(self.settings.path_time_step);
            }
        }
        (solver, body)
    }

    /// The fine garment laid on the coarse one at the end of its path; none where it would cross itself.
    pub(super) fn through<'a>(
        &'a self,
        (coarse, level): &'a (Coarse, Level),
        template: &[DVec3],
        way: &Way,
    ) -> Option<(Solver<'a>, PosedBody<'a>)> {
        let (mut travelled, body) = self.travel(level, &coarse.restrict(template), way);
        travelled.relax(Some(&body), COARSE_ITERATIONS);
        let mut laid = coarse.prolong(template, &travelled.positions);
        if !untangle(&self.level.cloth.elements, &self.level.rings, &mut laid) {
            return None;
        }
        let mut solver = self.level.solver(&self.settings, laid);
        solver.iterations = travelled.iterations;
        self.level.pin(&mut solver, template, &self.character.skinning(&way.poses[self.settings.path_steps]));
        Some((solver, body))
    }
}
