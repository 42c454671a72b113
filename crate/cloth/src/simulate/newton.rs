//! Proximal Newton: `min Φ(x + δ) + Σ m_i |δ_i|² / 2h²`, one factorisation per iteration, `h` growing as steps succeed,
//! so that the end is pure statics. Contacts are planes within an iteration and found anew for the next one.

mod assembly;
mod descent;
mod detection;
mod layout;
mod local;
mod memory;

use std::sync::Arc;

use glam::DVec3;

use self::detection::Touch;
pub(super) use self::layout::Layout;
use super::cloth::Cloth;
use super::contact::{Contact, Pin};
use super::matrix::Matrix;
use super::neighbourhood::Neighbourhood;
use super::posed::PosedBody;
use super::settings::Settings;

/// Proximal time step at the start of a relaxation, at most and at least, seconds; growth after a full Newton step.
const FIRST_TIME_STEP: f64 = 0.05;
const LONGEST_TIME_STEP: f64 = 20.0;
const SHORTEST_TIME_STEP: f64 = 1e-4;
const GROWTH: f64 = 1.6;
/// Time step in seconds above which the Hessian is exact. Near rest that converges quadratically; before, the exact
/// one is indefinite more often than not.
const EXACT_ABOVE: f64 = 10.0;
/// Residual below which the Hessian of a fine cloth may be exact. Further from rest, 9 of 10 attempts at it failed, at
/// a fifth of an iteration's cost each.
const FINE_EXACT_BELOW: f64 = 1.0;

/// Time step under which the proximal term alone keeps a cloth still, seconds.
const HOLDING: f64 = 0.05;
/// Time step that, where it is not reached for a [`WINDOW`], says that the cloth is jammed: layers of a predicted start
/// that are a ten-thousandth of a millimetre apart open by as much again in an iteration, and hold all the rest. A
/// thousand iterations part few of them. docs/decisions/simulation.md
const JAMMED: f64 = 1e-3;

/// Iterations over which a relaxation's drift is taken.
const WINDOW: usize = 10;

/// The state of a cloth between two iterations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    /// RMS static force per vertex, in mean vertex weights.
    pub residual: f64,
    /// Least signed distance, metres (infinite without contact).
    pub least_distance: f64,
    /// RMS move of the vertices over the last [`WINDOW`] iterations of a relaxation, metres; infinite before.
    pub drift: f64,
}

/// A cloth on its way to equilibrium.
pub(super) struct Solver<'a> {
    cloth: &'a Cloth,
    settings: &'a Settings,
    layout: Arc<Layout>,
    matrix: Matrix,
    /// Cloth that may meet cloth.
    neighbourhood: Neighbourhood,
    /// Pairs of elements within the barrier.
    pub touching: usize,
    /// Vertex positions, metres [n].
    pub positions: Vec<DVec3>,
    /// Friction anchors, metres [n].
    pub anchors: Vec<DVec3>,
    /// Last face each vertex was near.
    pub tracked: Vec<Option<u32>>,
    /// Contact planes of the last iteration, up to two per vertex.
    contacts: Vec<Contact>,
    /// Vertices held in place.
    pub pins: Vec<Pin>,
    /// Whether the body is at rest: what it has no room for then stays so.
    resting: bool,
    /// Whether the Hessian is exact rather than convexified.
    exact: bool,
    /// Iterations so far.
    pub iterations: usize,
    gradient: Vec<DVec3>,
    /// Contact stiffness per mass, 1/s² [n].
    stiffness: Vec<f64>,
    /// Vertices that the body has no room for [n]: only the side they are worn on holds them.
    pinched: Vec<bool>,
    /// The plane that holds each of them [n].
    sides: Vec<Option<Touch>>,
    /// Planes of the body each vertex has met where it is [n].
    touches: Vec<Vec<Touch>>,
    /// How many planes each has met since the body came to rest [n].
    met: Vec<u32>,
    /// Lower bound of the distance to the body [n].
    clearance: Vec<f64>,
}

impl<'a> Solver<'a> {
    /// Starts from `positions`, at rest, in friction contact without slip.
    pub fn new(cloth: &'a Cloth, layout: &Arc<Layout>, settings: &'a Settings, positions: Vec<DVec3>) -> Self {
        let n = positions.len();
        Self {
            cloth,
            settings,
            layout: layout.clone(),
            matrix: Matrix::new(layout.pattern.clone()),
            neighbourhood: Neighbourhood::new(&cloth.elements),
            touching: 0,
            anchors: positions.clone(),
            positions,
            tracked: vec![None; n],
            contacts: Vec::new(),
            pins: Vec::new(),
            resting: false,
            exact: false,
            iterations: 0,
            gradient: vec![DVec3::ZERO; n],
            stiffness: vec![settings.contact_stiffness; n],
            pinched: vec![false; n],
            sides: vec![None; n],
            touches: vec![Vec::new(); n],
            met: vec![0; n],
            clearance: vec![0.0; n],
        }
    }

    /// Forgets distances: to be called when the body or the positions were changed from outside.
    pub fn moved(&mut self) {
        self.clearance.fill(0.0);
        self.pinched.fill(false);
        self.touches.iter_mut().for_each(Vec::clear);
        self.sides.fill(None);
    }

    /// Whether the body has no room for a vertex.
    pub fn has_no_room(&self, vertex: usize) -> bool {
        self.pinched[vertex]
    }

    /// Contacts, static forces and the Hessian for the proximal time step `h` seconds, against the posed body, if any.
    pub fn probe(&mut self, body: Option<&PosedBody>, h: f64) -> Probe {
        let least_distance = self.detect(body);
        self.assemble(h);
        let square: f64 = self.gradient.iter().map(|g| g.length_squared()).sum();
        let residual = (square / self.gradient.len() as f64).sqrt() / self.cloth.elastic.mean_weight();
        Probe { residual, least_distance, drift: f64::INFINITY }
    }

    #[cfg(test)]
    /// Least distance of cloth from cloth among the pairs that are near, metres.
    pub fn nearest_layers(&self) -> f64 {
        let distance = |pair: &super::proximity::Pair| pair.distance(&self.positions);
        self.neighbourhood.pairs.iter().map(distance).fold(f64::INFINITY, f64::min)
    }

    /// Takes the step that the last [`probe`](Self::probe) prepared; the share of the Newton step taken, 0 when the
    /// matrix or the line search failed.
    pub fn advance(&mut self, h: f64) -> f64 {
        self.iterations += 1;
        self.descend(h)
    }

    /// Iterates with growing time step until the residual is small and no vertex is inside the body, or nothing moves
    /// any more, or the cloth is jammed.
    pub fn relax(&mut self, body: Option<&PosedBody>, iterations: usize) -> Probe {
        self.relax_from(body, iterations, FIRST_TIME_STEP)
    }

    /// The same with that time step to begin with, seconds.
    fn relax_from(&mut self, body: Option<&PosedBody>, iterations: usize, mut h: f64) -> Probe {
        let mut drift = f64::INFINITY;
        let (mut before, mut shortest, mut longest) = (self.positions.clone(), h, h);
        let mut near = !self.cloth.is_fine();
        self.resting = true;
        for iteration in 1..=iterations {
            self.exact = h > EXACT_ABOVE && near;
            let mut probe = self.probe(body, h);
            if probe.residual > self.settings.residual && self.relax_locally(body, h) {
                probe = self.probe(body, h);
            }
            near = !self.cloth.is_fine() || probe.residual < FINE_EXACT_BELOW;
            if probe.residual < self.settings.residual && probe.least_distance > 0.0 {
                return Probe { drift: 0.0, ..probe };
            }
            h = match self.advance(h) {
                1.0 => (h * GROWTH).min(LONGEST_TIME_STEP),
                share if share < 0.2 => (0.4 * h).max(SHORTEST_TIME_STEP),
                _ => h,
            };
            (shortest, longest) = (h.min(shortest), h.max(longest));
            if iteration % WINDOW == 0 {
                let moves = self.positions.iter().zip(&before).map(|(x, before)| x.distance_squared(*before));
                let moved = (moves.sum::<f64>() / before.len() as f64).sqrt();
                // A short time step holds the cloth whatever pulls at it, and proves nothing.
                drift = if shortest < HOLDING { f64::INFINITY } else { moved };
                if drift < 0.1 * self.settings.drift || longest < JAMMED {
                    break;
                }
                (before, shortest, longest) = (self.positions.clone(), h, h);
            }
        }
        Probe { drift, ..self.probe(body, h) }
    }
}
