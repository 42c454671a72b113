//! Where the cloth touches the body: contact planes of one iteration, and the vertices that are let go because no place is
//! outside all of the body.

use glam::DVec3;

use super::Solver;
use crate::simulate::contact::Contact;
use crate::simulate::posed::{Hit, PosedBody};

/// A vertex further than this beyond the contact offset is not looked at, metres.
const MARGIN: f64 = 0.015;
/// Factor by which a contact that gave way too far is stiffened, and how often it may be.
const STIFFENING: f64 = 3.0;
const STIFFEST: f64 = 30.0;
/// Changes of contact planes after which a vertex is let go.
const MOST_CHANGES: u32 = 8;

impl Solver<'_> {
    /// Finds the contact planes; the least signed distance of a vertex that is not pinched.
    pub(super) fn detect(&mut self, body: Option<&PosedBody>) -> f64 {
        let mut least = f64::INFINITY;
        let thickness = self.settings.thickness;
        self.contacts.clear();
        self.inside = 0;
        let Some(body) = body else { return least };
        for i in 0..self.positions.len() {
            if self.clearance[i] > thickness + MARGIN || self.stiffening && self.pinched[i] {
                continue;
            }
            let (x, reach) = (self.positions[i], thickness + 2.0 * MARGIN);
            let hit = body.closest(x, self.tracked[i], reach);
            self.clearance[i] = hit.map_or(reach, |hit| hit.distance.max(0.0));
            let Some(hit) = hit.filter(|hit| hit.distance < thickness + MARGIN) else { continue };
            self.tracked[i] = Some(hit.face);
            self.pinched[i] = body.is_buried(hit.face, thickness);
            if self.pinched[i] {
                continue;
            }
            least = least.min(hit.distance);
            self.inside += usize::from(hit.distance < 0.0);
            let limit = STIFFEST * self.settings.contact_stiffness;
            if self.stiffening && hit.distance < 0.25 * thickness && self.stiffness[i] < limit {
                self.stiffness[i] *= STIFFENING;
            }
            self.contacts.push(self.contact(i, &hit, self.cloth.friction));
            let near_crease = hit.distance < 1.5 * thickness;
            let second = near_crease.then(|| body.across_crease(x, &hit, 2.0 * thickness)).flatten();
            let second = second.filter(|second| !body.is_buried(second.face, thickness));
            if let Some(second) = &second {
                self.contacts.push(self.contact(i, second, 0.0));
            }
            if self.stiffening && near_crease {
                self.watch(i, [hit.normal, second.map_or(hit.normal, |second| second.normal)]);
            }
        }
        least
    }

    /// Lets a vertex go whose contact planes keep changing: a crease of more sides than two planes can describe.
    fn watch(&mut self, vertex: usize, planes: [DVec3; 2]) {
        let known = |plane: DVec3| self.planes[vertex].iter().any(|old| *old == DVec3::ZERO || old.dot(plane) > 0.9);
        if !planes.into_iter().all(known) {
            self.changes[vertex] += 1;
        }
        self.planes[vertex] = planes;
        self.pinched[vertex] |= self.changes[vertex] >= MOST_CHANGES;
    }

    fn contact(&self, vertex: usize, hit: &Hit, friction: f64) -> Contact {
        let offset = self.settings.thickness;
        let stiffness = self.stiffness[vertex] * self.cloth.masses[vertex];
        let force = stiffness * (offset - hit.distance).max(0.0);
        let plane = hit.normal.dot(self.positions[vertex]) - hit.distance;
        let (grip, anchor) = (friction * force, self.anchors[vertex]);
        Contact { vertex, normal: hit.normal, plane, offset, stiffness, grip, anchor }
    }
}
