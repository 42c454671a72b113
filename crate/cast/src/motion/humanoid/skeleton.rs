//! Posture -> joint transforms: forward kinematics for trunk and arms, two-bone inverse kinematics for the legs.
//! Works on any skeleton with the usual humanoid names, +Y up, facing +Z, left at +X, whatever its joint axes.

use super::clear::Clearance;
use super::posture::Posture;
use crate::motion::reading::Reading;
use crate::{Error, Result};
use ctsn_rig::{Character, Pose};
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// Shares of the stretched length of a leg: beyond the first, reach is compressed; it never passes the second.
const REACH: [f64; 2] = [0.985, 0.9995];
/// The same for a folded leg: below the first, folding is eased; it never passes the second, a knee bent by 147°.
const FOLD: [f64; 2] = [0.36, 0.28];

/// A character's joints by their part in the body, and the rest geometry motions need.
pub struct Humanoid {
    parents: Vec<Option<usize>>,
    /// Canonical joint transforms `B_j`, metres.
    bind: Vec<DAffine3>,
    hips: usize,
    spine: Vec<usize>,
    head: Vec<usize>,
    arms: [Arm; 2],
    legs: [Leg; 2],
    /// Height of the floor in the canonical pose, metres.
    floor: f64,
    /// Hip joint to floor, metres.
    leg_length: f64,
    clearance: Clearance,
}

struct Arm {
    /// 1 on the left (+X), -1 on the right.
    side: f64,
    shoulder: Option<usize>,
    upper: usize,
    fore: usize,
    hand: usize,
    /// Canonical bone direction -> hanging down, for the upper arm and the forearm.
    hang: [DQuat; 2],
}

struct Leg {
    /// 1 on the left (+X), -1 on the right.
    side: f64,
    upper: usize,
    lower: usize,
    foot: usize,
    toe: Option<usize>,
    hang: [DQuat; 2],
    /// Lengths of thigh and shank, metres.
    lengths: [f64; 2],
    /// Canonical places, metres: ankle, heel on the floor, joint of the toes. The foot rolls over the last two.
    ankle: DVec3,
    heel: DVec3,
    ball: DVec3,
}

impl Humanoid {
    /// Finds the joints by name or by place, see [`Reading`].
    pub fn new(character: &Character) -> Result<Humanoid> {
        let reading = Reading::two_legs(character);
        let (need, find) = (|part: &str| reading.need(part), |part: &str| reading.find(part));
        let bind = character.canonical_pose();
        let place = |joint: usize| bind[joint].translation;
        let floor = character.body.mesh.positions.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        let floor = if floor.is_finite() { floor } else { 0.0 };
        let side_of = |side: &str| if side == "Left" { 1.0 } else { -1.0 };
        let arm = |side: &str| -> Result<Arm> {
            let [upper, fore, hand] =
                [need(&format!("{side}Arm"))?, need(&format!("{side}ForeArm"))?, need(&format!("{side}Hand"))?];
            let shoulder = find(&format!("{side}Shoulder"));
            let hang = [hang(&bind, upper, fore), hang(&bind, fore, hand)];
            Ok(Arm { side: side_of(side), shoulder, upper, fore, hand, hang })
        };
        let leg = |side: &str| -> Result<Leg> {
            let joints = [need(&format!("{side}UpLeg"))?, need(&format!("{side}Leg"))?, need(&format!("{side}Foot"))?];
            let leg = Leg::measure(side_of(side), joints, find(&format!("{side}ToeBase")), &bind, floor);
            let straight = leg.lengths.iter().all(|&length| length > 1e-6 && length.is_finite());
            let wanted = format!("wanted a {side} leg with two bones longer than zero, found {:?} m", leg.lengths);
            if straight { Ok(leg) } else { Err(Error::Character(wanted)) }
        };
        let legs = [leg("Left")?, leg("Right")?];
        let arms = [arm("Left")?, arm("Right")?];
        let hips = need("Hips")?;
        let (spine, head) = (reading.spine(character), reading.neck_and_head(character));
        let leg_length = place(legs[0].upper).y - floor;
        let solid = [hips].into_iter().chain(legs.iter().flat_map(|leg| [leg.upper, leg.lower]));
        let solid: Vec<usize> = solid.chain(spine.iter().chain(&head).copied()).collect();
        let outer = [0, 1].map(|side: usize| [arms[side].fore, arms[side].hand]);
        let clearance = Clearance::measure(character, &solid, outer, floor, leg_length);
        let parents = character.joints.iter().map(|joint| joint.parent).collect();
        Ok(Humanoid { parents, bind, hips, spine, head, arms, legs, floor, leg_length, clearance })
    }

    /// Joint world transforms `G_j` of a posture, metres, with arms kept clear of the body.
    pub fn pose(&self, posture: &Posture) -> Pose {
        self.place(&self.clearance.clear(posture, |posture| self.place(posture)))
    }

    /// Joint world transforms of a posture as it is, metres.
    fn place(&self, posture: &Posture) -> Pose {
        let heading = DQuat::from_rotation_y(posture.heading.to_radians());
        // Turns relative to the parent, in canonical axes; the legs follow once the hips are placed.
        let mut turn = vec![DQuat::IDENTITY; self.bind.len()];
        let mut world = vec![None; self.bind.len()];
        world[self.hips] = Some(heading * euler(posture.tilt));
        spread(&self.spine, posture.spine, &mut turn);
        spread(&self.head, posture.head, &mut turn);
        let chest = self.spine.iter().fold(heading * euler(posture.tilt), |chest, &joint| chest * turn[joint]);
        for (side, arm) in self.arms.iter().enumerate() {
            arm.place(chest, posture.arms[side], &mut turn, &mut world);
        }
        let rest = self.bind[self.hips].translation;
        let moved = DVec3::from_array(posture.hips) * self.leg_length;
        let hips = (heading * (rest.with_y(0.0) + moved.with_y(0.0))).with_y(rest.y + moved.y);
        for (side, leg) in self.legs.iter().enumerate() {
            let hip = hips + world[self.hips].unwrap_or(heading) * (self.bind[leg.upper].translation - rest);
            let knee = 0.5 * posture.tilt[1].to_radians();
            let [x, y, z, yaw, pitch] = posture.feet[side];
            let length = self.leg_length;
            let foot = [x * length, soft_floor(y) * length, z * length, yaw, pitch];
            leg.place(hip, heading, knee, foot, &mut world);
        }
        self.assemble(hips, &turn, &world)
    }

    /// Chains the turns down the skeleton: D_j = world turn or D_parent · turn_j; G_j = T(p_j) · D_j · B_j's axes.
    fn assemble(&self, hips: DVec3, turn: &[DQuat], world: &[Option<DQuat>]) -> Pose {
        let mut turned = vec![DQuat::IDENTITY; self.bind.len()];
        let mut pose: Pose = Vec::with_capacity(self.bind.len());
        for (joint, bind) in self.bind.iter().enumerate() {
            let parent = self.parents[joint];
            let above = parent.map_or(DQuat::IDENTITY, |parent| turned[parent]);
            turned[joint] = world[joint].unwrap_or(above * turn[joint]);
            let place = match parent {
                _ if joint == self.hips => hips,
                Some(parent) => pose[parent].translation + above * (bind.translation - self.bind[parent].translation),
                None => bind.translation,
            };
            pose.push(DAffine3 { matrix3: DMat3::from_quat(turned[joint]) * bind.matrix3, translation: place });
        }
        pose
    }

    /// Height of the floor, metres.
    pub fn floor(&self) -> f64 {
        self.floor
    }
}

impl Arm {
    fn place(
        &self,
        chest: DQuat,
        [raise, swing, twist, elbow, wrist]: [f64; 5],
        turn: &mut [DQuat],
        world: &mut [Option<DQuat>],
    ) {
        let [raise, swing, twist, elbow, wrist] = [raise, swing, twist, elbow, wrist].map(f64::to_radians);
        let side = self.side;
        // The collar bone takes part once the arm rises, up to 24° with the arm overhead.
        let lift = (raise.cos() * swing.cos()).clamp(-1.0, 1.0);
        let share = ((0.9 - lift) / 1.9).max(0.0);
        if let Some(shoulder) = self.shoulder {
            turn[shoulder] = DQuat::from_rotation_z(side * share * share * (3.0 - 2.0 * share) * 0.42);
        }
        let upper = chest
            * DQuat::from_rotation_x(-swing)
            * DQuat::from_rotation_z(side * raise)
            * DQuat::from_rotation_y(side * twist);
        let fore = upper * DQuat::from_rotation_x(-elbow);
        world[self.upper] = Some(upper * self.hang[0]);
        world[self.fore] = Some(fore * self.hang[1]);
        world[self.hand] = Some(fore * DQuat::from_rotation_z(-side * wrist) * self.hang[1]);
    }
}

impl Leg {
    /// A leg of thigh, shank and foot joint in the canonical pose.
    fn measure(side: f64, [upper, lower, foot]: [usize; 3], toe: Option<usize>, bind: &[DAffine3], floor: f64) -> Leg {
        let place = |joint: usize| bind[joint].translation;
        let ankle = place(foot);
        let ball = toe.map_or((ankle + DVec3::Z * 0.12).with_y(floor), place);
        let heel = (ankle - DVec3::Z * 0.25 * (ball.z - ankle.z)).with_y(floor);
        let lengths = [place(upper).distance(place(lower)), place(lower).distance(ankle)];
        let hang = [hang(bind, upper, lower), hang(bind, lower, foot)];
        Leg { side, upper, lower, foot, toe, hang, lengths, ankle, heel, ball }
    }

    /// `knee` turns the knee inward or outward with the hips, radians; the foot's `x, y, z` are metres here.
    fn place(
        &self,
        hip: DVec3,
        heading: DQuat,
        knee: f64,
        [x, y, z, yaw, pitch]: [f64; 5],
        world: &mut [Option<DQuat>],
    ) {
        let side = self.side;
        let turned = heading * DQuat::from_rotation_y(side * yaw.to_radians());
        // A soft split of the pitch: heel up rolls over the ball, toes up over the heel, smoothly through zero.
        let up = pitch.max(0.0) + (-pitch.abs()).exp().ln_1p();
        let (up, down) = (DQuat::from_rotation_x(up.to_radians()), DQuat::from_rotation_x((pitch - up).to_radians()));
        let ball = heading * self.ball + heading * DVec3::new(side * x, y, z);
        let ankle = ball + turned * (up * (self.heel - self.ball + down * (self.ankle - self.heel)));
        let foot = turned * up * down;
        // Toes stay flat under a lifted heel while the foot is near the floor.
        let flat = 1.0 / (1.0 + (y / 0.05).max(0.0).powi(2));
        let [thigh, shank] = self.lengths;
        let reach = thigh + shank;
        let distance = soft_limit(hip.distance(ankle) / reach).max((thigh - shank).abs() / reach + 0.05) * reach;
        let towards = (ankle - hip).normalize_or(DVec3::NEG_Y);
        let yaw = DQuat::from_rotation_y(0.7 * side * yaw.to_radians() + knee);
        let pole = heading * DQuat::from_rotation_arc(DVec3::NEG_Y, heading.inverse() * towards) * yaw * DVec3::Z;
        let cosine = (thigh * thigh + distance * distance - shank * shank) / (2.0 * thigh * distance);
        let bend = cosine.clamp(-1.0, 1.0).acos();
        let down_thigh = towards * bend.cos() + pole * bend.sin();
        let front = pole * bend.cos() - towards * bend.sin();
        let upper = DQuat::from_mat3(&DMat3::from_cols(front.cross(down_thigh), -down_thigh, front)).normalize();
        let cosine = (thigh * thigh + shank * shank - distance * distance) / (2.0 * thigh * shank);
        let lower = upper * DQuat::from_rotation_x(std::f64::consts::PI - cosine.clamp(-1.0, 1.0).acos());
        world[self.upper] = Some(upper * self.hang[0]);
        world[self.lower] = Some(lower * self.hang[1]);
        world[self.foot] = Some(foot);
        if let Some(toe) = self.toe {
            world[toe] = Some(foot * DQuat::IDENTITY.slerp(up.inverse(), flat));
        }
    }
}

/// Canonical direction of the bone between two joints -> hanging down.
fn hang(bind: &[DAffine3], from: usize, to: usize) -> DQuat {
    let bone = (bind[to].translation - bind[from].translation).normalize_or(DVec3::NEG_Y);
    DQuat::from_rotation_arc(bone, DVec3::NEG_Y)
}

/// Splines overshoot below the floor where a foot lands. A soft maximum keeps the foot above -3 ‰ of a leg.
fn soft_floor(height: f64) -> f64 {
    0.5 * (height + height.hypot(0.006)) - 0.003
}

/// The rotation by pitch (forward), yaw (to the left) and lean (to the left: the head moves towards +X), degrees.
fn euler([pitch, yaw, lean]: [f64; 3]) -> DQuat {
    let [pitch, yaw, lean] = [pitch, yaw, lean].map(f64::to_radians);
    DQuat::from_rotation_y(yaw) * DQuat::from_rotation_x(pitch) * DQuat::from_rotation_z(-lean)
}

/// Shares a turn equally among the joints of a chain.
fn spread(chain: &[usize], angles: [f64; 3], turn: &mut [DQuat]) {
    let share = chain.len().max(1) as f64;
    chain.iter().for_each(|&joint| turn[joint] = euler(angles.map(|angle| angle / share)));
}

/// The identity from `FOLD[0]` to `REACH[0]`, bent towards their limits outside. A leg that snaps straight would move
/// its knee too fast.
fn soft_limit(share: f64) -> f64 {
    let bent = |[from, limit]: [f64; 2]| from + (limit - from) * ((share - from) / (limit - from)).tanh();
    if share > REACH[0] {
        bent(REACH)
    } else if share < FOLD[0] {
        bent(FOLD)
    } else {
        share
    }
}
