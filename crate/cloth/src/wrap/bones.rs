//! The bones of a body: from each joint to those below it, without what hair and clothes hang on.

use super::anatomy::joint_positions;
use ctsn_rig::Character;
use glam::DVec3;

/// Words in the names of joints that are no bones of a body.
const APART: [&str; 13] =
    ["hair", "skirt", "ribbon", "cape", "coat", "sleeve", "bust", "breast", "eye", "pole", "target", "prop", "weapon"];

/// From a joint to one below it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bone {
    /// The joint that moves it.
    pub joint: usize,
    /// Canonical, metres.
    pub ends: [DVec3; 2],
}

/// The bones from the hip on, canonical. A joint that has nothing below it and moves no skin ends none.
pub(crate) fn bones(character: &Character) -> Vec<Bone> {
    let places = joint_positions(character);
    let mut counts = vec![false; places.len()];
    character.body.weights.iter().flatten().for_each(|(joint, _)| counts[*joint] = true);
    character.joints.iter().filter_map(|joint| joint.parent).for_each(|parent| counts[parent] = true);
    let mut of_body = vec![false; places.len()];
    let mut bones = Vec::new();
    for (index, joint) in character.joints.iter().enumerate() {
        let name = joint.name.to_lowercase();
        let parent = joint.parent.filter(|parent| of_body[*parent]);
        of_body[index] = index == character.root
            || parent.is_some() && !character.is_obstacle(index) && !APART.iter().any(|word| name.contains(word));
        if let Some(parent) = parent.filter(|_| of_body[index] && counts[index]) {
            bones.push(Bone { joint: parent, ends: [places[parent], places[index]] });
        }
    }
    bones
}

impl Bone {
    /// Points along it, at most `step` metres apart, both ends too.
    pub fn points(&self, step: f64) -> impl Iterator<Item = DVec3> + use<> {
        let [a, b] = self.ends;
        let count = (a.distance(b) / step).ceil().max(1.0);
        (0..=count as usize).map(move |k| a.lerp(b, k as f64 / count))
    }

    /// Distance of a point from it, metres.
    pub fn distance(&self, point: DVec3) -> f64 {
        let ([a, b], along) = (self.ends, self.ends[1] - self.ends[0]);
        let share = ((point - a).dot(along) / along.length_squared().max(1e-18)).clamp(0.0, 1.0);
        point.distance(a.lerp(b, share))
    }
}
