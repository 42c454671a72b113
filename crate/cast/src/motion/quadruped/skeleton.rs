//! Stance -> joint transforms: turns along spine, neck and tail, inverse kinematics for the four legs.
//! Works on any skeleton with the joints named below, +Y up, facing +Z, left at +X, whatever its joint axes.

use super::leg::{Leg, limited};
use super::stance::Stance;
use crate::motion::bones::{Bones, Turns, euler, plain};
use crate::motion::reading::Reading;
use crate::{Error, Result};
use ctsn_rig::{Character, Pose};
use glam::{DQuat, DVec3};

/// Parts of a leg without the side: upper, middle, ankle and toe joints. Toes may be missing.
const HIND: [&str; 4] = ["BackUpLeg", "BackLeg", "BackFoot", "BackToes"];
const FORE: [&str; 4] = ["FrontUpLeg", "FrontLeg", "FrontFoot", "FrontToes"];

/// Share of the chest's turn that the neck keeps; share of the way from chest to neck that its lower joints turn.
const STEADY: [f64; 2] = [0.4, 0.7];
/// Share of the hips' turn that the tail keeps: it balances, and must not reach below the floor.
const TAIL: f64 = 0.3;
/// Share of the foreleg's swing that the shoulder blade takes, and the most it turns, radians.
const BLADE: [f64; 2] = [0.4, 0.5];

/// An animal's joints by their part in the body, and the rest geometry motions need.
pub struct Quadruped {
    bones: Bones,
    hips: usize,
    spine: Vec<usize>,
    neck: Vec<usize>,
    head: usize,
    tail: Vec<usize>,
    ears: Vec<usize>,
    /// Shoulder blades of the forelegs, where there are any.
    blades: [Option<usize>; 2],
    /// Left hind, right hind, left fore, right fore.
    legs: Vec<Leg>,
    /// Hip joint to floor, metres.
    leg_length: f64,
}

impl Quadruped {
    /// Finds the joints by name or by place, see [`Reading`].
    pub fn new(character: &Character) -> Result<Quadruped> {
        let reading = Reading::four_legs(character);
        let named = |wanted: &str| character.joints.iter().position(|joint| plain(&joint.name) == wanted);
        let starting = |stem: &str| -> Vec<usize> {
            (0..character.joints.len()).filter(|&j| plain(&character.joints[j].name).starts_with(stem)).collect()
        };
        let or = |named: Vec<usize>, placed: Vec<usize>| if named.is_empty() { placed } else { named };
        let bones = Bones::new(character);
        let (hips, head) = (reading.need("Hips")?, reading.need("Head")?);
        let low = character.body.mesh.positions.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        let floor = if low.is_finite() { low } else { 0.0 };
        let leg = |side: &str, names: &[&str; 4]| -> Result<Leg> {
            let part = |index: usize| format!("{side}{}", names[index]);
            let need = |index: usize| reading.need(&part(index));
            let [upper, lower, foot] = [need(0)?, need(1)?, need(2)?];
            let root = bones.parents[upper].unwrap_or(hips);
            let leg = Leg::measure(&bones, [root, upper, lower, foot], reading.find(&part(3)), floor);
            leg.ok_or_else(|| Error::Character(format!("wanted a leg with bones longer than zero at {}", part(0))))
        };
        let legs = vec![leg("Left", &HIND)?, leg("Right", &HIND)?, leg("Left", &FORE)?, leg("Right", &FORE)?];
        let leg_length = legs[0].hip().y - floor;
        if !(leg_length > 1e-6 && leg_length.is_finite()) {
            return Err(Error::Character(format!("wanted hips above the floor, found them {leg_length} m over it")));
        }
        let chest = reading.chest(character);
        let blade = |leg: &Leg| Some(leg.root).filter(|&root| chest.is_some_and(|chest| root != chest));
        let blades = [blade(&legs[2]), blade(&legs[3])];
        let ears = [named("LeftEar"), named("RightEar")].into_iter().flatten().collect();
        Ok(Quadruped {
            hips,
            spine: or(starting("Spine"), reading.spine(character)),
            neck: or(starting("Neck"), reading.neck(character)),
            head,
            tail: or(starting("Tail"), reading.tail(character)),
            ears,
            blades,
            legs,
            leg_length,
            bones,
        })
    }

    /// Joint world transforms `G_j` of a stance, metres.
    pub fn pose(&self, stance: &Stance) -> Pose {
        let heading = DQuat::from_rotation_y(stance.heading.to_radians());
        let mut turns = self.bones.turns();
        let trunk = heading * euler(stance.trunk);
        let [arched, left, twist] = stance.spine;
        let half = euler([-0.5 * arched, 0.5 * left, 0.5 * twist]);
        turns.world[self.hips] = Some(trunk * half.inverse());
        let count = self.spine.len().max(1) as f64;
        for &joint in &self.spine {
            turns.local[joint] = euler([-arched / count, left / count, twist / count]);
        }
        let chest = self.spine.iter().fold(trunk * half.inverse(), |above, &joint| above * turns.local[joint]);
        let neck = chest.slerp(heading, 1.0 - STEADY[0]) * euler(stance.neck);
        for (i, &joint) in self.neck.iter().enumerate() {
            let last = i + 1 == self.neck.len();
            turns.world[joint] = Some(if last { neck } else { chest.slerp(neck, STEADY[1]) });
        }
        turns.world[self.head] = Some(heading * euler(stance.head));
        for &ear in &self.ears {
            turns.local[ear] = DQuat::from_rotation_x(-stance.ears.to_radians());
        }
        self.turn_tail(stance, heading, trunk * half.inverse(), &mut turns);
        let rest = self.bones.place(self.hips);
        let moved = DVec3::from_array(stance.hips) * self.leg_length;
        let hips = (heading * (rest.with_y(0.0) + moved.with_y(0.0))).with_y(rest.y + moved.y);
        self.place_legs(stance, heading, hips, &mut turns);
        self.bones.assemble(self.hips, hips, &turns)
    }

    fn turn_tail(&self, stance: &Stance, heading: DQuat, hips: DQuat, turns: &mut Turns) {
        let [up, left, curl_up, curl_left] = stance.tail;
        let count = self.tail.len().saturating_sub(1).max(1) as f64;
        for (i, &joint) in self.tail.iter().enumerate() {
            // The tail points backwards: its tip rises as the joint pitches down and goes left as it yaws right.
            if i == 0 {
                turns.world[joint] = Some(heading.slerp(hips, TAIL) * euler([-up, -left, 0.0]));
            } else {
                turns.local[joint] = euler([-curl_up / count, -curl_left / count, 0.0]);
            }
        }
    }

    /// Shoulder blades, then legs, once the trunk is placed.
    fn place_legs(&self, stance: &Stance, heading: DQuat, hips: DVec3, turns: &mut Turns) {
        let length = self.leg_length;
        let back = heading.inverse();
        let trunk = self.bones.assemble(self.hips, hips, turns);
        let hip = |pose: &Pose, leg: &Leg| {
            let turned = pose[leg.root] * self.bones.bind[leg.root].inverse();
            back * turned.transform_point3(leg.hip())
        };
        let paw = |leg: usize| {
            let [outward, up, forward, _] = stance.paws[leg];
            self.legs[leg].target([outward, soft_floor(up), forward].map(|share| share * length))
        };
        for (fore, blade) in self.blades.iter().enumerate() {
            let leg = &self.legs[2 + fore];
            if let Some(blade) = *blade {
                let swing = leg.swing(hip(&trunk, leg), paw(2 + fore));
                turns.local[blade] = DQuat::from_rotation_x(-limited(BLADE[0] * swing, BLADE[1]));
            }
        }
        let trunk = self.bones.assemble(self.hips, hips, turns);
        for (i, leg) in self.legs.iter().enumerate() {
            let heel = stance.paws[i][3].to_radians();
            leg.place(heading, hip(&trunk, leg), paw(i), heel, 0.1 * length, turns);
        }
    }
}

/// Splines overshoot below the floor where a paw lands. A soft maximum keeps the paw above -1 % of a leg.
/// One half as soft made a cat's paws leave the floor with a jolt.
fn soft_floor(height: f64) -> f64 {
    0.5 * (height + height.hypot(0.02)) - 0.01
}
