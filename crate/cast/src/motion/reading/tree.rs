//! A skeleton as a tree in space, and the mirrored pairs of limbs in it.

use ctsn_rig::Character;
use ctsn_rig::mesh::bounds;
use glam::DVec3;

/// A limb that stands ends within this share of the height over the floor, and begins this much higher than it ends.
const STANDS: [f64; 2] = [0.16, 0.2];
/// The middle between the ends of a pair may be off its base, to the side, and one end higher, by these shares of the
/// height.
const EVEN: [f64; 2] = [0.04, 0.08];
/// Ends of a pair are this far apart, share of the height.
const APART: f64 = 0.02;

/// The joints that move the body, or have joints below them that do.
pub(super) struct Tree {
    pub parents: Vec<Option<usize>>,
    children: Vec<Vec<usize>>,
    pub place: Vec<DVec3>,
    /// Sum of the weights by which vertices follow each joint and all below it.
    mass: Vec<f64>,
    pub floor: f64,
    pub height: f64,
}

/// Two limbs that hang from one joint, each by its first joint, and their ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub base: usize,
    pub limbs: [usize; 2],
    pub tips: [usize; 2],
}

impl Tree {
    pub fn new(character: &Character) -> Tree {
        let count = character.joints.len();
        let parents: Vec<Option<usize>> = character.joints.iter().map(|joint| joint.parent).collect();
        let place: Vec<DVec3> = character.canonical_pose().iter().map(|joint| joint.translation).collect();
        let mut mass = vec![0.0; count];
        character.body.weights.iter().flatten().for_each(|&(joint, weight)| mass[joint] += weight);
        // A skeleton without a mesh is read as if every joint moved something.
        if mass.iter().all(|mass| *mass == 0.0) {
            mass.fill(1.0);
        }
        (0..count).filter(|joint| character.is_obstacle(*joint)).for_each(|joint| mass[joint] = 0.0);
        let mut children = vec![Vec::new(); count];
        for joint in (0..count).rev() {
            if let Some(parent) = parents[joint].filter(|_| mass[joint] > 0.0) {
                mass[parent] += mass[joint];
                children[parent].insert(0, joint);
            }
        }
        let all = character.body.mesh.positions.iter().chain(&place).copied();
        let [low, high] = bounds(all);
        Tree { parents, children, place, mass, floor: low.y, height: high.y - low.y }
    }

    /// The joint and what is above it, nearest first.
    pub fn upwards(&self, joint: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(joint), |&joint| self.parents[joint])
    }

    pub fn is_above(&self, above: usize, joint: usize) -> bool {
        self.upwards(joint).any(|each| each == above)
    }

    /// Joints from below `above` down to `joint`, which is the last; empty where `above` is not above it.
    pub fn path(&self, above: usize, joint: usize) -> Vec<usize> {
        if !self.is_above(above, joint) {
            return Vec::new();
        }
        let mut path: Vec<usize> = self.upwards(joint).take_while(|&each| each != above).collect();
        path.reverse();
        path
    }

    /// The lowest joint that is above both.
    pub fn fork(&self, one: usize, other: usize) -> Option<usize> {
        self.upwards(one).find(|&each| self.is_above(each, other))
    }

    pub fn children(&self, joint: usize) -> &[usize] {
        &self.children[joint]
    }

    /// The joint and all below it.
    fn below(&self, joint: usize) -> Vec<usize> {
        let mut found = vec![joint];
        let mut at = 0;
        while at < found.len() {
            found.extend(&self.children[found[at]]);
            at += 1;
        }
        found
    }

    /// Length of the bones from a joint to one below it.
    pub fn length(&self, above: usize, joint: usize) -> f64 {
        let bones = self.upwards(joint).take_while(|&each| each != above);
        bones.filter_map(|each| Some(self.place[each].distance(self.place[self.parents[each]?]))).sum()
    }

    /// The joint below that is farthest along the bones.
    pub fn farthest(&self, joint: usize) -> usize {
        let farther = |a: &usize, b: &usize| self.length(joint, *a).total_cmp(&self.length(joint, *b));
        self.below(joint).into_iter().max_by(farther).unwrap_or(joint)
    }

    fn lowest(&self, joint: usize) -> usize {
        let lower = |a: &usize, b: &usize| self.place[*a].y.total_cmp(&self.place[*b].y);
        self.below(joint).into_iter().min_by(lower).unwrap_or(joint)
    }

    /// The highest joint below.
    pub fn highest(&self, joint: usize) -> usize {
        let higher = |a: &usize, b: &usize| self.place[*a].y.total_cmp(&self.place[*b].y);
        self.below(joint).into_iter().max_by(higher).unwrap_or(joint)
    }

    fn stands(&self, limb: usize) -> bool {
        let low = self.place[self.lowest(limb)].y;
        low - self.floor < STANDS[0] * self.height && self.place[limb].y - low > STANDS[1] * self.height
    }

    /// Pairs that stand on the floor, at most one for each base: the one that moves most of the body.
    pub fn standing(&self) -> Vec<Pair> {
        self.pairs(|limb| self.stands(limb).then(|| self.lowest(limb)), |limb| self.mass[limb])
    }

    /// Pairs that do not, the longest of each base.
    pub fn free(&self) -> Vec<Pair> {
        let tip = |limb: usize| Some(self.farthest(limb)).filter(|_| !self.stands(limb));
        self.pairs(tip, |limb| self.length(limb, self.farthest(limb)))
    }

    fn pairs(&self, tip: impl Fn(usize) -> Option<usize>, size: impl Fn(usize) -> f64) -> Vec<Pair> {
        let mut found = Vec::new();
        for base in 0..self.parents.len() {
            let limbs: Vec<(usize, usize)> =
                self.children[base].iter().filter_map(|&limb| Some((limb, tip(limb)?))).collect();
            let both = limbs.iter().enumerate().flat_map(|(at, one)| limbs[at + 1..].iter().map(move |two| (one, two)));
            let pairs = both.map(|(one, two)| Pair { base, limbs: [one.0, two.0], tips: [one.1, two.1] });
            let larger = |a: &Pair, b: &Pair| {
                let size = |pair: &Pair| size(pair.limbs[0]).min(size(pair.limbs[1]));
                size(a).total_cmp(&size(b))
            };
            found.extend(pairs.filter(|pair| self.is_mirrored(pair)).max_by(larger));
        }
        found
    }

    fn is_mirrored(&self, pair: &Pair) -> bool {
        let [one, two] = pair.tips.map(|tip| self.place[tip]);
        let apart = (one - two).with_y(0.0);
        let Some(across) = apart.try_normalize().filter(|_| apart.length() > APART * self.height) else { return false };
        let off = (0.5 * (one + two) - self.place[pair.base]).dot(across).abs();
        let roots = self.place[pair.limbs[0]] - self.place[pair.limbs[1]];
        off < EVEN[0] * self.height + 0.1 * apart.length()
            && (one.y - two.y).abs() < EVEN[1] * self.height
            && roots.dot(across) >= 0.0
    }
}
