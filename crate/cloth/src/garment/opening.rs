//! Openings: where a garment stops. simulation.md §4.2.
//! Cut by limb-local planes: one global plane per pair also slit dress hems when it was tried in the prototype.

use super::curve::{arc_length, at, project};
use super::figure::Figure;
use crate::wrap::{Plane, Region};
use ctsn_rig::Character;
use ctsn_rig::statistics::Sorted;
use glam::DVec3;

/// One opening of a garment.
#[derive(Clone, Debug)]
pub(super) struct Opening {
    /// Where the garment stops.
    pub region: Region,
    /// The rim is sprung to the body where it lies on this plane.
    pub pinned: Option<Plane>,
}

/// Part of the body that the garment leaves bare.
#[derive(Clone, Debug)]
pub(super) struct Bare {
    /// Share of the bare joints in each body vertex's weights [b].
    pub share: Vec<f64>,
    /// Bare only past this plane; `None`: everywhere.
    pub plane: Option<Plane>,
}

impl Opening {
    /// An opening past one plane; the shell ends `past` metres beyond it.
    pub fn new(plane: Plane, past: f64) -> Opening {
        let end = plane.point + plane.normal * (0.7 * past);
        Opening { region: Region { groups: vec![vec![plane]], rounding: 1.0, end }, pinned: None }
    }
}

impl Figure<'_> {
    /// Plane across a limb at a fraction of the way from where it leaves the trunk (0) to its tip (1).
    pub fn across(&self, limb: usize, fraction: f64) -> Plane {
        let path = &self.limb(limb).path;
        let (root, total) = (self.leaves_trunk(limb), arc_length(path));
        let (point, normal) = at(path, root + fraction * (total - root));
        Plane { point, normal }
    }

    /// Plane across an unpaired limb (neck, tail). Its skin often starts on the shoulders: the plane is moved up the
    /// first bone until the body's section there is nearly as narrow as it gets.
    pub fn collar(&self, limb: usize, fraction: f64) -> Plane {
        let mut own = vec![1.0; self.character.body.weights.len()];
        for other in (0..self.anatomy.limbs.len()).filter(|&other| other != limb) {
            own.iter_mut().zip(self.share(other)).for_each(|(own, other)| *own -= other);
        }
        let path = &self.limb(limb).path;
        let (root, total) = (self.leaves_trunk(limb), arc_length(path));
        let bone = if self.limb(limb).chain.len() > 1 { path[0].distance(path[1]) } else { 0.0 };
        // A hunched neck leaves the trunk forwards: a collar square to it would bare chest and shoulders, so it leans
        // back.
        let lean = if self.neck == Some(limb) { if self.legs.is_some() { 3.0 } else { 1.0 } } else { 0.0 };
        let plane = |s: f64| {
            let (point, along) = at(path, s);
            Plane { point, normal: (along + self.trunk() * lean).normalize_or(along) }
        };
        let sections: Vec<(f64, f64)> = (0..=12)
            .map(|k| root + bone * 0.6 * k as f64 / 12.0)
            .map(|s| (s, section_radius(self.character, &own, &plane(s))))
            .collect();
        let least = sections.iter().fold(f64::INFINITY, |least, (_, radius)| least.min(*radius));
        let narrow = sections.iter().find(|(_, radius)| *radius <= 1.2 * least).map_or(root, |(s, _)| *s);
        plane(narrow + fraction * (total - narrow))
    }

    /// One plane across both legs.
    pub fn hem(&self, legs: [usize; 2], fraction: f64) -> Plane {
        let [a, b] = legs.map(|leg| self.across(leg, fraction));
        Plane { point: (a.point + b.point) / 2.0, normal: (a.normal + b.normal).normalize_or(DVec3::NEG_Y) }
    }

    /// Largest radius of a limb where a plane crosses it, metres.
    pub fn limb_radius(&self, limb: usize, plane: &Plane) -> f64 {
        section_radius(self.character, &self.share(limb), plane)
    }

    /// Arc length along the limb's path at which its skin has left the trunk's: where body edges change sides, nearly
    /// last.
    pub fn leaves_trunk(&self, limb: usize) -> f64 {
        let (body, share) = (&self.character.body.mesh, self.share(limb));
        let mut seam = Vec::new();
        for triangle in &body.triangles {
            for k in 0..3 {
                let (a, b) = (triangle[k] as usize, triangle[(k + 1) % 3] as usize);
                if (share[a] > 0.5) != (share[b] > 0.5) {
                    let t = (0.5 - share[a]) / (share[b] - share[a]);
                    seam.push(project(&self.limb(limb).path, body.positions[a].lerp(body.positions[b], t)));
                }
            }
        }
        // Garments are cut by it: the rank nearest to 0.9 between first and last, or old garments would differ from new
        // ones.
        let seam = Sorted::new(seam);
        let rank = (0.9 * seam.values().len().saturating_sub(1) as f64).round() as usize;
        seam.values().get(rank).copied().unwrap_or_default()
    }
}

/// Largest distance from the plane's point at which it meets skin of the given share, metres; 0 if it does not.
fn section_radius(character: &Character, own: &[f64], plane: &Plane) -> f64 {
    let positions = &character.body.mesh.positions;
    let mut radius = 0.0_f64;
    for triangle in &character.body.mesh.triangles {
        for k in 0..3 {
            let (a, b) = (triangle[k] as usize, triangle[(k + 1) % 3] as usize);
            let (da, db) = (plane.past(positions[a]), plane.past(positions[b]));
            if da * db < 0.0 && own[a].min(own[b]) > 0.5 {
                radius = radius.max(positions[a].lerp(positions[b], da / (da - db)).distance(plane.point));
            }
        }
    }
    radius
}
