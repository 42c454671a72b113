//! Trunk and limbs of any skeleton, from its topology and from how much skin each joint carries; joint names only help.
//! Trunk = from the hip through every joint that bears a mirrored pair of limbs (legs, arms, fins). simulation.md §4.2.

use ctsn_rig::Character;
use ctsn_rig::mesh::triangle;
use glam::DVec3;

/// A branch that leaves the trunk.
#[derive(Clone, Debug)]
pub(crate) struct Limb {
    /// Joints from the trunk outwards, along the longest branch.
    pub chain: Vec<usize>,
    /// Positions of the chain's joints, then of the tip: the farthest skin of the last joint. Metres.
    pub path: Vec<DVec3>,
    /// The trunk joint it hangs from.
    pub parent: usize,
    /// Index of its mirror image among the limbs.
    pub mirror: Option<usize>,
}

/// Trunk joints and limbs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Anatomy {
    /// Trunk joints, from the hip outwards.
    pub trunk: Vec<usize>,
    /// Branches off the trunk.
    pub limbs: Vec<Limb>,
}

/// Least share of the body's skin on a pair of limbs, and least length of a limb in body sizes; smaller ones (eyes,
/// ears, whiskers) are part of what they sit on.
const LEAST_SKIN: f64 = 0.03;
const LEAST_LENGTH: f64 = 0.1;

/// The skeleton with what skin says about it.
struct Skeleton<'a> {
    character: &'a Character,
    positions: Vec<DVec3>,
    children: Vec<Vec<usize>>,
    /// Skin area carried by each joint and everything below it, as a share of the body.
    skin: Vec<f64>,
    /// Length of the longest path below each joint with its skin, metres.
    length: Vec<f64>,
    /// Extent of the body, metres.
    extent: f64,
}

/// Splits a character of the given extent (metres) into trunk and limbs. No mirrored limbs: everything stays empty.
pub(crate) fn anatomy(character: &Character, extent: f64) -> Anatomy {
    let skeleton = Skeleton::new(character, extent);
    let mut hip = character.root;
    while let ([child], true) = (&skeleton.children[hip][..], skeleton.own_skin(hip) <= 1e-9) {
        hip = *child;
    }
    let mut anatomy = Anatomy::default();
    if skeleton.bears_limbs(hip) {
        skeleton.grow(hip, &mut anatomy);
    }
    anatomy
}

/// Per joint: is it `top` or below it?
pub(crate) fn below(character: &Character, top: usize) -> Vec<bool> {
    let mut below = vec![false; character.joints.len()];
    for (index, joint) in character.joints.iter().enumerate() {
        below[index] = index == top || joint.parent.is_some_and(|parent| below[parent]);
    }
    below
}

/// Weight of the given joints at every body vertex [b].
pub(crate) fn membership(character: &Character, joints: &[bool]) -> Vec<f64> {
    let sum = |weights: &Vec<(usize, f64)>| weights.iter().filter(|(joint, _)| joints[*joint]).map(|(_, w)| w).sum();
    character.body.weights.iter().map(sum).collect()
}

/// Positions of the joints in the canonical pose, metres.
pub(crate) fn joint_positions(character: &Character) -> Vec<DVec3> {
    character.canonical_pose().iter().map(|joint| joint.translation).collect()
}

impl<'a> Skeleton<'a> {
    fn new(character: &'a Character, extent: f64) -> Skeleton<'a> {
        let count = character.joints.len();
        let positions = joint_positions(character);
        let mut skin = vec![0.0; count];
        for triangle in &character.body.mesh.triangles {
            let corners = triangle.map(|i| character.body.mesh.positions[i as usize]);
            let third = triangle::cross(corners).length() / 6.0;
            for &vertex in triangle {
                character.body.weights[vertex as usize]
                    .iter()
                    .for_each(|(joint, weight)| skin[*joint] += third * weight);
            }
        }
        let total: f64 = skin.iter().sum::<f64>().max(1e-18);
        let mut children = vec![Vec::new(); count];
        let mut length = vec![0.0_f64; count];
        for joint in (0..count).rev() {
            if length[joint] == 0.0 {
                length[joint] = positions[joint].distance(tip(character, joint, positions[joint]));
            }
            skin[joint] /= total;
            if let Some(parent) = character.joints[joint].parent {
                children[parent].insert(0, joint);
                length[parent] = length[parent].max(length[joint] + positions[joint].distance(positions[parent]));
            }
        }
        for joint in (0..count).rev() {
            if let Some(parent) = character.joints[joint].parent {
                skin[parent] += skin[joint];
            }
        }
        children.iter_mut().for_each(|list| list.retain(|&child| skin[child] > 1e-3));
        Skeleton { character, positions, children, skin, length, extent }
    }

    /// Skin share of the joint alone.
    fn own_skin(&self, joint: usize) -> f64 {
        self.skin[joint] - self.children[joint].iter().map(|&child| self.skin[child]).sum::<f64>()
    }

    /// Does the joint's name hold one of the words?
    fn named(&self, joint: usize, words: &[&str]) -> bool {
        let name = self.character.joints[joint].name.to_lowercase();
        words.iter().any(|word| name.contains(word))
    }

    /// Mirrored children: same distance from the joint, same length, similar skin.
    fn pairs(&self, joint: usize) -> Vec<(usize, usize)> {
        let children = &self.children[joint];
        let alike = |a: f64, b: f64, least: f64| a.min(b) >= least * a.max(b);
        let central = |child: usize| self.named(child, &["spine", "neck", "head", "tail", "chest", "pelvis"]);
        let away = |child: usize| self.positions[child].distance(self.positions[joint]) + 0.05 * self.extent;
        let mirrored = |a: usize, b: usize| {
            alike(self.skin[a], self.skin[b], 0.6)
                && alike(self.length[a], self.length[b], 0.8)
                && alike(away(a), away(b), 0.8)
                && self.skin[a] + self.skin[b] >= LEAST_SKIN
                && self.length[a] >= LEAST_LENGTH * self.extent
                && !central(a)
                && !central(b)
        };
        // The most alike first, so that a tail as long as the legs is not taken for one.
        let difference = |&(a, b): &(usize, usize)| (self.length[a] - self.length[b]).abs() + (away(a) - away(b)).abs();
        let both =
            |(index, &a): (usize, &usize)| children[index + 1..].iter().map(move |&b| (a, b)).collect::<Vec<_>>();
        let mut alike: Vec<(usize, usize)> = children.iter().enumerate().flat_map(both).collect();
        alike.retain(|&(a, b)| mirrored(a, b));
        alike.sort_by(|p, q| difference(p).total_cmp(&difference(q)));
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        for (a, b) in alike {
            if !pairs.iter().any(|&(p, q)| [p, q].contains(&a) || [p, q].contains(&b)) {
                pairs.push((a, b));
            }
        }
        pairs
    }

    /// Does a mirrored pair hang from this joint or further along its unpaired branches? Heads never do.
    fn bears_limbs(&self, joint: usize) -> bool {
        !self.named(joint, &["head", "skull", "jaw"])
            && (!self.pairs(joint).is_empty() || self.children[joint].iter().any(|&child| self.bears_limbs(child)))
    }

    /// Adds the trunk joint and everything that hangs from it.
    fn grow(&self, joint: usize, anatomy: &mut Anatomy) {
        anatomy.trunk.push(joint);
        let pairs = self.pairs(joint);
        let mut rest = self.children[joint].clone();
        for (a, b) in pairs {
            rest.retain(|&child| child != a && child != b);
            let index = anatomy.limbs.len();
            anatomy.limbs.push(self.limb(a, joint, Some(index + 1)));
            anatomy.limbs.push(self.limb(b, joint, Some(index)));
        }
        for child in rest {
            if self.bears_limbs(child) {
                self.grow(child, anatomy);
            } else if self.skin[child] >= 0.5 * LEAST_SKIN && self.length[child] >= 0.5 * LEAST_LENGTH * self.extent {
                anatomy.limbs.push(self.limb(child, joint, None));
            } else {
                anatomy.trunk.push(child);
            }
        }
    }

    /// The limb that starts at `top`; a short first bone of a paired limb (a clavicle) counts as trunk.
    fn limb(&self, top: usize, parent: usize, mirror: Option<usize>) -> Limb {
        let mut limb = limb_path(self.character, &self.children, &self.length, top, parent);
        limb.mirror = mirror;
        let first = limb.path[0].distance(limb.path[1]);
        if mirror.is_some() && limb.chain.len() > 2 && first < 0.2 * self.length[top] {
            limb.parent = limb.chain.remove(0);
            limb.path.remove(0);
        }
        limb
    }
}

/// The longest path from `top` to the skin of its last joint.
fn limb_path(character: &Character, children: &[Vec<usize>], length: &[f64], top: usize, parent: usize) -> Limb {
    let positions = joint_positions(character);
    let mut chain = vec![top];
    let mut last = top;
    let reach = |joint: usize, from: usize| length[joint] + positions[joint].distance(positions[from]);
    while let Some(&next) = children[last].iter().max_by(|&&a, &&b| reach(a, last).total_cmp(&reach(b, last))) {
        chain.push(next);
        last = next;
    }
    let mut path: Vec<DVec3> = chain.iter().map(|&joint| positions[joint]).collect();
    path.push(tip(character, last, positions[last]));
    Limb { chain, path, parent, mirror: None }
}

/// The skin farthest from a joint among what it holds by more than half; the joint itself if it holds none.
fn tip(character: &Character, joint: usize, position: DVec3) -> DVec3 {
    let held = |weights: &Vec<(usize, f64)>| weights.iter().any(|&(j, weight)| j == joint && weight > 0.5);
    let skin = character.body.mesh.positions.iter().zip(&character.body.weights).filter(|(_, weights)| held(weights));
    let far = skin.max_by(|a, b| a.0.distance_squared(position).total_cmp(&b.0.distance_squared(position)));
    far.map_or(position, |(point, _)| *point)
}
