//! Near rest a few vertices snap from one fold to the next, and each snap would cost the whole cloth a factorisation.
//! So between two steps of the whole they are relaxed by themselves, the rest held (nonlinear elimination, Cai & Li
//! 2011).

use std::sync::Arc;

use glam::DVec3;

use super::{Layout, Solver};
use crate::simulate::contact::Pin;
use crate::simulate::part::Part;
use crate::simulate::posed::PosedBody;

/// Share of the RMS force from which on a vertex is one of them, and how many rings of neighbours are relaxed with it.
const STRONG: f64 = 0.5;
const RINGS: usize = 3;
/// Share of the cloth from which on forces are nowhere in particular. With half of it the same poses took 1.5 times as
/// long, with a tenth or a sixth not all came to rest.
const MOST: f64 = 0.25;
/// Newton iterations of such a part.
const ITERATIONS: usize = 15;
/// Time step from which on it is near rest, seconds. From the first iteration on nothing was gained.
const NEAR_REST: f64 = 1.0;
/// Stiffness of what holds the rest, N/m.
const HELD: f64 = 1e8;

impl Solver<'_> {
    /// Relaxes the vertices on which forces are concentrated until those are as small as elsewhere; whether there were
    /// any, and they moved. To be called after a [`probe`](Solver::probe) for the time step `h` seconds.
    pub(in crate::simulate) fn relax_locally(&mut self, body: Option<&PosedBody>, h: f64) -> bool {
        if !self.cloth.is_fine() || h < NEAR_REST {
            return false;
        }
        let Some((free, target)) = self.concentrated() else { return false };
        let part = self.cloth.part_around(&free, self.near(&free));
        let cloth = self.cloth.part(&part);
        let Ok(layout) = Layout::new(&cloth, &[]) else { return false };
        let mut settings = self.settings.clone();
        settings.residual = target.max(settings.residual);
        let Part { vertices, free } = part;
        let x = vertices.iter().map(|&v| self.positions[v]).collect();
        let mut solver = Solver::new(&cloth, &Arc::new(layout), &settings, x);
        self.lend(&mut solver, &vertices, free);
        solver.relax_from(body, ITERATIONS, h);
        let mut motion = vec![DVec3::ZERO; self.positions.len()];
        for (local, &v) in vertices[..free].iter().enumerate() {
            motion[v] = solver.positions[local] - self.positions[v];
        }
        self.look_ahead(&motion);
        if self.neighbourhood.clear_way(&self.positions, &motion) < 1.0 {
            return false;
        }
        self.neighbourhood.follow(1.0);
        self.take_back(solver, &vertices[..free]);
        true
    }

    /// Which vertices those are [n], and the RMS force of the others in mean vertex weights.
    fn concentrated(&self) -> Option<(Vec<bool>, f64)> {
        let n = self.gradient.len();
        let mean = self.gradient.iter().map(|g| g.length_squared()).sum::<f64>() / n as f64;
        let mut free: Vec<bool> = self.gradient.iter().map(|g| g.length_squared() > STRONG * STRONG * mean).collect();
        let others = self.gradient.iter().zip(&free).filter(|(_, strong)| !**strong);
        let rest = others.map(|(g, _)| g.length_squared()).sum::<f64>() / n as f64;
        (0..RINGS).for_each(|_| self.cloth.spread(&mut free));
        let count = free.iter().filter(|free| **free).count();
        ((count as f64) < MOST * n as f64).then(|| (free, rest.sqrt() / self.cloth.elastic.mean_weight()))
    }

    /// The cloth that free vertices may meet [n].
    fn near(&self, free: &[bool]) -> Vec<bool> {
        let mut near = vec![false; free.len()];
        for pair in &self.neighbourhood.pairs {
            if pair.vertices().iter().any(|&v| free[v]) {
                pair.vertices().iter().for_each(|&v| near[v] = true);
            }
        }
        near
    }

    /// Gives a solver of some vertices what is known of them, and holds all but the first `count`.
    fn lend(&self, part: &mut Solver, vertices: &[usize], count: usize) {
        part.resting = self.resting;
        for (local, &v) in vertices.iter().enumerate() {
            part.anchors[local] = self.anchors[v];
            part.tracked[local] = self.tracked[v];
            part.stiffness[local] = self.stiffness[v];
            part.pinched[local] = self.pinched[v];
            part.touches[local].clone_from(&self.touches[v]);
            part.met[local] = self.met[v];
            part.sides[local] = self.sides[v];
            // What is held touches nothing.
            part.clearance[local] = if local < count { self.clearance[v] } else { f64::INFINITY };
        }
        let local =
            |pin: &Pin| vertices[..count].iter().position(|&v| v == pin.vertex).map(|vertex| Pin { vertex, ..*pin });
        part.pins = self.pins.iter().filter_map(local).collect();
        let held =
            (count..vertices.len()).map(|vertex| Pin { vertex, target: part.positions[vertex], stiffness: HELD });
        part.pins.extend(held);
    }

    fn take_back(&mut self, mut part: Solver, vertices: &[usize]) {
        for (local, &v) in vertices.iter().enumerate() {
            self.positions[v] = part.positions[local];
            self.anchors[v] = part.anchors[local];
            self.tracked[v] = part.tracked[local];
            self.stiffness[v] = part.stiffness[local];
            self.pinched[v] = part.pinched[local];
            self.touches[v] = std::mem::take(&mut part.touches[local]);
            self.met[v] = part.met[local];
            self.sides[v] = part.sides[local];
            self.clearance[v] = part.clearance[local];
        }
    }
}
