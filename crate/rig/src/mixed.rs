//! Poses between the clips and around them: limbs of some frames on the trunk of another, joints turned further.
//! Cloth on an arm hears little of the legs, but what all clips do together, a network takes for a law: poses that part
//! what the clips join teach it better than more frames of the same clips. What no clip does, such as a shrug, is
//! learned from the turns.

use crate::{Character, Pose, limbs};
use glam::{DAffine3, DQuat, DVec3};

/// Chance that a limb moves as in another frame than what it hangs from.
const ELSEWHERE: f64 = 0.5;
/// A joint whose axes differ by less than this in all frames is held still: a helper, or a finger.
const STILL: f64 = 0.02;

/// Makes poses of frames.
pub struct Mixer {
    frames: Vec<Pose>,
    /// Greatest turn of a joint beyond its frame, radians.
    further: f64,
    parents: Vec<Option<usize>>,
    /// Whether a joint has siblings, whether it begins a limb, and whether it is turned further.
    siblings: Vec<bool>,
    limbs: Vec<bool>,
    turned: Vec<bool>,
}

impl Mixer {
    /// For sound frames of `character`, whose joints are turned by up to `further` radians more; `None` without frames,
    /// or where there are no limbs to mix.
    pub fn new(character: &Character, frames: Vec<Pose>, further: f64) -> Option<Self> {
        let limbs = limbs_of(character);
        let first = frames.first().filter(|_| limbs.contains(&true))?;
        let parents: Vec<_> = character.joints.iter().map(|joint| joint.parent).collect();
        let count = |parent| parents.iter().filter(|other| **other == Some(parent)).count();
        let siblings = parents.iter().map(|parent| parent.is_some_and(|parent| count(parent) > 1)).collect();
        let moves = |joint: usize, parent: usize| {
            let axes = |frame: &Pose| (frame[parent].inverse() * frame[joint]).matrix3;
            frames.iter().any(|frame| !axes(frame).abs_diff_eq(axes(first), STILL))
        };
        let turned = |(joint, parent): (usize, &Option<usize>)| {
            further > 0.0 && !character.is_obstacle(joint) && parent.is_some_and(|parent| moves(joint, parent))
        };
        let turned = parents.iter().enumerate().map(turned).collect();
        Some(Self { siblings, limbs, turned, parents, frames, further })
    }

    /// Mixed pose number `number`: every limb is drawn anew or moves with what it hangs from, and whatever moves in the
    /// frames is turned further about any axis. The same number gives the same pose.
    pub fn pose(&self, number: usize) -> Pose {
        let [mut rng, mut turns] = [number as u64, !number as u64].map(fastrand::Rng::with_seed);
        let trunk = &self.frames[rng.usize(..self.frames.len())];
        let mut pose = Pose::with_capacity(self.parents.len());
        let mut source = Vec::with_capacity(self.parents.len());
        for (joint, parent) in self.parents.iter().enumerate() {
            // Drawn for whatever has siblings, so that helper joints do not change what the others do.
            let draw = self.siblings[joint] && rng.f64() < ELSEWHERE;
            let drawn = draw.then(|| &self.frames[rng.usize(..self.frames.len())]).filter(|_| self.limbs[joint]);
            let from = drawn.or(parent.map(|parent| source[parent])).unwrap_or(trunk);
            // Exactly the frame's own transform as long as nothing above it was taken from elsewhere.
            let moved = parent.filter(|parent| pose[*parent] != from[*parent]);
            let placed = moved.map_or(from[joint], |parent| pose[parent] * from[parent].inverse() * from[joint]);
            let angle = self.further * turns.f64();
            let further = turn(&mut turns, angle);
            pose.push(if self.turned[joint] { placed * further } else { placed });
            source.push(from);
        }
        pose
    }
}

/// A turn by `angle`, radians, about an axis that is drawn.
pub fn turn(rng: &mut fastrand::Rng, angle: f64) -> DAffine3 {
    // Uniform on the sphere: height and longitude.
    let (height, longitude) = (2.0 * rng.f64() - 1.0, std::f64::consts::TAU * rng.f64());
    let across = (1.0 - height * height).sqrt();
    let axis = DVec3::new(across * longitude.cos(), height, across * longitude.sin());
    DAffine3::from_quat(DQuat::from_axis_angle(axis, angle))
}

/// Whether there is anything to mix.
pub fn has_limbs(character: &Character) -> bool {
    limbs_of(character).contains(&true)
}

/// An obstacle is no limb: it stays where its trunk's frame has it, or the figure would stand inside its chair.
fn limbs_of(character: &Character) -> Vec<bool> {
    let parents: Vec<_> = character.joints.iter().map(|joint| joint.parent).collect();
    limbs(&parents, |joint| !character.is_obstacle(joint))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Joint, SkinnedMesh, Surface};
    use glam::{DAffine3, DQuat, DVec3};

    /// Hips with two legs of two joints, a helper beside one of the knees and an obstacle of two joints, and three
    /// frames of them.
    fn scene() -> (Character, Vec<Pose>) {
        let parents = [None, Some(0), Some(1), Some(0), Some(3), Some(1), Some(0), Some(6)];
        let name = |joint: usize| if joint == 6 { "Obstacle".to_owned() } else { format!("joint{joint}") };
        let joint = |(i, parent)| Joint { name: name(i), parent, inverse_bind: DAffine3::IDENTITY };
        let character = Character {
            joints: parents.into_iter().enumerate().map(joint).collect(),
            root: 0,
            body: SkinnedMesh::default(),
            surface: Surface::default(),
            clips: Vec::new(),
            metres_per_unit: 1.0,
            parts: Default::default(),
        };
        let frame = |turn: f64| {
            let bend = DAffine3::from_rotation_translation(DQuat::from_rotation_x(turn), DVec3::Y);
            let mut pose = Pose::new();
            parents.iter().for_each(|parent| pose.push(parent.map_or(bend, |parent| pose[parent] * bend)));
            pose
        };
        (character, vec![frame(0.1), frame(0.5), frame(-0.7)])
    }

    /// A joint against its parent.
    fn local(character: &Character, pose: &Pose, joint: usize) -> DAffine3 {
        character.joints[joint].parent.map_or(pose[joint], |parent| pose[parent].inverse() * pose[joint])
    }

    /// The frame whose bend a joint has.
    fn bend(character: &Character, frames: &[Pose], pose: &Pose, joint: usize) -> usize {
        let of = |pose| local(character, pose, joint);
        frames.iter().position(|frame| of(frame).abs_diff_eq(of(pose), 1e-12)).expect("the bend of a frame")
    }

    #[test]
    fn limbs_of_other_frames_keep_their_bends_and_stay_whole() {
        let (mut character, frames) = scene();
        let mixer = Mixer::new(&character, frames.clone(), 0.0).expect("limbs");
        let mut seen = std::collections::BTreeSet::new();
        for number in 0..1000 {
            let pose = mixer.pose(number);
            let bends: Vec<usize> = (0..8).map(|joint| bend(&character, &frames, &pose, joint)).collect();
            assert_eq!([bends[1], bends[3], bends[1]], [bends[2], bends[4], bends[5]], "a limb is of one frame");
            assert_eq!([bends[0]; 2], [bends[6], bends[7]], "an obstacle is no limb");
            seen.insert((bends[0], bends[1], bends[3]));
            assert_eq!(pose, mixer.pose(number));
        }
        assert_eq!(seen.len(), 27, "every mixture of three frames");
        assert!(has_limbs(&character));
        assert!(Mixer::new(&character, Vec::new(), 0.0).is_none(), "no frames");
        character.joints[3].parent = Some(2);
        assert!(!has_limbs(&character), "a chain, a helper and an obstacle");
        assert!(Mixer::new(&character, frames, 0.0).is_none(), "no limbs");
    }

    #[test]
    fn what_moves_is_turned_further_about_its_own_place() {
        let (character, mut frames) = scene();
        // A helper that never bends.
        frames.iter_mut().for_each(|frame| frame[5] = frame[1] * DAffine3::from_translation(DVec3::Y));
        let further = 0.5;
        let mixer = Mixer::new(&character, frames.clone(), further).expect("limbs");
        assert_eq!(mixer.turned, [false, true, true, true, true, false, false, true]);
        let mut greatest: f64 = 0.0;
        for pose in (0..1000).map(|number| mixer.pose(number)) {
            for joint in [1, 2, 3, 4] {
                let found = local(&character, &pose, joint);
                let angle = |frame: &Pose| {
                    let turn = local(&character, frame, joint).matrix3.transpose() * found.matrix3;
                    DQuat::from_mat3(&turn).to_axis_angle().1
                };
                let least = frames.iter().map(angle).fold(f64::INFINITY, f64::min);
                assert!(least <= further + 1e-9, "joint {joint} is {least} from all frames");
                assert!(found.translation.abs_diff_eq(DVec3::Y, 1e-12), "joint {joint} moved to {}", found.translation);
                greatest = greatest.max(least);
            }
            assert!(local(&character, &pose, 5).abs_diff_eq(DAffine3::from_translation(DVec3::Y), 1e-12), "a helper");
            assert_eq!(bend(&character, &frames, &pose, 6), bend(&character, &frames, &pose, 0), "an obstacle");
        }
        assert!(greatest > 0.6 * further, "turned by {greatest} at most");
    }
}
