//! Which joint of a skeleton is which part of a body: told by the file or by whoever runs us, else by the names of the
//! common families, else by topology and places: limbs are mirrored pairs, legs stand on the floor. simulation.md §5.

mod limbs;
#[cfg(test)]
mod tests;
mod tree;
mod words;

use super::bones::plain;
use crate::{Error, Result};
use ctsn_rig::Character;
use glam::DVec3;
use std::collections::BTreeMap;
use std::fmt;
use tree::Tree;

/// What a body with two arms and two legs cannot do without.
const TWO_LEGS: [&str; 13] = [
    "Hips",
    "LeftUpLeg",
    "LeftLeg",
    "LeftFoot",
    "RightUpLeg",
    "RightLeg",
    "RightFoot",
    "LeftArm",
    "LeftForeArm",
    "LeftHand",
    "RightArm",
    "RightForeArm",
    "RightHand",
];
/// What one with four legs cannot do without.
const FOUR_LEGS: [&str; 14] = [
    "Hips",
    "Head",
    "LeftBackUpLeg",
    "LeftBackLeg",
    "LeftBackFoot",
    "RightBackUpLeg",
    "RightBackLeg",
    "RightBackFoot",
    "LeftFrontUpLeg",
    "LeftFrontLeg",
    "LeftFrontFoot",
    "RightFrontUpLeg",
    "RightFrontLeg",
    "RightFrontFoot",
];
/// Parts that may be missing.
const MORE: [&str; 8] = [
    "LeftShoulder",
    "RightShoulder",
    "LeftToeBase",
    "RightToeBase",
    "LeftBackToes",
    "RightBackToes",
    "LeftFrontToes",
    "RightFrontToes",
];

/// How a joint was found to be a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum How {
    /// The file says so, or whoever runs us.
    Told,
    /// By its name.
    Name,
    /// By its place in the skeleton.
    Place,
}

/// The joints of a body by their parts; parts have the names of Mixamo's skeleton.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    parts: BTreeMap<String, (usize, How)>,
    /// Names of the parts' joints.
    names: BTreeMap<String, String>,
    wanted: Vec<&'static str>,
}

impl Reading {
    /// Reads a body with two arms and two legs, as far as one is there.
    pub fn two_legs(character: &Character) -> Reading {
        let tree = Tree::new(character);
        let mut reading = Reading { wanted: TWO_LEGS.to_vec(), ..Reading::default() };
        // Animals may have a human's names. What stands on four is none.
        if tree.standing().len() < 2 {
            reading.take_told(character);
            limbs::two_legs(character, &tree, &mut reading);
        }
        reading.name(character)
    }

    /// Reads a body with four legs, as far as one is there.
    pub fn four_legs(character: &Character) -> Reading {
        let mut reading = Reading { wanted: FOUR_LEGS.to_vec(), ..Reading::default() };
        reading.take_told(character);
        limbs::four_legs(character, &Tree::new(character), &mut reading);
        reading.name(character)
    }

    /// The kind of body that a skeleton is nearest to, and what of it was found.
    pub fn nearest(character: &Character) -> (&'static str, Reading) {
        let [two, four] = [Reading::two_legs(character), Reading::four_legs(character)];
        let share = |reading: &Reading| 1.0 - reading.missing().len() as f64 / reading.wanted.len() as f64;
        if share(&four) > share(&two) { ("four legs", four) } else { ("two arms and two legs", two) }
    }

    /// The joint that is a part.
    pub fn find(&self, part: &str) -> Option<usize> {
        self.parts.get(part).map(|(joint, _)| *joint)
    }

    /// The same, where nothing goes without it.
    pub fn need(&self, part: &str) -> Result<usize> {
        let none = || Error::Character(format!("wanted a joint for {part} to move, found none by name or by place"));
        self.find(part).ok_or_else(none)
    }

    /// Wanted parts that no joint is.
    pub fn missing(&self) -> Vec<&'static str> {
        self.wanted.iter().filter(|part| !self.parts.contains_key(**part)).copied().collect()
    }

    /// The joint that carries both arms, or both forelegs.
    pub fn chest(&self, character: &Character) -> Option<usize> {
        let both = |stem: &str| self.find(&format!("Left{stem}")).zip(self.find(&format!("Right{stem}")));
        let (left, right) = both("Arm").or_else(|| both("FrontUpLeg"))?;
        Tree::new(character).fork(left, right)
    }

    /// From above the hips to the chest.
    pub fn spine(&self, character: &Character) -> Vec<usize> {
        let ends = self.find("Hips").zip(self.chest(character));
        ends.map_or(Vec::new(), |(hips, chest)| Tree::new(character).path(hips, chest))
    }

    /// From above the chest to the head.
    pub fn neck_and_head(&self, character: &Character) -> Vec<usize> {
        let ends = self.chest(character).zip(self.find("Head"));
        ends.map_or(Vec::new(), |(chest, head)| Tree::new(character).path(chest, head))
    }

    /// The same without the head.
    pub fn neck(&self, character: &Character) -> Vec<usize> {
        let mut neck = self.neck_and_head(character);
        neck.pop();
        neck
    }

    /// The longest chain below the hips that is neither leg nor spine.
    pub fn tail(&self, character: &Character) -> Vec<usize> {
        let (tree, Some(hips)) = (Tree::new(character), self.find("Hips")) else { return Vec::new() };
        let other = |joint: usize| self.parts.values().any(|(part, _)| tree.is_above(joint, *part));
        let tips = tree.children(hips).iter().filter(|&&joint| !other(joint)).map(|&joint| tree.farthest(joint));
        let longest = tips.max_by(|a, b| tree.length(hips, *a).total_cmp(&tree.length(hips, *b)));
        longest.map_or(Vec::new(), |tip| tree.path(hips, tip))
    }

    /// Where the body faces: level, of length one; `None` without two legs side by side.
    pub fn forward(&self, character: &Character) -> Option<DVec3> {
        let pair = |stem: &str| Some([self.find(&format!("Left{stem}"))?, self.find(&format!("Right{stem}"))?]);
        let [left, right] = pair("UpLeg").or(pair("BackUpLeg"))?;
        let place = |joint: usize| character.joints[joint].inverse_bind.inverse().translation;
        (place(left) - place(right)).with_y(0.0).cross(DVec3::Y).try_normalize()
    }

    fn take(&mut self, part: &str, joint: usize, how: How) {
        self.parts.entry(part.to_string()).or_insert((joint, how));
    }

    fn take_told(&mut self, character: &Character) {
        let known = |part: &str| self.wanted.contains(&part) || MORE.contains(&part) || part == "Head";
        let told: Vec<(&String, &usize)> = character.parts.iter().filter(|(part, _)| known(part)).collect();
        told.into_iter().for_each(|(part, &joint)| self.take(part, joint, How::Told));
    }

    fn name(mut self, character: &Character) -> Reading {
        let name = |(part, (joint, _)): (&String, &(usize, How))| (part.clone(), character.joints[*joint].name.clone());
        self.names = self.parts.iter().map(name).collect();
        self
    }
}

impl fmt::Display for Reading {
    /// What was taken for what: parts whose joints have their names are only counted.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let ways = [(How::Told, "told"), (How::Name, "by name"), (How::Place, "by place in the skeleton")];
        let mut lines = Vec::new();
        for (how, words) in ways {
            let parts: Vec<&String> =
                self.parts.iter().filter(|(_, found)| found.1 == how).map(|(part, _)| part).collect();
            let other = parts.iter().filter(|part| plain(&self.names[**part]) != part.as_str());
            let other: Vec<String> = other.map(|part| format!("{part} = {}", self.names[*part])).collect();
            if !parts.is_empty() {
                let colon = if other.is_empty() { "" } else { ": " };
                lines.push(format!("{} joints {words}{colon}{}", parts.len(), other.join(", ")));
            }
        }
        write!(f, "{}", lines.join("; "))
    }
}

/// Names that `--joints` may give.
pub fn parts() -> Vec<&'static str> {
    let mut parts = [&TWO_LEGS[..], &FOUR_LEGS[1..], &MORE[..]].concat();
    parts.sort_unstable();
    parts
}
