//! Canonical drape and poses: transport along the fixed path, then relaxation to static equilibrium.
//! A pose depends on nothing but itself; poses may run in parallel and come out bit for bit the same.

use glam::{DAffine3, DVec3};

use super::coarse::{COARSE, COARSER, Coarse};
use super::collider::Collider;
use super::cover::{Cover, SLACK};
use super::distance::BodyDistance;
use super::elastic::{Membrane, Wrinkling};
use super::grain::warp;
use super::level::Level;
use super::material::Material;
use super::newton::{Probe, Solver};
use super::outcome::{Outcome, Status, stretch};
use super::outer_skin::{outer_skin, smooth};
use super::rescue::ROUNDS;
use super::settings::Settings;
use crate::wrap::SKIN;
use crate::{Error, Result};
use ctsn_rig::path::{self, body_frame, to_body_frame};
use ctsn_rig::{Character, Garment, Mesh, Pose, Surface};

/// How far from where the body passes into itself cloth is pinched by it, metres.
const PINCH: f64 = 0.025;

/// Simulates one garment on one character. Built once, used from any number of threads.
pub struct Simulator {
    pub(super) character: Character,
    pub(super) rest: Vec<DVec3>,
    pub(super) level: Level,
    /// What a fine garment travels as.
    pub(super) coarse: Option<(Coarse, Level)>,
    /// What is relaxed of a fine garment for its coarse poses.
    pub(super) coarser: Option<(Coarse, Level)>,
    /// The body's outer skin, which the cloth touches.
    pub(super) collider: Collider,
    /// The body itself, which no kept pose may enter.
    pub(super) body: BodyDistance,
    pub(super) cover: Cover,
    pub(super) settings: Settings,
}

impl Simulator {
    /// Analyses garment and body. The garment stands where it is worn in the canonical pose.
    pub fn new(character: &Character, garment: &Garment, material: Material, settings: Settings) -> Result<Self> {
        let rest = garment.mesh.positions.clone();
        settings.check(rest.len())?;
        // With limbs apart, as for the repair, two of three garments answered half a degree with more (7.9 -> 8.6, 7.0
        // -> 8.7, 8.3 -> 5.7 mm).
        let mut skin = outer_skin(character, &character.canonical_pose(), SKIN)?;
        smooth(&mut skin);
        let collider = Collider::new(character, &skin, &garment.mesh, settings.reach)?;
        let level = |mesh: &Mesh, warp: &[DVec3], attached: &[u32]| {
            Level::new(mesh, warp, &material, &settings, &collider, attached)
        };
        let warp = warp(garment);
        let fine = level(&garment.mesh, &warp, &settings.attached)?;
        let thinned = |vertices| {
            let coarse = Coarse::new(&garment.mesh, &warp, vertices);
            let attached = coarse.restrict_vertices(&settings.attached);
            let mut level = level(&coarse.embedding.mesh, &coarse.warp, &attached)?;
            level.cloth.elastic.membrane = Membrane::Wrinkling(Wrinkling::new(&material));
            Ok::<_, Error>((coarse, level))
        };
        let of = |vertices| fine.cloth.is_fine().then(|| thinned(vertices)).transpose();
        let [coarse, coarser] = [of(COARSE)?, of(COARSER)?];
        let body = BodyDistance::new(character, &garment.mesh)?;
        let cover = Cover::new(&body.collider, &collider, SLACK);
        let character = Character { clips: Vec::new(), surface: Surface::default(), ..character.clone() };
        Ok(Self { character, rest, level: fine, coarse, coarser, collider, body, cover, settings })
    }

    /// Whether the garment has so many vertices that it travels thinned.
    pub fn is_fine(&self) -> bool {
        self.coarse.is_some()
    }

    /// The template `T_C`: the garment at rest on the canonical body, metres in canonical space [n].
    pub fn drape(&self) -> Result<Vec<DVec3>> {
        let crossings = self.level.cloth.elements.crossings(&self.rest);
        if let Some([a, b]) = crossings.first() {
            let count = crossings.len();
            let reason = format!(
                "triangles {a} and {b} cross: wanted a garment that does not cut through itself, found {count} such pairs"
            );
            return Err(Error::Garment(reason));
        }
        let pose = self.character.canonical_pose();
        let body = self.collider.pose(&self.character.skinning(&pose));
        let mut solver = self.level.solver(&self.settings, self.rest.clone());
        self.level.pin(&mut solver, &self.rest, &self.character.skinning(&pose));
        let (iterations, to_body) = (10 * self.settings.relax_iterations, body_frame(&self.character, &pose));
        let Outcome { status, positions, .. } = self.settle(solver, &body, iterations, ROUNDS, &pose, to_body);
        match status {
            Status::Converged => Ok(positions),
            Status::Rejected { reason } => Err(Error::Simulation(format!("canonical drape: {reason}"))),
        }
    }

    /// Simulates `pose` from `template` (canonical space, as [`drape`](Self::drape) returns it).
    pub fn simulate(&self, template: &[DVec3], pose: &Pose) -> Outcome {
        if let Err(reason) = self.check(template, pose) {
            return self.refuse(reason);
        }
        let way = self.way(pose);
        let through = self.coarse.as_ref().and_then(|coarse| self.through(coarse, template, &way));
        let (solver, body) = match through {
            Some(refined) => refined,
            None => self.travel(&self.level, template, &way),
        };
        self.settle(solver, &body, self.settings.relax_iterations, ROUNDS, pose, DAffine3::IDENTITY)
    }

    /// Why this cannot be simulated.
    pub(super) fn check(&self, template: &[DVec3], pose: &Pose) -> std::result::Result<(), String> {
        self.check_cloth("template", template)?;
        path::check(&self.character, pose)
    }

    pub(super) fn check_cloth(&self, name: &str, cloth: &[DVec3]) -> std::result::Result<(), String> {
        if cloth.len() == self.rest.len() && cloth.iter().all(|p| p.is_finite()) {
            return Ok(());
        }
        Err(format!("{name}: wanted {} finite vertices, found {}", self.rest.len(), cloth.len()))
    }

    /// Why an outcome is not at rest, if it is not.
    pub(super) fn unrest(&self, outcome: &Outcome) -> Option<String> {
        let Outcome { residual, drift, .. } = *outcome;
        if !residual.is_finite() || outcome.positions.iter().any(|p| !p.is_finite()) {
            return Some("wanted finite forces, found none".into());
        }
        let Settings { residual: wanted, drift: least, .. } = self.settings;
        let state = match drift.is_finite() {
            true => format!("still moving by {:.2} mm", 1e3 * drift),
            false => "held by short steps".into(),
        };
        (residual > wanted && drift > least)
            .then(|| format!("residual: wanted below {wanted}, found {residual:.4}, {state}"))
    }

    fn judge(&self, outcome: &Outcome, inside: Inside) -> Status {
        let reject = |reason| Status::Rejected { reason };
        let wanted = &self.settings;
        let Outcome { crossings, stretch_max, .. } = *outcome;
        if let Some(reason) = self.unrest(outcome) {
            return reject(reason);
        }
        // Vertices that the body had no room for. Leading them out of the crease afterwards was tried,
        // by contact planes and by springs towards its mouth: the first never came to rest, the second drew as many
        // others in.
        let Inside { free, pinched, least, out } = inside;
        if !free.is_empty() {
            let (free, depth) = (free.len(), -1e3 * least);
            return reject(format!("wanted no vertex inside the body, found {free}, {depth:.2} mm deep"));
        }
        if self.too_pinched(pinched) {
            let [wanted, found] =
                [wanted.pinched, pinched as f64 / outcome.positions.len() as f64].map(|share| 100.0 * share);
            return reject(format!(
                "wanted at most {wanted} % of the vertices where the body passes into itself, found {found:.2} %"
            ));
        }
        if let Some(reason) = out {
            return reject(reason);
        }
        if crossings > 0 {
            return reject(format!("wanted no cloth through cloth, found {crossings} pairs of triangles that cross"));
        }
        if stretch_max > wanted.stretch_limit {
            return reject(format!("stretch: wanted below {}, found {stretch_max:.3}", wanted.stretch_limit));
        }
        Status::Converged
    }

    /// Which limb has come out through cloth placed so in `pose` (world; body frame [n], metres), if one has.
    pub(super) fn out(&self, pose: &Pose, placed: &[DVec3]) -> Option<String> {
        let limb = self.body.limb_out(pose, placed)?;
        Some(format!("wanted every limb in the cloth, found that at {limb:?} out through it"))
    }

    /// How vertices (body frame, metres) lie wrong to the body in `pose` (world).
    pub(super) fn inside(&self, pose: &Pose, placed: &[DVec3]) -> Inside {
        let skin = self.collider.pose(&self.character.skinning(&to_body_frame(&self.character, pose)));
        let signed = self.body.signed(pose, placed);
        let mut inside = Inside { out: self.out(pose, placed), ..Inside::default() };
        for (vertex, distance) in signed.into_iter().enumerate().filter(|(_, distance)| *distance < 0.0) {
            if skin.pinches(placed[vertex], PINCH, self.settings.thickness) {
                inside.pinched += 1;
            } else {
                inside.free.push(vertex);
                inside.least = inside.least.min(distance);
            }
        }
        inside
    }

    /// Whether more vertices than are wanted are where the body passes into itself.
    pub(super) fn too_pinched(&self, pinched: usize) -> bool {
        pinched as f64 > self.settings.pinched * self.level.rings.offsets.len().saturating_sub(1) as f64
    }

    /// `to_body`: from the solver's space to the body frame of `pose`.
    pub(super) fn outcome(&self, solver: &Solver, relaxed: Probe, pose: &Pose, to_body: DAffine3) -> Outcome {
        let (mut outcome, inside) = self.measured(solver, relaxed, pose, to_body);
        outcome.status = self.judge(&outcome, inside);
        outcome
    }

    /// The same, not judged yet, and how it lies to the body.
    pub(super) fn measured(
        &self,
        solver: &Solver,
        relaxed: Probe,
        pose: &Pose,
        to_body: DAffine3,
    ) -> (Outcome, Inside) {
        let from_body = to_body.inverse();
        let mut placed: Vec<DVec3> = solver.positions.iter().map(|p| to_body.transform_point3(*p)).collect();
        let lifted = self.lift(pose, &mut placed);
        let positions: Vec<DVec3> = match lifted {
            0 => solver.positions.clone(),
            _ => placed.iter().map(|p| from_body.transform_point3(*p)).collect(),
        };
        let (stretch_p99, stretch_max) = stretch(&self.level.cloth, &positions);
        let outcome = Outcome {
            residual: relaxed.residual,
            drift: relaxed.drift,
            crossings: self.level.cloth.elements.crossings(&positions).len(),
            stretch_p99,
            stretch_max,
            least_distance: relaxed.least_distance,
            lifted,
            iterations: solver.iterations,
            status: Status::Converged,
            positions,
        };
        (outcome, self.inside(pose, &placed))
    }

    /// Moves vertices (body frame, metres) that the body in `pose` (world) pinches out of it; how many. Between two
    /// parts of the body what is lifted from one may be laid on the wrong side of a fold: such vertices stay.
    pub(super) fn lift(&self, pose: &Pose, placed: &mut [DVec3]) -> usize {
        let at_rest = placed.to_vec();
        let lifted = self.body.lift(pose, placed, self.settings.lift, |_| true);
        if lifted == 0 {
            return 0;
        }
        let elements = &self.level.cloth.elements;
        let before = elements.crossings(&at_rest);
        loop {
            let crossings = elements.crossings(placed);
            let new = crossings.iter().filter(|pair| before.binary_search(pair).is_err()).flatten();
            let corners = new.flat_map(|triangle| elements.triangles[*triangle as usize]).map(|corner| corner as usize);
            let back: Vec<usize> = corners.filter(|corner| placed[*corner] != at_rest[*corner]).collect();
            if back.is_empty() {
                return placed.iter().zip(&at_rest).filter(|(now, then)| now != then).count();
            }
            back.into_iter().for_each(|vertex| placed[vertex] = at_rest[vertex]);
        }
    }

    /// An outcome for input that cannot be simulated: the garment as given.
    pub(super) fn refuse(&self, reason: String) -> Outcome {
        let frame = body_frame(&self.character, &self.character.canonical_pose());
        let positions: Vec<DVec3> = self.rest.iter().map(|p| frame.transform_point3(*p)).collect();
        let (stretch_p99, stretch_max) = stretch(&self.level.cloth, &positions);
        Outcome {
            positions,
            residual: f64::INFINITY,
            drift: f64::INFINITY,
            crossings: 0,
            stretch_p99,
            stretch_max,
            least_distance: f64::INFINITY,
            lifted: 0,
            iterations: 0,
            status: Status::Rejected { reason },
        }
    }
}

/// Vertices inside the body, and limbs outside of the cloth.
#[derive(Default)]
pub(super) struct Inside {
    /// Those with a way out.
    pub free: Vec<usize>,
    /// Those where the body passes into itself.
    pub pinched: usize,
    /// Least signed distance of the former, metres.
    pub least: f64,
    /// Which limb has come out through the cloth, if one has.
    pub out: Option<String>,
}
