//! Energy, gradient and Hessian of everything that acts on the cloth, contacts frozen.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::Solver;
use super::layout::{Layout, packed};
use crate::simulate::material::GRAVITY;
use crate::simulate::matrix::{Matrix, outer};
use crate::simulate::proximity::barrier;

impl Solver<'_> {
    /// Static gradient, and the Hessian of the proximal problem.
    pub(super) fn assemble(&mut self, h: f64) {
        self.couple();
        let Self { cloth, layout, matrix, positions: x, gradient, exact, .. } = self;
        matrix.clear();
        gradient.fill(DVec3::ZERO);
        for (triangle, addresses) in cloth.elastic.triangles.iter().zip(&layout.triangles) {
            let v = triangle.vertices;
            let forces = triangle.derivatives(&cloth.elastic.membrane, x, *exact, |a, b, block| {
                let ordered = if v[a] < v[b] { block.transpose() } else { block };
                matrix.add(addresses[packed(a, b)], ordered, a == b);
            });
            (0..3).for_each(|a| gradient[v[a]] += forces[a]);
        }
        for (hinge, addresses) in cloth.elastic.hinges.iter().zip(&layout.hinges) {
            let v = hinge.vertices;
            let forces = hinge.derivatives(x, *exact, |a, b, block| {
                let ordered = if v[a] < v[b] { block.transpose() } else { block };
                matrix.add(addresses[packed(a, b)], ordered, a == b);
            });
            (0..4).for_each(|a| gradient[v[a]] += forces[a]);
        }
        for i in 0..x.len() {
            let mass = cloth.elastic.masses[i];
            gradient[i].y += mass * GRAVITY;
            matrix.add(layout.diagonal[i], DMat3::from_diagonal(DVec3::splat(mass / (h * h))), true);
        }
        for contact in &self.contacts {
            let (force, stiffness) = contact.derivatives(x[contact.vertex]);
            gradient[contact.vertex] += force;
            matrix.add(layout.diagonal[contact.vertex], stiffness, true);
        }
        for pin in &self.pins {
            let (force, stiffness) = pin.derivatives(x[pin.vertex]);
            gradient[pin.vertex] += force;
            matrix.add(layout.diagonal[pin.vertex], stiffness, true);
        }
        self.repel();
    }

    /// Makes sure the matrix has room for every pair of elements within the barrier.
    fn couple(&mut self) {
        self.look_ahead(&vec![DVec3::ZERO; self.positions.len()]);
        let offset = self.cloth.gap;
        let near = |factor: f64| {
            let x = &self.positions;
            let near = self.neighbourhood.pairs.iter().filter(move |pair| pair.distance(x) < factor * offset);
            near.map(|pair| pair.vertices()).collect::<Vec<_>>()
        };
        self.touching = near(1.0).len();
        if near(1.0).iter().all(|group| self.layout.pattern.holds(group)) {
            return;
        }
        // Those a little further off, too: the next iterations will want them.
        if let Ok(layout) = Layout::new(self.cloth, &near(1.5)) {
            self.matrix = Matrix::new(layout.pattern.clone());
            self.layout = Arc::new(layout);
        }
    }

    /// Adds the barriers between elements of the cloth: gradient, and Hessian `k b″ ∇d ∇dᵀ` without the negative rest.
    fn repel(&mut self) {
        let Self { cloth, layout, matrix, positions, gradient, neighbourhood, .. } = self;
        for pair in &neighbourhood.pairs {
            let v = pair.vertices();
            let (weights, shortest) = pair.shortest(&v.map(|i| positions[i]));
            let distance = shortest.length();
            let [_, slope, curvature] = barrier(distance, cloth.gap).map(|b| b * cloth.repulsion);
            if curvature == 0.0 {
                continue;
            }
            let normal = shortest / distance.max(1e-12);
            let across = outer(normal, normal) * curvature;
            for a in 0..4 {
                gradient[v[a]] += normal * (slope * weights[a]);
                for b in (0..4).filter(|&b| v[b] <= v[a]) {
                    let address = layout.pattern.address(v[a], v[b]);
                    matrix.add(address, across * (weights[a] * weights[b]), a == b);
                }
            }
        }
    }

    /// Potential energy at `x`, contacts frozen, joules; infinite where cloth touches cloth.
    pub fn energy(&self, x: &[DVec3]) -> f64 {
        let cloth = self.cloth;
        let membrane: f64 = cloth.elastic.triangles.iter().map(|t| t.energy(&cloth.elastic.membrane, x)).sum();
        let bending: f64 = cloth.elastic.hinges.iter().map(|h| h.energy(x)).sum();
        let weight = cloth.elastic.weight(x);
        let contact: f64 = self.contacts.iter().map(|contact| contact.energy(x[contact.vertex])).sum();
        let pins: f64 = self.pins.iter().map(|pin| pin.energy(x[pin.vertex])).sum();
        let barriers = self.neighbourhood.pairs.iter().map(|pair| barrier(pair.distance(x), cloth.gap)[0]);
        membrane + bending + weight + contact + pins + barriers.sum::<f64>() * cloth.repulsion
    }

    /// Static gradient at `x`, contacts frozen, newtons [n].
    pub(super) fn gradient(&self, x: &[DVec3]) -> Vec<DVec3> {
        let cloth = self.cloth;
        let mut gradient: Vec<DVec3> = cloth.elastic.masses.iter().map(|m| DVec3::Y * (m * GRAVITY)).collect();
        for triangle in &cloth.elastic.triangles {
            let forces = triangle.gradient(&cloth.elastic.membrane, x);
            (0..3).for_each(|a| gradient[triangle.vertices[a]] += forces[a]);
        }
        for hinge in &cloth.elastic.hinges {
            let forces = hinge.gradient(x);
            (0..4).for_each(|a| gradient[hinge.vertices[a]] += forces[a]);
        }
        self.contacts.iter().for_each(|contact| gradient[contact.vertex] += contact.derivatives(x[contact.vertex]).0);
        self.pins.iter().for_each(|pin| gradient[pin.vertex] += pin.derivatives(x[pin.vertex]).0);
        for pair in &self.neighbourhood.pairs {
            let v = pair.vertices();
            let (weights, shortest) = pair.shortest(&v.map(|i| x[i]));
            let distance = shortest.length();
            let slope = barrier(distance, cloth.gap)[1] * cloth.repulsion / distance.max(1e-12);
            (0..4).for_each(|a| gradient[v[a]] += shortest * (slope * weights[a]));
        }
        gradient
    }
}
