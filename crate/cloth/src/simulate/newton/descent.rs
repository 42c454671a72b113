//! The step of one Newton iteration: `H δ = -g`, shortened until the energy falls, then improved with the old factor.

use glam::DVec3;

use super::Solver;
use super::memory::Memory;

/// Longest move of a vertex in one iteration, metres.
const LONGEST_MOVE: f64 = 0.03;
/// Steps with an old factor after each Newton step.
const CORRECTIONS: usize = 2;
/// The same for a fine cloth, whose steps remember one another.
const FINE_CORRECTIONS: usize = 8;
/// Shares of such a step that are tried. With the whole one alone a lunge took 129 iterations, with both 83.
const FINE_SHARES: [f64; 2] = [1.0, 0.4];

/// Share of the barrier's offset that being carried along leaves between layers, and how often vertices are joined for
/// that.
const NEAREST: f64 = 0.5;
const ZONE_ROUNDS: usize = 6;

impl Solver<'_> {
    /// Solves for the Newton step and takes the share of it that lowers the energy.
    pub(super) fn descend(&mut self, h: f64) -> f64 {
        if !self.matrix.factorise() {
            if !self.exact {
                return 0.0;
            }
            self.exact = false;
            self.assemble(h);
            if !self.matrix.factorise() {
                return 0.0;
            }
        }
        let step = self.matrix.step(&self.gradient);
        let longest = step.iter().map(|d| d.length_squared()).fold(0.0, f64::max).sqrt();
        let slope: f64 = step.iter().zip(&self.gradient).map(|(d, g)| d.dot(*g)).sum();
        if !longest.is_finite() || !slope.is_finite() {
            return 0.0;
        }
        let scale = (LONGEST_MOVE / longest.max(1e-30)).min(1.0);
        let motion: Vec<DVec3> = step.iter().map(|d| *d * scale).collect();
        self.look_ahead(&motion);
        let start = self.energy(&self.positions);
        let mut share = self.neighbourhood.clear_way(&self.positions, &motion);
        for _ in 0..12 {
            let mut trial: Vec<DVec3> = self.positions.iter().zip(&motion).map(|(x, d)| *x + *d * share).collect();
            let wanted = start + 1e-4 * share * scale * slope + 1e-13 * start.abs();
            let energy = self.correct(&mut trial, share, h);
            if energy <= wanted {
                self.neighbourhood.follow(share);
                self.accept(trial);
                return share * scale;
            }
            share *= 0.5;
        }
        0.0
    }

    /// Makes sure that the neighbourhood knows every pair of elements that `motion` [n] can bring together.
    pub(super) fn look_ahead(&mut self, motion: &[DVec3]) {
        let end: Vec<DVec3> = self.positions.iter().zip(motion).map(|(x, d)| *x + *d).collect();
        if !self.neighbourhood.covers(&self.positions, 0.0) || !self.neighbourhood.covers(&end, 0.0) {
            self.neighbourhood.search(&self.cloth.elements, &self.positions, motion, self.cloth.gap);
        }
    }

    /// Moves the cloth by `motion` [n], vertices that would run into each other together.
    pub fn carry(&mut self, mut motion: Vec<DVec3>) {
        self.look_ahead(&motion);
        let nearest = NEAREST * self.cloth.gap;
        for _ in 0..ZONE_ROUNDS {
            if !self.neighbourhood.join(&self.positions, &mut motion, nearest) {
                break;
            }
            self.look_ahead(&motion);
        }
        let share = self.neighbourhood.clear_way(&self.positions, &motion);
        self.positions.iter_mut().zip(&motion).for_each(|(x, d)| *x += *d * share);
        self.neighbourhood.follow(share);
    }

    /// `Σ m |x - x₀|² / 2h²`.
    fn inertia(&self, x: &[DVec3], h: f64) -> f64 {
        let square = |i: usize| self.cloth.elastic.masses[i] * x[i].distance_squared(self.positions[i]);
        (0..x.len()).map(square).sum::<f64>() / (2.0 * h * h)
    }

    /// Improves `trial` by steps with the old factor while they lower the energy; the energy reached. They take back
    /// the stretch, second order in the step, that a long step along a soft direction of nearly inextensible cloth
    /// leaves behind. Without them the same rest took 2.8 times the iterations.
    fn correct(&mut self, trial: &mut Vec<DVec3>, share: f64, h: f64) -> f64 {
        let mut energy = self.energy(trial) + self.inertia(trial, h);
        let fine = self.cloth.is_fine();
        let mut memory = fine.then(|| Memory::new(&self.positions, &self.gradient));
        let (corrections, shares) = if fine { (FINE_CORRECTIONS, &FINE_SHARES[..]) } else { (CORRECTIONS, &[1.0][..]) };
        for _ in 0..corrections {
            let mut gradient = self.gradient(trial);
            for i in 0..trial.len() {
                gradient[i] += (trial[i] - self.positions[i]) * (self.cloth.elastic.masses[i] / (h * h));
            }
            let step = match &mut memory {
                Some(memory) => memory.step(&mut self.matrix, trial, gradient),
                None => self.matrix.step(&gradient),
            };
            let lower = shares.iter().find_map(|part| self.improve(trial, &step, *part, [share, h, energy]));
            let Some(lower) = lower else { break };
            (*trial, energy) = lower;
        }
        energy
    }

    /// `x` moved by a part of `step`, and the energy there, if that is lower than `energy` and the way is clear.
    fn improve(
        &self,
        x: &[DVec3],
        step: &[DVec3],
        part: f64,
        [share, h, energy]: [f64; 3],
    ) -> Option<(Vec<DVec3>, f64)> {
        let motion: Vec<DVec3> = step.iter().map(|d| *d * part).collect();
        let better: Vec<DVec3> = x.iter().zip(&motion).map(|(x, d)| *x + *d).collect();
        if !self.neighbourhood.covers(&better, share) || self.neighbourhood.clear_way(x, &motion) < 1.0 {
            return None;
        }
        let lower = self.energy(&better) + self.inertia(&better, h);
        (lower < energy).then_some((better, lower))
    }

    /// Moves to `trial`; anchors follow the vertices that slip or are free.
    fn accept(&mut self, trial: Vec<DVec3>) {
        for i in 0..trial.len() {
            self.clearance[i] -= trial[i].distance(self.positions[i]);
        }
        self.anchors.copy_from_slice(&trial);
        for contact in self.contacts.iter().filter(|contact| contact.grip > 0.0) {
            self.anchors[contact.vertex] = contact.slipped_anchor(trial[contact.vertex]);
        }
        self.positions = trial;
    }
}
