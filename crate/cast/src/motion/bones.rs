//! Turns of joints -> joint transforms, for any skeleton. All kinds of motion share this.

use ctsn_rig::{Character, Pose};
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// A skeleton's parents and canonical transforms.
pub struct Bones {
    /// Parent of each joint.
    pub parents: Vec<Option<usize>>,
    /// Canonical joint transforms `B_j`, metres.
    pub bind: Vec<DAffine3>,
}

/// Turns of joints against the canonical pose.
pub struct Turns {
    /// Against the parent's turn, in canonical axes.
    pub local: Vec<DQuat>,
    /// Against the canonical pose in world axes, where given; it replaces `local`.
    pub world: Vec<Option<DQuat>>,
}

impl Bones {
    /// The bones of a character.
    pub fn new(character: &Character) -> Bones {
        Bones { parents: character.joints.iter().map(|joint| joint.parent).collect(), bind: character.canonical_pose() }
    }

    /// No turn of any joint.
    pub fn turns(&self) -> Turns {
        Turns { local: vec![DQuat::IDENTITY; self.bind.len()], world: vec![None; self.bind.len()] }
    }

    /// Place of a joint in the canonical pose, metres.
    pub fn place(&self, joint: usize) -> DVec3 {
        self.bind[joint].translation
    }

    /// Chains the turns down the skeleton: D_j = world turn or D_parent · local_j; G_j = T(p_j) · D_j · B_j's axes.
    /// The joint `root` stands at `place`, metres.
    pub fn assemble(&self, root: usize, place: DVec3, turns: &Turns) -> Pose {
        let mut turned = vec![DQuat::IDENTITY; self.bind.len()];
        let mut pose: Pose = Vec::with_capacity(self.bind.len());
        for (joint, bind) in self.bind.iter().enumerate() {
            let parent = self.parents[joint];
            let above = parent.map_or(DQuat::IDENTITY, |parent| turned[parent]);
            turned[joint] = turns.world[joint].unwrap_or(above * turns.local[joint]);
            let place = match parent {
                _ if joint == root => place,
                Some(parent) => pose[parent].translation + above * (bind.translation - self.place(parent)),
                None => bind.translation,
            };
            pose.push(DAffine3 { matrix3: DMat3::from_quat(turned[joint]) * bind.matrix3, translation: place });
        }
        pose
    }
}

/// A joint's name without what exporters put around it: `rig:b_Spine01_02` -> `Spine01`.
pub fn plain(name: &str) -> &str {
    let name = name.rsplit([':', '|']).next().unwrap_or(name);
    let name = name.strip_prefix("b_").unwrap_or(name);
    match name.rsplit_once('_') {
        Some((stem, digits)) if !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()) => stem,
        _ => name,
    }
}

/// The rotation by pitch (up), yaw (to the left) and roll (left side down), degrees.
pub fn euler([up, left, roll]: [f64; 3]) -> DQuat {
    let [up, left, roll] = [up, left, roll].map(f64::to_radians);
    DQuat::from_rotation_y(left) * DQuat::from_rotation_x(-up) * DQuat::from_rotation_z(-roll)
}
