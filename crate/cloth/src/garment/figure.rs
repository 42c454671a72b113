//! What a tailor needs to know of a body: where trunk, legs, arms, neck and tail are, and which way it faces.

use super::curve::arc_length;
use super::kind::Build;
use crate::wrap::{Anatomy, Limb, Plane, anatomy, below, joint_positions, membership};
use ctsn_rig::Character;
use glam::DVec3;

/// Room cloth wants on either side of the plane between two legs, in body extents.
const ROOM: f64 = 0.006;

/// A body's anatomy in tailor's terms.
pub(super) struct Figure<'a> {
    /// Whose.
    pub character: &'a Character,
    /// Largest side of the bounding box, metres.
    pub extent: f64,
    /// Trunk and limbs.
    pub anatomy: Anatomy,
    /// From the hip along the trunk to where the last pair of limbs hangs, metres; at least two points.
    pub spine: Vec<DVec3>,
    /// The two legs that share a hem: limbs that continue the trunk downwards.
    pub legs: Option<[usize; 2]>,
    /// The last pair of limbs along the trunk that are no such legs: arms, front legs, fins.
    pub arms: Option<[usize; 2]>,
    /// The unpaired limb that goes on where the trunk ends.
    pub neck: Option<usize>,
    /// The unpaired limb that goes the other way.
    pub tail: Option<usize>,
    /// Unit direction in which the feet of the legs point, square to the trunk.
    pub forward: DVec3,
}

impl<'a> Figure<'a> {
    /// Looks at a body of the given extent, metres.
    pub fn new(character: &'a Character, extent: f64) -> Figure<'a> {
        let anatomy = anatomy(character, extent);
        let (spine, forward) = (Vec::new(), DVec3::Z);
        let mut figure =
            Figure { character, extent, anatomy, spine, legs: None, arms: None, neck: None, tail: None, forward };
        if !figure.anatomy.limbs.is_empty() {
            figure.spine = figure.spine();
            figure.find_limbs();
        }
        figure
    }

    /// What sort of body this is.
    pub fn build(&self) -> Build {
        let obstacle = || (0..self.character.joints.len()).any(|joint| self.character.is_obstacle(joint));
        match (self.anatomy.limbs.is_empty(), self.legs) {
            (true, _) if obstacle() => Build::Rail,
            (true, _) => Build::Limbless,
            (false, Some(_)) => Build::Upright,
            (false, None) => Build::Animal,
        }
    }

    /// Unit direction of the trunk, from the hip on.
    pub fn trunk(&self) -> DVec3 {
        let whole = self.spine[self.spine.len() - 1] - self.spine[0];
        if whole.length() > 0.05 * self.extent { whole.normalize() } else { DVec3::Y }
    }

    /// Unit direction from the right to the left limb of a pair (or the other way round), square to the trunk.
    pub fn lateral(&self, [a, b]: [usize; 2]) -> DVec3 {
        let across = self.anatomy.limbs[a].path[0] - self.anatomy.limbs[b].path[0];
        let trunk = self.trunk();
        (across - trunk * across.dot(trunk)).try_normalize().unwrap_or_else(|| trunk.any_orthonormal_vector())
    }

    /// Forward, from the feet of two legs; then the legs end at the ankles, so that fractions of them measure height.
    fn find_feet(&mut self, legs: [usize; 2]) {
        let trunk = self.trunk();
        let side = trunk.cross(self.lateral(legs));
        let mut toes = 0.0;
        for leg in legs {
            let path = &mut self.anatomy.limbs[leg].path;
            let bone = |k: usize| (path[k] - path[k - 1]).normalize_or_zero();
            let level = |k: &usize| bone(*k).dot((path[k - 1] - path[0]).normalize_or_zero()) < 0.8;
            let ankle = (2..path.len()).find(level).unwrap_or(path.len()) - 1;
            toes += (path[path.len() - 1] - path[ankle]).dot(side);
            path.truncate(ankle + 1);
        }
        self.forward = if toes < 0.0 { -side } else { side };
    }

    /// Where there is room for cloth between two legs, searched downwards from the trunk's lowest skin, metres.
    /// `middle`: the plane between them.
    pub fn crotch(&self, legs: [usize; 2], middle: &Plane, down: DVec3) -> DVec3 {
        let [a, b] = legs.map(|leg| self.share(leg));
        let skin = || self.character.body.mesh.positions.iter().zip(a.iter().zip(&b).map(|(a, b)| a + b));
        let near = |p: &DVec3, room: f64| middle.past(*p).abs() < room * self.extent;
        let trunk = skin().filter(|(p, share)| *share < 0.5 && near(p, 0.03)).map(|(p, _)| p.dot(down));
        let hip = self.limb(legs[0]).path[0].dot(down);
        let mut depth = trunk.fold(hip, f64::max);
        // Thighs that touch: what lies between them is solid to the simulator, cloth there could not move.
        let step = 0.01 * self.extent;
        let blocked = |depth: f64| {
            skin().any(|(p, share)| share >= 0.5 && near(p, ROOM) && (0.0..2.0 * step).contains(&(p.dot(down) - depth)))
        };
        let knee = hip + 0.45 * arc_length(&self.limb(legs[0]).path);
        while depth < knee && blocked(depth) {
            depth += step;
        }
        middle.point + down * (depth + step - middle.point.dot(down))
    }

    /// Share of a limb's joints in the weights of every body vertex [b].
    pub fn share(&self, limb: usize) -> Vec<f64> {
        membership(self.character, &below(self.character, self.anatomy.limbs[limb].chain[0]))
    }

    /// Limb of an index.
    pub fn limb(&self, limb: usize) -> &Limb {
        &self.anatomy.limbs[limb]
    }

    fn spine(&self) -> Vec<DVec3> {
        let positions = joint_positions(self.character);
        let hip = self.anatomy.trunk[0];
        let ends = self.anatomy.limbs.iter().filter(|limb| limb.mirror.is_some());
        let away = |limb: &&Limb| positions[limb.parent].distance(positions[hip]);
        let end = ends.max_by(|a, b| away(a).total_cmp(&away(b)));
        let mut joint = end.map_or(hip, |limb| limb.parent);
        // Arms may hang from a clavicle each: the trunk ends between them.
        let other = end.and_then(|limb| limb.mirror).map_or(joint, |mirror| self.anatomy.limbs[mirror].parent);
        let mut spine = vec![(positions[joint] + positions[other]) / 2.0];
        while let (true, Some(parent)) = (joint != hip, self.character.joints[joint].parent) {
            joint = parent;
            spine.push(positions[joint]);
        }
        if spine.len() < 2 {
            spine.push(positions[hip]);
        }
        spine.reverse();
        spine
    }

    fn find_limbs(&mut self) {
        let (trunk, hip, length) = (self.trunk(), self.spine[0], arc_length(&self.spine).max(0.1 * self.extent));
        let limbs = &self.anatomy.limbs;
        let along = |limb: &Limb| limb.path[limb.path.len() - 1] - limb.path[0];
        let height = |limb: &Limb| (limb.path[0] - hip).dot(trunk);
        let pairs = || limbs.iter().enumerate().filter_map(|(a, limb)| Some((a, limb.mirror.filter(|b| *b > a)?)));
        let is_leg = |&(a, _): &(usize, usize)| {
            height(&limbs[a]) < 0.3 * length && along(&limbs[a]).normalize_or_zero().dot(trunk) < -0.5
        };
        let legs = pairs().find(is_leg);
        let arms = pairs().filter(|pair| !is_leg(pair));
        let arms = arms.max_by(|p, q| height(&limbs[p.0]).total_cmp(&height(&limbs[q.0])));
        let reach = |limb: &usize| (limbs[*limb].path[limbs[*limb].path.len() - 1] - hip).dot(trunk);
        let single = || (0..limbs.len()).filter(|&limb| limbs[limb].mirror.is_none());
        let neck = single().filter(|limb| reach(limb) > 0.0).max_by(|a, b| reach(a).total_cmp(&reach(b)));
        let tail = single().filter(|limb| reach(limb) < 0.0).min_by(|a, b| reach(a).total_cmp(&reach(b)));
        let pair = |(a, b)| [a, b];
        (self.legs, self.arms, self.neck, self.tail) = (legs.map(pair), arms.map(pair), neck, tail);
        if let Some(legs) = self.legs {
            self.find_feet(legs);
        }
    }
}
