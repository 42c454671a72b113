//! Poses between the clips: limbs of some frames on the trunk of another. Cloth on an arm hears little of the legs, but
//! what all clips do together, a network takes for a law: poses that part what the clips join teach it better than more
//! frames of the same clips.

use crate::{Character, Pose, limbs};

/// Chance that a limb moves as in another frame than what it hangs from.
const ELSEWHERE: f64 = 0.5;

/// Whether there is anything to mix.
pub fn has_limbs(character: &Character) -> bool {
    limbs_of(character).contains(&true)
}

/// An obstacle is no limb: it stays where its trunk's frame has it, or the figure would stand inside its chair.
fn limbs_of(character: &Character) -> Vec<bool> {
    let parents: Vec<_> = character.joints.iter().map(|joint| joint.parent).collect();
    limbs(&parents, |joint| !character.is_obstacle(joint))
}

/// Mixed pose number `number` out of `frames`, which must not be empty: every limb is drawn anew or moves with what it
/// hangs from; the same number gives the same pose.
pub fn mixed(character: &Character, frames: &[&Pose], number: usize) -> Pose {
    let mut rng = fastrand::Rng::with_seed(number as u64);
    let joints = &character.joints;
    let siblings = |of: usize| joints.iter().filter(|joint| joint.parent == Some(of)).count();
    let limbs = limbs_of(character);
    let trunk = frames[rng.usize(..frames.len())];
    let mut pose = Pose::with_capacity(joints.len());
    let mut source = Vec::with_capacity(joints.len());
    for (joint, parent) in joints.iter().map(|joint| joint.parent).enumerate() {
        // Drawn for whatever has siblings, so that helper joints do not change what the others do.
        let draw = parent.is_some_and(|parent| siblings(parent) > 1) && rng.f64() < ELSEWHERE;
        let drawn = draw.then(|| frames[rng.usize(..frames.len())]).filter(|_| limbs[joint]);
        let from: &Pose = drawn.or(parent.map(|parent| source[parent])).unwrap_or(trunk);
        // Exactly the frame's own transform as long as nothing above it was taken from elsewhere.
        let moved = parent.filter(|parent| pose[*parent] != from[*parent]);
        pose.push(moved.map_or(from[joint], |parent| pose[parent] * from[parent].inverse() * from[joint]));
        source.push(from);
    }
    pose
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

    /// The frame whose bend a joint has.
    fn bend(character: &Character, frames: &[Pose], pose: &Pose, joint: usize) -> usize {
        let local = |pose: &Pose| match character.joints[joint].parent {
            Some(parent) => pose[parent].inverse() * pose[joint],
            None => pose[joint],
        };
        let same = |frame: &Pose| local(frame).abs_diff_eq(local(pose), 1e-12);
        frames.iter().position(same).expect("the bend of a frame")
    }

    #[test]
    fn limbs_of_other_frames_keep_their_bends_and_stay_whole() {
        let (mut character, frames) = scene();
        let all: Vec<&Pose> = frames.iter().collect();
        let mut seen = std::collections::BTreeSet::new();
        for number in 0..1000 {
            let pose = mixed(&character, &all, number);
            let bends: Vec<usize> = (0..8).map(|joint| bend(&character, &frames, &pose, joint)).collect();
            assert_eq!([bends[1], bends[3], bends[1]], [bends[2], bends[4], bends[5]], "a limb is of one frame");
            assert_eq!([bends[0]; 2], [bends[6], bends[7]], "an obstacle is no limb");
            seen.insert((bends[0], bends[1], bends[3]));
            assert_eq!(pose, mixed(&character, &all, number));
        }
        assert_eq!(seen.len(), 27, "every mixture of three frames");
        assert!(has_limbs(&character));
        character.joints[3].parent = Some(2);
        assert!(!has_limbs(&character), "a chain, a helper and an obstacle");
    }
}
