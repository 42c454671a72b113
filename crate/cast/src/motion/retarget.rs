//! Clips of one body on another of its kind: each part points where its counterpart points, whatever the two skeletons
//! are called, how long their bones are, and in which posture each was bound.

use super::bones::{Bones, plain};
use super::reading::Reading;
use crate::{Error, Result};
use ctsn_rig::{Character, Clip, Joint, Pose};
use glam::{DQuat, DVec3};
use std::collections::BTreeMap;

/// Parts of limbs, from the body outwards, as [`Reading`] has them on either side. The last of a limb has no bone: a
/// hand goes on as its forearm points, a foot is bound with its sole on the floor.
const LIMBS: [[&str; 3]; 4] = [
    ["UpLeg", "Leg", "Foot"],
    ["Arm", "ForeArm", "Hand"],
    ["BackUpLeg", "BackLeg", "BackFoot"],
    ["FrontUpLeg", "FrontLeg", "FrontFoot"],
];
/// Parts beside them that turn as their counterparts do.
const OTHERS: [&str; 5] = ["Shoulder", "ToeBase", "BackToes", "FrontToes", "Hips"];

/// A body: its joints by their parts, and where they are in the canonical pose.
struct Body<'a> {
    character: &'a Character,
    reading: Reading,
    bones: Bones,
    hips: usize,
    /// From the forward direction +Z to its own.
    heading: DQuat,
    /// Length of a hind leg, metres.
    leg: f64,
}

/// A joint that is moved, and the turns of the source that it follows.
struct Follower {
    joint: usize,
    /// Two joints of the source, and how far it is from the first to the second.
    between: ([usize; 2], f64),
    /// From where its bone points in the canonical pose to where the source's does.
    aligned: DQuat,
}

/// The clips of `source` for `target`, at their own rates.
///
/// # Errors
/// One of them is no body with two arms and two legs, or with four legs, or they are not of one kind.
pub fn retarget(source: &Character, target: &Character) -> Result<Vec<Clip>> {
    let ((ours, from), (theirs, onto)) = (Body::new(source)?, Body::new(target)?);
    if ours != theirs {
        return Err(Error::Character(format!("motion of a body with {ours} fits no body with {theirs}")));
    }
    let facing = onto.heading * from.heading.inverse();
    let followers = onto.followers(&from, facing);
    let scale = onto.leg / from.leg;
    let pose = |pose: &Pose| {
        let turn = |joint: usize| {
            let bind = from.bones.bind[joint].to_scale_rotation_translation().1;
            facing * pose[joint].to_scale_rotation_translation().1 * bind.inverse() * facing.inverse()
        };
        let mut turns = onto.bones.turns();
        for Follower { joint, between: ([first, second], share), aligned } in &followers {
            turns.world[*joint] = Some(turn(*first).slerp(turn(*second), *share) * *aligned);
        }
        let moved = facing * (pose[from.hips].translation - from.bones.place(from.hips));
        onto.bones.assemble(onto.hips, onto.bones.place(onto.hips) + scale * moved, &turns)
    };
    let clip = |clip: &Clip| Clip { poses: clip.poses.iter().map(pose).collect(), ..clip.clone() };
    Ok(source.clips.iter().map(clip).collect())
}

impl<'a> Body<'a> {
    /// The body, and its kind.
    fn new(character: &'a Character) -> Result<(&'static str, Self)> {
        let (kind, reading) = Reading::nearest(character);
        let complete = reading.forward(character).filter(|_| reading.missing().is_empty());
        let (Some(forward), bones) = (complete, Bones::new(character)) else {
            let missing = reading.missing().join(", ");
            return Err(Error::Character(format!(
                "a skeleton is nearest to a body with {kind}, without {missing}; a map of joints can tell them \
                 (--joints). Found: {reading}"
            )));
        };
        let hips = reading.need("Hips")?;
        let stem = if reading.find("LeftBackUpLeg").is_some() { LIMBS[2] } else { LIMBS[0] };
        let joints = stem.map(|part| reading.need(&format!("Left{part}")));
        let [upper, lower, foot] = joints.map(|joint| joint.map(|joint| bones.place(joint)));
        let (upper, lower, foot) = (upper?, lower?, foot?);
        let leg = upper.distance(lower) + lower.distance(foot);
        if !(leg > 1e-6 && leg.is_finite()) {
            return Err(Error::Character(format!("wanted a left leg longer than zero, found {leg} m")));
        }
        let heading = DQuat::from_rotation_y(forward.x.atan2(forward.z));
        Ok((kind, Self { character, reading, bones, hips, heading, leg }))
    }

    /// Where a part's bone points in the canonical pose.
    fn direction(&self, part: &str, next: &str) -> Option<DVec3> {
        let (joint, end) = self.reading.find(part).zip(self.reading.find(next))?;
        (self.bones.place(end) - self.bones.place(joint)).try_normalize()
    }

    /// The joints that have counterparts in `source`, which is to be turned by `facing`.
    fn followers(&self, source: &Body, facing: DQuat) -> Vec<Follower> {
        let alone = |part: &str, aligned: DQuat| {
            let (joint, other) = self.reading.find(part).zip(source.reading.find(part))?;
            Some(Follower { joint, between: ([other, other], 0.0), aligned })
        };
        let mut followers: Vec<Follower> = ["", "Left", "Right"]
            .iter()
            .flat_map(|side| OTHERS.map(|part| format!("{side}{part}")))
            .filter_map(|part| alone(&part, DQuat::IDENTITY))
            .collect();
        for side in ["Left", "Right"] {
            for limb in LIMBS.map(|limb| limb.map(|part| format!("{side}{part}"))) {
                let bone = |body: &Body, i: usize| body.direction(&limb[i], &limb[i + 1]);
                let aligned = |i: usize| {
                    let directions = bone(self, i).zip(bone(source, i));
                    directions.map_or(DQuat::IDENTITY, |(own, other)| DQuat::from_rotation_arc(own, facing * other))
                };
                let last = if limb[2].ends_with("Hand") { aligned(1) } else { DQuat::IDENTITY };
                let turns = [aligned(0), aligned(1), last];
                followers.extend(limb.iter().zip(turns).filter_map(|(part, aligned)| alone(part, aligned)));
            }
        }
        let chains = |body: &Body| {
            let Body { reading, character, hips, .. } = body;
            let chest = reading.chest(character).unwrap_or(*hips);
            [
                (*hips, reading.spine(character)),
                (chest, reading.neck_and_head(character)),
                (*hips, reading.tail(character)),
            ]
        };
        for ((_, own), (base, other)) in chains(self).into_iter().zip(chains(source)) {
            followers.extend(spread(&own, &[&[base], other.as_slice()].concat()));
        }
        self.follow_namesakes(source, &mut followers);
        followers
    }

    /// Joints that are no part, fingers or shoulder blades say, follow what has their name, aligned as what bears them.
    fn follow_namesakes(&self, source: &Body, followers: &mut Vec<Follower>) {
        let names: BTreeMap<&str, usize> =
            source.character.joints.iter().enumerate().map(|(number, joint)| (plain(&joint.name), number)).collect();
        let mut aligned = vec![None; self.bones.bind.len()];
        followers.iter().for_each(|follower| aligned[follower.joint] = Some(follower.aligned));
        for (joint, Joint { name, parent, .. }) in self.character.joints.iter().enumerate() {
            let Some(above) = parent.and_then(|parent| aligned[parent]).filter(|_| aligned[joint].is_none()) else {
                continue;
            };
            if let Some(other) = names.get(plain(name)) {
                followers.push(Follower { joint, between: ([*other; 2], 0.0), aligned: above });
                aligned[joint] = Some(above);
            }
        }
    }
}

/// Joints of a chain follow those of another: as far along it, from the joint that bears it.
fn spread(own: &[usize], other: &[usize]) -> Vec<Follower> {
    let last = other.len() - 1;
    let follow = |(i, joint): (usize, &usize)| {
        let at = last as f64 * (i + 1) as f64 / own.len() as f64;
        let first = (at.floor() as usize).min(last);
        let between = ([other[first], other[(first + 1).min(last)]], at - first as f64);
        Follower { joint: *joint, between, aligned: DQuat::IDENTITY }
    };
    if last == 0 { Vec::new() } else { own.iter().enumerate().map(follow).collect() }
}

#[cfg(test)]
mod tests;
