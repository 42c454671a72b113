//! A posture of any humanoid as anatomical channels, in which motions are written and blended.
//! Angles in degrees, lengths in leg lengths (hip to floor); all zero is standing straight, arms hanging.

use crate::motion::curve::{self, Channels};

/// Channels of one posture. Two-element arrays are left, right; a positive angle means the same on either side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Posture {
    /// Turn of the whole body about the vertical, to the left.
    pub heading: f64,
    /// Shift of the hips from standing: to the left, up, forward.
    pub hips: [f64; 3],
    /// Turn of the hips: pitch forward, yaw to the left, roll to the left (left side down).
    pub tilt: [f64; 3],
    /// Spine over all its joints: bend forward, twist to the left, lean to the left.
    pub spine: [f64; 3],
    /// Neck and head together: nod down, turn to the left, tilt to the left.
    pub head: [f64; 3],
    /// Per arm: raise sideways, swing forward, twist outward, elbow, wrist towards the palm.
    pub arms: [[f64; 5]; 2],
    /// Per foot: moved outward, up, forward; turned outward; heel up (negative: toes up).
    pub feet: [[f64; 5]; 2],
}

impl Channels for Posture {
    fn zip(&self, other: &Posture, f: impl Fn(f64, f64) -> f64 + Copy) -> Posture {
        Posture {
            heading: f(self.heading, other.heading),
            hips: self.hips.zip(&other.hips, f),
            tilt: self.tilt.zip(&other.tilt, f),
            spine: self.spine.zip(&other.spine, f),
            head: self.head.zip(&other.head, f),
            arms: self.arms.zip(&other.arms, f),
            feet: self.feet.zip(&other.feet, f),
        }
    }
}

impl Posture {
    /// Left and right exchanged.
    pub fn mirrored(&self) -> Posture {
        let Posture { heading, hips: [x, y, z], tilt: [pitch, yaw, roll], spine, head, arms, feet } = *self;
        Posture {
            heading: -heading,
            hips: [-x, y, z],
            tilt: [pitch, -yaw, -roll],
            spine: [spine[0], -spine[1], -spine[2]],
            head: [head[0], -head[1], -head[2]],
            arms: [arms[1], arms[0]],
            feet: [feet[1], feet[0]],
        }
    }
}

/// A motion as key postures.
pub type Move = curve::Move<Posture>;

/// An arm at ease: raise, swing, twist, elbow, wrist.
const ARM: [f64; 5] = [21.0, 4.0, 0.0, 20.0, 5.0];
/// A foot at ease: outward, up, forward; turned outward, heel up.
pub const FOOT: [f64; 5] = [0.01, 0.0, 0.0, 7.0, 0.0];

/// At ease: what every move starts from.
pub const STAND: Posture = Posture {
    heading: 0.0,
    hips: [0.0, -0.011, 0.0],
    tilt: [0.0; 3],
    spine: [0.0; 3],
    head: [0.0; 3],
    arms: [ARM; 2],
    feet: [FOOT; 2],
};

/// Feet at ease, but each `width` further out.
pub fn wide(width: f64) -> [[f64; 5]; 2] {
    [[width, 0.0, 0.0, 14.0, 0.0]; 2]
}
