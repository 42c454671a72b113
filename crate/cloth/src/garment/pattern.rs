//! The pattern of a kind on a figure: which parts of the body it covers, where it stops, where cloth falls free of the
//! body. One opening is one boundary loop of the garment.

use super::curve::{arc_length, at};
use super::draft::{Draft, Pattern};
use super::figure::Figure;
use super::hang::Hang;
use super::kind::{Build, Kind, Preset};
use super::opening::{Bare, Opening};
use crate::wrap::{Plane, Region};
use glam::DVec3;

/// Radius of a cape's corners, in body extents.
const CORNER: f64 = 0.03;

/// The pattern; `past`: metres by which the shell runs on past each opening, so that its end does not bend the cut.
pub(super) fn pattern(figure: &Figure, kind: Kind, preset: &Preset, loose: f64, past: f64) -> Pattern {
    let draft = Draft { figure, preset, loose, past };
    match (kind, figure.legs, figure.build()) {
        (_, _, Build::Limbless | Build::Rail) => draft.tube(),
        (Kind::Skirt, Some(legs), _) => draft.skirt(legs),
        (Kind::Trousers, Some(legs), _) => draft.trousers(legs),
        (Kind::Cape, Some(legs), _) => draft.cape(legs),
        (Kind::Cape, None, _) => draft.saddle(),
        (Kind::Vest, _, _) => draft.vest(),
        // The wide collar of a robe would slide off a hunched figure's shoulders.
        (_, legs, _) => draft.suit(legs, kind == Kind::Robe),
    }
}

impl Draft<'_> {
    /// Trunk with an opening on every limb, legs that continue the trunk sharing one: shirt, dress, robe, coat.
    /// `fastened`: whether the collar is pinned.
    fn suit(&self, legs: Option<[usize; 2]>, fastened: bool) -> Pattern {
        let mut pattern = Pattern::default();
        for limb in 0..self.figure.anatomy.limbs.len() {
            if legs.is_some_and(|legs| legs.contains(&limb)) {
                continue;
            }
            let plane = self.stop_on(limb, &mut pattern);
            if fastened && self.figure.neck == Some(limb) {
                pattern.openings.iter_mut().rev().take(1).for_each(|collar| collar.pinned = Some(plane));
            }
            if self.preset.sleeve_flare > 0.0 && self.figure.arms.is_some_and(|arms| arms.contains(&limb)) {
                pattern.sleeves.push(self.sleeve(limb));
            }
        }
        if let Some(legs) = legs {
            let hem = self.figure.hem(legs, self.preset.hem);
            self.stop_at_hem(legs, hem, &mut pattern);
            pattern.hangs.push(self.hang(self.on_spine(self.preset.waist), hem));
        }
        pattern
    }

    /// From a waistband down, one tube around both legs.
    fn skirt(&self, legs: [usize; 2]) -> Pattern {
        let mut pattern = self.below_waist(legs);
        let hem = self.figure.hem(legs, self.preset.hem);
        self.stop_at_hem(legs, hem, &mut pattern);
        pattern.hangs.push(self.hang(self.on_spine(self.preset.waist), hem));
        pattern
    }

    /// From a waistband down, a tube per leg.
    fn trousers(&self, legs: [usize; 2]) -> Pattern {
        let mut pattern = self.below_waist(legs);
        for leg in legs {
            let plane = self.figure.across(leg, self.preset.hem);
            pattern.openings.push(Opening::new(plane, self.past));
            pattern.bare.push(Bare { share: self.figure.share(leg), plane: Some(plane) });
        }
        let down = self.figure.hem(legs, self.preset.hem).normal;
        let [a, b] = legs.map(|leg| self.figure.limb(leg).path[0]);
        let middle = Plane { point: (a + b) / 2.0, normal: self.figure.lateral(legs) };
        let point = self.figure.crotch(legs, &middle, down);
        pattern.gap = Some([middle, Plane { point, normal: down }]);
        pattern
    }

    /// A tent from the shoulders to the hem, of which the back remains.
    fn cape(&self, legs: [usize; 2]) -> Pattern {
        let Draft { figure, preset, .. } = *self;
        let mut pattern = Pattern::default();
        let hem = figure.hem(legs, preset.hem);
        self.stop_at_hem(legs, hem, &mut pattern);
        let (lateral, forward, trunk) = (figure.lateral(legs), figure.forward, figure.trunk());
        let top = figure.spine[figure.spine.len() - 1];
        let mut width = 0.1 * figure.extent;
        if let Some(arms) = figure.arms {
            let [a, b] = arms.map(|arm| figure.limb(arm).path[0]);
            width = 1.15 * (a - b).dot(lateral).abs() / 2.0;
            for arm in arms {
                let plane = figure.across(arm, 0.05);
                pattern.bare.push(Bare { share: figure.share(arm), plane: Some(plane) });
            }
        }
        let side = |sign: f64| {
            let normal = (lateral * sign + trunk * preset.flare).normalize();
            Plane { point: top + lateral * (sign * width), normal }
        };
        let mut groups = vec![vec![side(1.0)], vec![side(-1.0)], vec![hem]];
        let collar = figure.neck.map(|neck| figure.collar(neck, preset.collar));
        // The front edges meet the neck a little before its middle: farther forward they would close around it.
        let neck =
            figure.neck.zip(collar).map(|(neck, collar)| (collar.point, 0.4 * figure.limb_radius(neck, &collar)));
        let (point, ahead) = neck.unwrap_or((top, 0.03 * figure.extent));
        groups.push(vec![Plane { point: point + forward * ahead, normal: forward }]);
        if let (Some(neck), Some(collar)) = (figure.neck, collar) {
            groups.push(vec![collar]);
            pattern.bare.push(Bare { share: figure.share(neck), plane: Some(collar) });
        }
        pattern.hangs.push(self.hang(top - trunk * (0.02 * figure.extent), hem));
        let end = figure.spine[0] + forward * figure.extent;
        let rounding = CORNER * figure.extent;
        pattern.openings = vec![Opening { region: Region { groups, rounding, end }, pinned: collar }];
        pattern
    }

    /// An animal's cape: over back and sides, open under the belly, closed around the neck.
    fn saddle(&self) -> Pattern {
        let Draft { figure, preset, past, .. } = *self;
        let mut pattern = Pattern::default();
        for limb in 0..figure.anatomy.limbs.len() {
            self.stop_on(limb, &mut pattern);
        }
        pattern.openings.clear();
        let mut groups = Vec::new();
        let limbs = &figure.anatomy.limbs;
        let legs: Vec<usize> = (0..limbs.len()).filter(|&limb| limbs[limb].mirror.is_some()).collect();
        let points: Vec<DVec3> = legs.iter().map(|&leg| figure.across(leg, preset.sleeve).point).collect();
        let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        let edge = Plane { point: middle, normal: DVec3::NEG_Y };
        let mut under = vec![edge];
        let mut within = None;
        if let Some(neck) = figure.neck {
            let collar = figure.collar(neck, preset.collar);
            pattern.openings.push(Opening { pinned: Some(collar), ..Opening::new(collar, past) });
            let strap = Plane { point: collar.point - collar.normal * (0.06 * figure.extent), normal: -collar.normal };
            under.push(strap);
            within = Some(Plane { normal: collar.normal, ..strap });
        }
        groups.push(under);
        if let Some(tail) = figure.tail {
            groups.push(vec![Plane { point: figure.limb(tail).path[0], normal: -figure.trunk() }]);
        }
        let start = at(&figure.spine, 0.5 * arc_length(&figure.spine)).0;
        pattern.hangs.push(Hang { within, ..self.hang(start, edge) });
        let end = start + edge.normal * figure.extent;
        let region = Region { groups, rounding: CORNER * figure.extent, end };
        pattern.openings.push(Opening { region, pinned: None });
        pattern
    }

    /// A band around the trunk with holes for the front limbs.
    fn vest(&self) -> Pattern {
        let figure = self.figure;
        let mut pattern = Pattern::default();
        let mut rear = vec![1.0; figure.character.body.weights.len()];
        let stops: Vec<usize> = figure.arms.into_iter().flatten().chain(figure.neck).collect();
        for limb in stops {
            self.stop_on(limb, &mut pattern);
            rear.iter_mut().zip(figure.share(limb)).for_each(|(rear, share)| *rear -= share);
        }
        let front: Vec<DVec3> = figure.arms.into_iter().flatten().map(|limb| figure.limb(limb).path[0]).collect();
        let middle = front.iter().sum::<DVec3>() / front.len().max(1) as f64;
        let normal = -figure.trunk();
        let plane = Plane { point: middle + normal * (0.18 * figure.extent), normal };
        pattern.openings.push(Opening::new(plane, self.past));
        pattern.bare.push(Bare { share: rear, plane: Some(plane) });
        pattern
    }

    /// Without limbs to go by (one joint, fish, snake): the middle half of the body along its longest axis.
    fn tube(&self) -> Pattern {
        let positions = &self.figure.character.body.mesh.positions;
        let [low, high] = self.figure.character.body.mesh.bounds();
        let axis = DVec3::AXES[(high - low).max_position()];
        let mut pattern = Pattern::default();
        for normal in [-axis, axis] {
            let plane = Plane { point: (low + high) / 2.0 + normal * (0.25 * (high - low).max_element()), normal };
            pattern.openings.push(Opening::new(plane, self.past));
            pattern.bare.push(Bare { share: vec![1.0; positions.len()], plane: Some(plane) });
        }
        pattern
    }
}
