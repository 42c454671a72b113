//! Limbs that have come out through the cloth, an arm beside its sleeve. No vertex tells: all of them may lie outside
//! of the body, on the wrong side of a limb. Lines from joint to joint do, where they pass through cloth inside of the
//! body: from the hip outwards they leave it, through itself, no more often than when it was worn.

use glam::DVec3;

use super::crossing::pierced;
use ctsn_rig::{Character, Mesh};

/// Points of a line that must lie inside the body, its ends among them.
const POINTS: usize = 5;

/// Lines from joint to joint inside the body: those to helpers, tips, and a root on the floor are none.
#[derive(Clone)]
pub(super) struct Bones {
    /// Ends, parents before children.
    lines: Vec<[usize; 2]>,
    /// Those of the garment.
    triangles: Vec<[u32; 3]>,
    /// How often the garment is entered on the way to each joint when it is worn.
    worn: Vec<i32>,
}

impl Bones {
    /// The lines of `character` inside its body, and how they pass through `garment`, canonical; `encloses`: whether
    /// a point is in the body there.
    pub fn new(character: &Character, garment: &Mesh, encloses: impl Fn(DVec3) -> bool) -> Self {
        let joints: Vec<DVec3> = character.canonical_pose().iter().map(|joint| joint.translation).collect();
        let inside = |[from, to]: &[usize; 2]| {
            let (from, to) = (joints[*from], joints[*to]);
            (0..POINTS).all(|point| encloses(from.lerp(to, point as f64 / (POINTS - 1) as f64)))
        };
        let lines = character.joints.iter().enumerate().filter_map(|(joint, it)| Some([it.parent?, joint]));
        let lines = lines.filter(inside).collect();
        let mut bones = Self { lines, triangles: garment.triangles.clone(), worn: Vec::new() };
        bones.worn = bones.entered(&joints, &garment.positions, encloses);
        bones
    }

    /// A joint whose limb has come out through the garment, if one has: posed `joints`, the garment's vertices at `x`
    /// [n], and `encloses` the body of that pose.
    pub fn out(&self, joints: &[DVec3], x: &[DVec3], encloses: impl Fn(DVec3) -> bool) -> Option<usize> {
        let entered = self.entered(joints, x, encloses);
        (0..entered.len()).find(|joint| entered[*joint] < self.worn[*joint])
    }

    /// How much more often the garment is entered than left, inside the body, on the way to each joint. What passes
    /// through it outside, as a joint near the skin does in wide poses, is no limb.
    fn entered(&self, joints: &[DVec3], x: &[DVec3], encloses: impl Fn(DVec3) -> bool) -> Vec<i32> {
        let mut entered = vec![0; joints.len()];
        for &[from, to] in &self.lines {
            let ends = [joints[from], joints[to]];
            let meetings = self.triangles.iter().filter_map(|t| pierced(ends, t.map(|i| x[i as usize])));
            let passes = meetings.filter(|at| encloses(ends[0].lerp(ends[1], at.along)));
            entered[to] = entered[from] + passes.map(|at| if at.leaves { -1 } else { 1 }).sum::<i32>();
        }
        entered
    }
}
