//! A pattern and the pieces it is put together from: openings on limbs, hems, waistbands, what hangs, wide sleeves.

use super::curve::{arc_length, at};
use super::figure::Figure;
use super::hang::Hang;
use super::kind::Preset;
use super::opening::{Bare, Opening};
use crate::wrap::Plane;
use glam::DVec3;

/// A tube around a limb, wider than the limb.
#[derive(Clone, Debug)]
pub(super) struct Sleeve {
    /// Axis, metres.
    pub path: Vec<DVec3>,
    /// Radius at every point of the axis, metres.
    pub radii: Vec<f64>,
    /// Ends here.
    pub end: Plane,
}

/// How a garment is cut on one body.
#[derive(Clone, Debug, Default)]
pub(super) struct Pattern {
    /// Where it stops.
    pub openings: Vec<Opening>,
    /// What it does not cover.
    pub bare: Vec<Bare>,
    /// Where it falls free.
    pub hangs: Vec<Hang>,
    /// Wide sleeves.
    pub sleeves: Vec<Sleeve>,
    /// Past the second plane, cloth keeps off the first: trouser legs of thighs that touch.
    pub gap: Option<[Plane; 2]>,
}

impl Pattern {
    /// Room for what hangs and widens, around the covered body, metres.
    pub fn room(&self, past: f64) -> f64 {
        past + self.hangs.iter().map(|hang| hang.flare * hang.length).fold(0.0, f64::max)
    }
}

/// What every pattern is drawn from.
pub(super) struct Draft<'a> {
    /// Whom it is for.
    pub figure: &'a Figure<'a>,
    /// The kind's numbers.
    pub preset: &'a Preset,
    /// Distance from the body, metres.
    pub loose: f64,
    /// Metres by which the shell runs on past each opening, so that its end does not bend the cut.
    pub past: f64,
}

impl Draft<'_> {
    /// Everything above the waist bare, an opening with a waistband there.
    pub fn below_waist(&self, legs: [usize; 2]) -> Pattern {
        let figure = self.figure;
        let (point, normal) = at(&figure.spine, self.preset.waist * arc_length(&figure.spine));
        let plane = Plane { point, normal };
        let mut upper = vec![1.0; figure.character.body.weights.len()];
        let mut bare = Vec::new();
        for limb in 0..figure.anatomy.limbs.len() {
            let share = figure.share(limb);
            if legs.contains(&limb) {
                upper.iter_mut().zip(share).for_each(|(upper, share)| *upper -= share);
            } else {
                bare.push(Bare { share, plane: None });
            }
        }
        bare.push(Bare { share: upper, plane: Some(plane) });
        let waist = Opening { pinned: Some(plane), ..Opening::new(plane, self.past) };
        Pattern { openings: vec![waist], bare, ..Pattern::default() }
    }

    /// An opening on one limb that is no leg of a hem.
    pub fn stop_on(&self, limb: usize, pattern: &mut Pattern) -> Plane {
        let paired = self.figure.limb(limb).mirror.is_some();
        let plane = match paired {
            true => self.figure.across(limb, self.preset.sleeve),
            false => self.figure.collar(limb, self.preset.collar),
        };
        pattern.openings.push(Opening::new(plane, self.past));
        pattern.bare.push(Bare { share: self.figure.share(limb), plane: Some(plane) });
        plane
    }

    /// One opening around two legs.
    pub fn stop_at_hem(&self, legs: [usize; 2], hem: Plane, pattern: &mut Pattern) {
        pattern.openings.push(Opening::new(hem, self.past));
        let [a, b] = legs.map(|leg| self.figure.share(leg));
        let share = a.iter().zip(&b).map(|(a, b)| a + b).collect();
        pattern.bare.push(Bare { share, plane: Some(hem) });
    }

    /// Cloth that falls from a point past the hem.
    pub fn hang(&self, start: DVec3, hem: Plane) -> Hang {
        let length = self.past - hem.past(start);
        Hang { start, fall: hem.normal, length, flare: self.preset.flare, within: None }
    }

    /// A fraction of the way from the hip to where the last limbs leave the trunk.
    pub fn on_spine(&self, fraction: f64) -> DVec3 {
        at(&self.figure.spine, fraction * arc_length(&self.figure.spine)).0
    }

    /// A tube that widens from the upper arm on and hangs below the arm.
    pub fn sleeve(&self, arm: usize) -> Sleeve {
        let figure = self.figure;
        let end = figure.across(arm, self.preset.sleeve);
        let path = &figure.limb(arm).path;
        let first = figure.leaves_trunk(arm);
        let last = first + self.preset.sleeve * (arc_length(path) - first) + 2.0 * self.past;
        let radius = figure.limb_radius(arm, &figure.across(arm, 0.25)) + self.loose;
        let mut sleeve = Sleeve { path: Vec::new(), radii: Vec::new(), end: end.moved(self.past) };
        for k in 0..=8 {
            let s = first + (last - first) * f64::from(k) / 8.0;
            let (point, along) = at(path, s);
            let wider = self.preset.sleeve_flare * (s - first);
            let down = DVec3::NEG_Y - along * along.dot(DVec3::NEG_Y);
            sleeve.path.push(point + down * wider);
            sleeve.radii.push(radius + wider);
        }
        sleeve
    }
}
