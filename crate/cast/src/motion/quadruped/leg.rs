//! Two-bone inverse kinematics of a leg that stands on its toes: hip, stifle, hock, paw; or shoulder, elbow, wrist,
//! paw. The bend lies in the plane of the canonical leg, so a paw in its canonical place gives the canonical leg.

use crate::motion::bones::{Bones, Turns};
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::PI;

/// Shares of the stretched length of a leg: below the first, folding is eased, towards the second; above the third,
/// stretching is eased, towards the fourth. A leg that snaps straight moves its knee too fast.
const REACH: [f64; 4] = [0.42, 0.25, 0.935, 0.995];

/// A leg's joints and its canonical geometry.
pub struct Leg {
    /// 1 on the left (+X), -1 on the right.
    side: f64,
    /// The joint that carries it: hips or shoulder blade.
    pub root: usize,
    upper: usize,
    lower: usize,
    foot: usize,
    toes: Option<usize>,
    /// Normal of the plane of the two bones, towards +X.
    normal: DVec3,
    /// 1 where the middle joint points forward, -1 backward.
    bend: f64,
    /// Canonical places of the upper joint, the middle joint, the ankle and the paw on the floor, metres.
    places: [DVec3; 4],
}

impl Leg {
    /// The leg of those joints over a floor at height `floor`, metres; `None` if a bone has no length.
    pub fn measure(
        bones: &Bones,
        [root, upper, lower, foot]: [usize; 4],
        toes: Option<usize>,
        floor: f64,
    ) -> Option<Leg> {
        let [hip, knee, ankle] = [upper, lower, foot].map(|joint| bones.place(joint));
        let paw = toes.map_or((ankle + DVec3::Z * 0.05).with_y(floor), |toes| bones.place(toes));
        let towards = ankle - hip;
        let normal = (knee - hip).cross(towards);
        // A straight leg bends in the sagittal plane.
        let normal = normal.try_normalize().unwrap_or(DVec3::X.reject_from(towards).normalize_or(DVec3::X));
        let normal = if normal.x < 0.0 { -normal } else { normal };
        let bend = if (knee - hip).dot(normal.cross(towards)) < 0.0 { -1.0 } else { 1.0 };
        let usable = |length: f64| length > 1e-6 && length.is_finite();
        let side = if hip.x < 0.0 { -1.0 } else { 1.0 };
        let whole = usable(hip.distance(knee)) && usable(knee.distance(ankle)) && usable(towards.length());
        whole.then_some(Leg { side, root, upper, lower, foot, toes, normal, bend, places: [hip, knee, ankle, paw] })
    }

    /// Canonical place of its upper joint, metres.
    pub fn hip(&self) -> DVec3 {
        self.places[0]
    }

    /// How far the leg points forward of its canonical direction with its paw at `paw`, seen from `hip`, radians.
    pub fn swing(&self, hip: DVec3, paw: DVec3) -> f64 {
        let forward = |v: DVec3| v.z.atan2(-v.y);
        forward(paw - hip) - forward(self.places[3] - self.places[0])
    }

    /// Place of the paw for the channels outward, up, forward; all in metres, in axes that turn with the heading.
    pub fn target(&self, [outward, up, forward]: [f64; 3]) -> DVec3 {
        self.places[3] + DVec3::new(self.side * outward, up, forward)
    }

    /// Turns the leg's joints so that the paw stands at `paw` with the heel raised by `heel` radians. Its upper joint
    /// is at `hip`. Places are metres in axes that turn with the heading. Once the paw is lifted by about `clear`
    /// metres, the toes follow the foot.
    pub fn place(&self, heading: DQuat, hip: DVec3, paw: DVec3, heel: f64, clear: f64, turns: &mut Turns) {
        let [hip0, knee0, ankle0, paw0] = self.places;
        let foot = DQuat::from_rotation_x(heel);
        let ankle = paw + foot * (ankle0 - paw0);
        let [upper, lower] = [hip0.distance(knee0), knee0.distance(ankle0)];
        let reach = upper + lower;
        let towards = (ankle - hip).normalize_or(DVec3::NEG_Y);
        let share = eased(hip.distance(ankle) / reach).max((upper - lower).abs() / reach + 0.02);
        let distance = share * reach;
        let towards0 = (ankle0 - hip0).normalize_or(DVec3::NEG_Y);
        // A folded hind leg turns its stifle outward, past the belly.
        let folded = (towards0.dot(ankle0 - hip0) / reach - share).max(0.0);
        let outward = if self.bend > 0.0 { 0.9 * folded * folded.min(1.0) } else { 0.0 };
        let normal = DQuat::from_axis_angle(towards, -self.side * outward)
            * (DQuat::from_rotation_arc(towards0, towards) * self.normal);
        let pole = normal.cross(towards) * self.bend;
        let angle =
            ((upper * upper + distance * distance - lower * lower) / (2.0 * upper * distance)).clamp(-1.0, 1.0).acos();
        let thigh = towards * angle.cos() + pole * angle.sin();
        let shank = (towards * distance - thigh * upper) / lower;
        let turn = |from: DVec3, to: DVec3| {
            let axes = |bone: DVec3, normal: DVec3| DMat3::from_cols(bone, normal, bone.cross(normal));
            let from = axes(from.normalize_or(DVec3::NEG_Y), self.normal);
            heading * DQuat::from_mat3(&(axes(to.normalize_or(DVec3::NEG_Y), normal) * from.transpose())).normalize()
        };
        turns.world[self.upper] = Some(turn(knee0 - hip0, thigh));
        turns.world[self.lower] = Some(turn(ankle0 - knee0, shank));
        turns.world[self.foot] = Some(heading * foot);
        if let Some(toes) = self.toes {
            let lifted = (paw.y - paw0.y).max(0.0) / clear;
            let follow = lifted * lifted / (1.0 + lifted * lifted);
            turns.world[toes] = Some(heading * DQuat::from_rotation_x(0.8 * heel * follow));
        }
    }
}

/// The identity, with eased ends as in [`REACH`]; C² everywhere.
fn eased(share: f64) -> f64 {
    let [fold, least, stretch, most] = REACH;
    if share < fold {
        fold - (fold - least) * ((fold - share) / (fold - least)).tanh()
    } else if share > stretch {
        stretch + (most - stretch) * ((share - stretch) / (most - stretch)).tanh()
    } else {
        share
    }
}

/// An angle eased towards ± `most`, radians.
pub fn limited(angle: f64, most: f64) -> f64 {
    let most = most.min(PI);
    most * (angle / most).tanh()
}
