//! Stroke and phase -> joint transforms: θ_j = A w_j sin(φ - k_j) along the tail, bends shared along the spine.
//! w_j and k_j grow towards the flukes; the fore part pitches a little the opposite way. simulation.md §5.

use super::stroke::Stroke;
use crate::motion::bones::{Bones, euler, plain};
use crate::{Error, Result};
use ctsn_rig::{Character, Pose};
use glam::{DQuat, DVec3};

/// Pitch of a cruise's wave at the first joint of the tail and at the flukes, degrees.
const WAVE: [f64; 2] = [1.5, 17.0];
/// How far the flukes lag behind the first joint of the tail, radians.
const LAG: f64 = 2.4;
/// Answer to the tail's wave: pitch of each joint of the fore part and of the middle, degrees; heave, body lengths.
const ANSWER: [f64; 3] = [1.6, 1.2, 0.006];

/// A swimmer's joints by their part in the body.
pub struct Swimmer {
    bones: Bones,
    root: usize,
    /// From the middle to the head.
    fore: Vec<usize>,
    /// From the middle to the flukes.
    tail: Vec<usize>,
    fluke: usize,
    fins: [usize; 2],
    /// From the flukes' joint to the head's, metres.
    length: f64,
}

impl Swimmer {
    /// Finds the joints by name.
    pub fn new(character: &Character) -> Result<Swimmer> {
        let bones = Bones::new(character);
        let need = |wanted: &str| {
            let found = character.joints.iter().position(|joint| plain(&joint.name) == wanted);
            found.ok_or_else(|| Error::Character(format!("wanted a joint named {wanted}, found none")))
        };
        let (root, head, fluke) = (need("Hips")?, need("Head")?, need("Fluke")?);
        // The joints between the root and a tip, the tip included.
        let chain = |tip: usize| {
            let upwards = std::iter::successors(Some(tip), |&joint| bones.parents[joint]);
            let mut chain: Vec<usize> = upwards.take_while(|&joint| joint != root).collect();
            chain.reverse();
            chain
        };
        let (fore, mut tail) = (chain(head), chain(fluke));
        tail.pop();
        let fins = [need("LeftFin")?, need("RightFin")?];
        let length = bones.place(head).distance(bones.place(fluke));
        if tail.is_empty() || !(length > 1e-6 && length.is_finite()) {
            return Err(Error::Character(format!("wanted a tail between Hips and Fluke, found {} joints", tail.len())));
        }
        Ok(Swimmer { root, fore, tail, fluke, fins, length, bones })
    }

    /// Joint world transforms `G_j` of a stroke at `phase` of the wave (radians), metres.
    pub fn pose(&self, stroke: &Stroke, phase: f64) -> Pose {
        let mut turns = self.bones.turns();
        let beat = stroke.beat;
        let [answer, pitch, heave] = ANSWER;
        turns.local[self.root] = euler(stroke.turn) * euler([pitch * beat * (phase - 0.6).sin(), 0.0, 0.0]);
        let count = self.fore.len().max(1) as f64;
        for (i, &joint) in self.fore.iter().enumerate() {
            let wave = -answer * beat * (phase - 0.6 + 0.4 * i as f64).sin();
            turns.local[joint] = euler(stroke.fore.map(|angle| angle / count)) * euler([wave, 0.0, 0.0]);
        }
        let count = self.tail.len() as f64;
        let wave = |share: f64| {
            let [first, last] = WAVE;
            (first + (last - first) * share * share) * beat * (phase - LAG * share).sin()
        };
        let [up, left, twist] = stroke.tail;
        for (i, &joint) in self.tail.iter().enumerate() {
            // The tail bends more towards the flukes. It points backwards, so it rises as its joints pitch down.
            let share = (i as f64 + 1.0) / (count + 1.0);
            let weight = 2.0 * share / count;
            turns.local[joint] = euler([-up * weight - wave(share), -left * weight, twist * weight]);
        }
        turns.local[self.fluke] = euler([-stroke.fluke - wave(1.0), 0.0, 0.0]);
        for (fin, (side, [raised, back, edge])) in self.fins.into_iter().zip([1.0, -1.0].into_iter().zip(stroke.fins)) {
            let [raised, back, edge] = [raised, back, edge].map(f64::to_radians);
            turns.local[fin] = DQuat::from_rotation_y(side * back)
                * DQuat::from_rotation_z(side * raised)
                * DQuat::from_rotation_x(-edge);
        }
        let heave = heave * self.length * beat * (phase + 1.0).sin();
        let place = self.bones.place(self.root) + DVec3::from_array(stroke.place) + DVec3::Y * heave;
        self.bones.assemble(self.root, place, &turns)
    }
}
