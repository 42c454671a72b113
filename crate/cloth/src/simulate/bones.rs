//! Limbs that have come out through the cloth, an arm beside its sleeve. No vertex tells: all of them may lie outside
//! of the body, on the wrong side of a limb. Lines from joint to joint do, which run deep inside of it: from the hip
//! outwards, what leaves the cloth through itself has entered it no more often than when it was worn.

use glam::DVec3;

use super::distance::BodyDistance;
use super::simulator::Simulator;
use ctsn_rig::mesh::triangle;
use ctsn_rig::path::to_body_frame;
use ctsn_rig::{Character, Mesh, Pose};

/// Points of a line that must lie inside the body, its ends among them.
const POINTS: usize = 5;

/// Lines from joint to joint inside the body: those to helpers, tips, and a root on the floor are none.
pub(super) struct Bones {
    /// Ends, parents before children.
    lines: Vec<[usize; 2]>,
    /// How often the garment is entered on the way to each joint when it is worn.
    worn: Vec<i32>,
}

impl Bones {
    /// The lines of `character` inside its `body`, and how they pass through `garment`, canonical.
    pub fn new(character: &Character, body: &BodyDistance, garment: &Mesh) -> Self {
        let pose = character.canonical_pose();
        let (joints, posed) = (places(&to_body_frame(character, &pose)), body.posed(&pose));
        let inside = |[from, to]: &[usize; 2]| {
            let (from, to) = (joints[*from], joints[*to]);
            (0..POINTS).all(|point| posed.encloses(from.lerp(to, point as f64 / (POINTS - 1) as f64)))
        };
        let lines = character.joints.iter().enumerate().filter_map(|(joint, it)| Some([it.parent?, joint]));
        let mut bones = Self { lines: lines.filter(inside).collect(), worn: Vec::new() };
        let canonical: Vec<DVec3> = character.canonical_pose().iter().map(|joint| joint.translation).collect();
        bones.worn = bones.entered(&canonical, &garment.triangles, &garment.positions);
        bones
    }

    /// A joint, posed like the cloth `x` [n], the line to which has come out through it; `joints` in the same space.
    fn out(&self, joints: &Pose, triangles: &[[u32; 3]], x: &[DVec3]) -> Option<usize> {
        let entered = self.entered(&places(joints), triangles, x);
        (0..entered.len()).find(|joint| entered[*joint] < self.worn[*joint])
    }

    /// How much more often the cloth is entered than left on the way to each joint.
    fn entered(&self, joints: &[DVec3], triangles: &[[u32; 3]], x: &[DVec3]) -> Vec<i32> {
        let mut entered = vec![0; joints.len()];
        for &[from, to] in &self.lines {
            let (start, along) = (joints[from], joints[to] - joints[from]);
            let met =
                triangles.iter().filter_map(|corners| triangle::meet(start, along, corners.map(|i| x[i as usize])));
            let met =
                met.filter(|at| at.u >= 0.0 && at.v >= 0.0 && at.u + at.v <= 1.0 && (0.0..=1.0).contains(&at.along));
            entered[to] = entered[from] + met.map(|at| if at.leaves { -1 } else { 1 }).sum::<i32>();
        }
        entered
    }
}

impl Simulator {
    /// Which limb has come out through cloth `placed` so in `pose` (world; body frame [n], metres), if one has.
    pub(super) fn out(&self, pose: &Pose, placed: &[DVec3]) -> Option<String> {
        let joints = to_body_frame(&self.character, pose);
        let limb = self.bones.out(&joints, &self.level.cloth.elements.triangles, placed)?;
        let name = &self.character.joints[limb].name;
        Some(format!("wanted every limb in the cloth, found that at {name:?} out through it"))
    }
}

fn places(joints: &Pose) -> Vec<DVec3> {
    joints.iter().map(|joint| joint.translation).collect()
}
