//! Where the cloth touches the body: contact planes of one iteration, and the vertices that one side of it alone holds
//! because no place is outside all of the body.

use glam::DVec3;

use super::Solver;
use crate::simulate::contact::Contact;
use crate::simulate::posed::{Hit, PosedBody};

/// A vertex further than this beyond the contact offset is not looked at, metres.
const MARGIN: f64 = 0.015;
/// How far from the side it is worn on a vertex without room is held by it, metres.
const SIDE: f64 = 0.05;
/// Factor by which a contact that gave way too far is stiffened, and how often it may be.
const STIFFENING: f64 = 3.0;
const STIFFEST: f64 = 30.0;
/// A vertex keeps a contact plane until it is this far from where it met it, metres. With the nearest plane only,
/// vertices in a crease jumped from side to side for good, and a cloth at rest everywhere else never counted as
/// converged.
const MEMORY: f64 = 0.001;
/// Planes whose normals have a larger cosine are one side of the body.
const SAME_SIDE: f64 = 0.95;

/// Planes a vertex may meet once the body is at rest before there is no room for it: among fingers it jumps from one to
/// the next for good.
const MOST_MET: u32 = 12;
/// Planes whose normals have a smaller cosine face each other.
const FACING: f64 = -0.7;

/// A plane of the body that a vertex has met.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    normal: DVec3,
    /// `d(x) = normal · x - plane`.
    plane: f64,
    /// Where the vertex was.
    at: DVec3,
}

impl Touch {
    /// The plane at `hit` of a vertex at `at`.
    fn new(hit: &Hit, at: DVec3) -> Self {
        Self { normal: hit.normal, plane: hit.normal.dot(at) - hit.distance, at }
    }
}

impl Solver<'_> {
    /// Finds the contact planes; the least signed distance of a vertex that is not pinched.
    pub(super) fn detect(&mut self, body: Option<&PosedBody>) -> f64 {
        let mut least = f64::INFINITY;
        let thickness = self.settings.thickness;
        let room = 2.0 * thickness + self.cloth.gap;
        self.contacts.clear();
        let Some(body) = body else { return least };
        for i in 0..self.positions.len() {
            if self.clearance[i] > thickness + MARGIN {
                continue;
            }
            if self.resting && self.pinched[i] {
                self.hold(i, body);
                continue;
            }
            let (x, reach) = (self.positions[i], thickness + 2.0 * MARGIN);
            let hit = body.closest(x, self.tracked[i], reach);
            self.clearance[i] = hit.map_or(reach, |hit| hit.distance.max(0.0));
            let Some(hit) = hit.filter(|hit| hit.distance < thickness + MARGIN) else { continue };
            self.tracked[i] = Some(hit.face);
            self.pinched[i] = body.is_buried(hit.face, room);
            if self.pinched[i] {
                self.hold(i, body);
                continue;
            }
            least = least.min(hit.distance);
            let limit = STIFFEST * self.settings.contact_stiffness;
            if hit.distance < 0.25 * thickness && self.stiffness[i] < limit {
                self.stiffness[i] *= STIFFENING;
            }
            let second =
                (hit.distance < 1.5 * thickness).then(|| body.across_crease(x, &hit, 2.0 * thickness)).flatten();
            let second = second.filter(|second| !body.is_buried(second.face, room));
            self.remember(i, &hit);
            second.iter().for_each(|second| self.remember(i, second));
            if self.resting && (self.met[i] > MOST_MET || self.is_between(i)) {
                self.pinched[i] = true;
                self.hold(i, body);
                continue;
            }
            for (k, touch) in self.touches[i].iter().enumerate() {
                // One plane rubs: which one must not depend on which is nearer.
                let friction = if k == 0 { self.cloth.friction } else { 0.0 };
                self.contacts.push(self.contact(i, touch, friction));
            }
        }
        least
    }

    /// Where the body has no room for a vertex, the side that it is worn on alone holds it: an arm in the chest keeps
    /// its sleeve, which was drawn through it where nothing held it. The plane stays while the body rests, for deep
    /// inside the nearest place of a side jumps. Neither stiffened nor rubbing: either left more poses out, and so did
    /// a third of the stiffness. docs/decisions/simulation.md
    fn hold(&mut self, vertex: usize, body: &PosedBody) {
        if !self.resting || self.sides[vertex].is_none() {
            let at = self.positions[vertex];
            let hit = self.cloth.worn[vertex].and_then(|face| body.closest_on_side(at, face, SIDE));
            self.sides[vertex] = hit.map(|hit| Touch::new(&hit, at));
        }
        if let Some(side) = self.sides[vertex] {
            let stiffness = self.settings.contact_stiffness * self.cloth.elastic.masses[vertex];
            self.contacts.push(Contact { stiffness, ..self.contact(vertex, &side, 0.0) });
        }
    }

    /// Puts a plane in the place of the one on its side, or adds it; forgets those met elsewhere.
    fn remember(&mut self, vertex: usize, hit: &Hit) {
        let at = self.positions[vertex];
        let new = Touch::new(hit, at);
        let touches = &mut self.touches[vertex];
        match touches.iter_mut().find(|touch| touch.normal.dot(new.normal) > SAME_SIDE) {
            Some(same) => *same = new,
            None => {
                touches.push(new);
                self.met[vertex] += u32::from(self.resting);
            }
        }
        touches.retain(|touch| touch.at.distance(at) < MEMORY);
    }

    /// Whether two sides of the body that face each other leave a vertex no room.
    fn is_between(&self, vertex: usize) -> bool {
        let touches = &self.touches[vertex];
        let room = 2.0 * self.settings.thickness;
        let closed = |a: &Touch, b: &Touch| {
            let distance = |touch: &Touch| touch.normal.dot(self.positions[vertex]) - touch.plane;
            a.normal.dot(b.normal) < FACING && distance(a) + distance(b) < room
        };
        touches.iter().any(|a| touches.iter().any(|b| closed(a, b)))
    }

    fn contact(&self, vertex: usize, touch: &Touch, friction: f64) -> Contact {
        let Touch { normal, plane, .. } = *touch;
        let offset = self.settings.thickness;
        let stiffness = self.stiffness[vertex] * self.cloth.elastic.masses[vertex];
        let distance = normal.dot(self.positions[vertex]) - plane;
        let grip = friction * stiffness * (offset - distance).max(0.0);
        Contact { vertex, normal, plane, offset, stiffness, grip, anchor: self.anchors[vertex] }
    }
}
