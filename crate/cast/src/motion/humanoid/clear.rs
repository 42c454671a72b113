//! Keeps arms out of the body and off the floor, whatever the proportions: descent of Σ max(0, depth)³ over arm angles.
//! Spheres fitted to its vertices stand for the body. The function is C² and the descent takes a fixed number of damped
//! steps, so that smooth paths stay smooth.

use super::posture::Posture;
use ctsn_rig::mesh::bounds;
use ctsn_rig::{Character, Pose};
use glam::DVec3;

/// Steps of the descent, and the damping that lets it begin softly, about 5 mm into the margin.
const STEPS: usize = 16;
const DAMPING: f64 = 1e-3;
/// Shares of the leg length: wanted clearance, depth that counts as 1, height of the slabs that spheres are fitted to.
const MARGIN: f64 = 0.035;
const DEPTH: f64 = 0.1;
const SLAB: f64 = 0.07;
/// Step of a difference quotient, radians.
const DELTA: f64 = 1e-3;

/// A sphere fixed to a joint: joint, centre in its space, radius; metres.
type Ball = (usize, DVec3, f64);

/// What an arm must not pass through.
pub struct Clearance {
    obstacles: Vec<Ball>,
    /// Spheres along forearm and hand, left and right.
    arms: [Vec<Ball>; 2],
    floor: f64,
    scale: f64,
}

impl Clearance {
    /// `solid`: joints of trunk, head and legs; `arms`: forearm and hand, left and right; `scale`: leg length, metres.
    pub fn measure(character: &Character, solid: &[usize], arms: [[usize; 2]; 2], floor: f64, scale: f64) -> Clearance {
        let vertices = |joint: usize| -> Vec<DVec3> {
            let follows = |v: &usize| character.body.weights[*v].first().is_some_and(|strongest| strongest.0 == joint);
            (0..character.body.weights.len()).filter(follows).map(|v| character.body.mesh.positions[v]).collect()
        };
        let local = |joint: usize, balls: Vec<(DVec3, f64)>| {
            let bind = character.joints[joint].inverse_bind;
            balls.into_iter().map(move |(centre, radius)| (joint, bind.transform_point3(centre), radius))
        };
        let joint = |index: usize| character.joints[index].inverse_bind.inverse().translation;
        let arm = |[fore, hand]: [usize; 2]| -> Vec<Ball> {
            let wrist = joint(hand);
            let fingers = vertices(hand);
            let farther = |a: &&DVec3, b: &&DVec3| a.distance(wrist).total_cmp(&b.distance(wrist));
            let tip = fingers.iter().max_by(farther).copied().unwrap_or(wrist);
            let bone = |from: DVec3, to: DVec3, at: &[f64], points: &[DVec3]| -> Vec<(DVec3, f64)> {
                let around = thickness(points, from, to);
                at.iter().map(|&share| (from.lerp(to, share), around)).collect()
            };
            local(fore, bone(joint(fore), wrist, &[0.1, 0.4, 0.7, 1.0], &vertices(fore)))
                .chain(local(hand, bone(wrist, tip, &[0.5, 0.95], &fingers)))
                .collect()
        };
        let obstacles = solid.iter().flat_map(|&joint| local(joint, fill(&vertices(joint), SLAB * scale))).collect();
        Clearance { obstacles, arms: arms.map(arm), floor, scale }
    }

    /// Penalty of each arm: Σ depth³ over all it should keep clear of, zero when it does.
    fn penalties(&self, pose: &Pose) -> [f64; 2] {
        let place = |ball: &Ball| (pose[ball.0].transform_point3(ball.1), ball.2);
        let solid: Vec<(DVec3, f64)> = self.obstacles.iter().map(place).collect();
        let arms = [0, 1].map(|side| self.arms[side].iter().map(place).collect::<Vec<_>>());
        let margin = MARGIN * self.scale;
        let cube = |short: f64| (short.max(0.0) / (DEPTH * self.scale)).powi(3);
        let short = |(a, r): (DVec3, f64), (b, s): (DVec3, f64)| cube(r + s + margin - a.distance(b));
        [0, 1].map(|side: usize| {
            let of_point = |&point: &(DVec3, f64)| {
                let others = solid.iter().chain(&arms[1 - side]);
                let floor = cube(self.floor + point.1 + margin - point.0.y);
                floor + others.map(|&other| short(point, other)).sum::<f64>()
            };
            arms[side].iter().map(of_point).sum()
        })
    }

    /// The posture with its arms moved clear; `pose` is the forward kinematics.
    pub fn clear(&self, posture: &Posture, pose: impl Fn(&Posture) -> Pose) -> Posture {
        let mut posture = *posture;
        for _ in 0..STEPS {
            let here = self.penalties(&pose(&posture));
            if here == [0.0; 2] {
                break;
            }
            // Raise, swing, twist, elbow. Both arms move at once: the penalty of one hardly depends on the other.
            let slopes: [[f64; 2]; 4] = std::array::from_fn(|channel| {
                let mut moved = posture;
                moved.arms.iter_mut().for_each(|arm| arm[channel] += DELTA.to_degrees());
                let there = self.penalties(&pose(&moved));
                [0, 1].map(|side| (there[side] - here[side]) / DELTA)
            });
            for side in 0..2 {
                let steepness: f64 = slopes.iter().map(|slope| slope[side] * slope[side]).sum();
                let length = 2.0 * here[side] / (steepness + DAMPING);
                let arm = &mut posture.arms[side];
                // An elbow near straight and an arm near upright give way less, so neither passes its limit.
                let room =
                    [(172.0 - arm[0]).clamp(0.0, 20.0) / 20.0, 1.0, 1.0, arm[3].max(0.0) / (arm[3].max(0.0) + 8.0)];
                for channel in 0..4 {
                    arm[channel] -= (room[channel] * length * slopes[channel][side]).to_degrees();
                }
            }
        }
        posture
    }
}

/// Mean distance of `points` from the line through `from` and `to`, metres; zero without points.
fn thickness(points: &[DVec3], from: DVec3, to: DVec3) -> f64 {
    let along = (to - from).normalize_or(DVec3::Y);
    let total: f64 = points.iter().map(|&p| (p - from).reject_from_normalized(along).length()).sum();
    total / points.len().max(1) as f64
}

/// Spheres (centre, radius) that fill the body part of these vertices. Each slab of height `slab` holds one, or three
/// side by side; their diameter is the smaller of its width and depth.
fn fill(points: &[DVec3], slab: f64) -> Vec<(DVec3, f64)> {
    let [bottom, top] = bounds(points.iter().copied());
    let count = ((top.y - bottom.y) / slab).ceil().clamp(0.0, 100.0) as usize;
    let mut balls = Vec::new();
    for i in 0..count {
        let (from, to) = (bottom.y + slab * i as f64, bottom.y + slab * (i + 1) as f64);
        let [low, high] = bounds(points.iter().copied().filter(|p| (from..=to).contains(&p.y)));
        let (half, middle) = ((high - low) / 2.0, (high + low) / 2.0);
        let radius = half.z.min(half.x);
        // Not above the head nor below the foot.
        let y = if top.y - bottom.y > 2.0 * radius {
            middle.y.clamp(bottom.y + radius, top.y - radius)
        } else {
            (top.y + bottom.y) / 2.0
        };
        // One component is zero: a trunk is wider than deep, a head with its nose deeper than wide.
        let spare = DVec3::new(half.x - radius, 0.0, half.z - radius);
        if radius.is_finite() && radius > 0.0 {
            let sides: &[f64] = if spare.length() > 0.05 * radius { &[-1.0, 0.0, 1.0] } else { &[0.0] };
            balls.extend(sides.iter().map(|&share| (middle.with_y(y) + share * spare, radius)));
        }
    }
    balls
}
