//! A stance of any four-legged animal as anatomical channels, in which its motions are written and blended.
//! Angles in degrees, lengths in leg lengths (hip to floor); all zero is the canonical pose, standing.

use crate::motion::curve::{self, Channels};

/// Channels of one stance. Triples of angles are up, to the left, rolled to the left (left side down).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stance {
    /// Turn of the whole body about the vertical, to the left.
    pub heading: f64,
    /// Shift of the hips from standing: to the left, up, forward.
    pub hips: [f64; 3],
    /// Turn of the line from hips to chest.
    pub trunk: [f64; 3],
    /// Chest against the hips, shared by the spine: arched (negative: hollow), to the left, twisted to the left.
    pub spine: [f64; 3],
    /// Neck, against a mean of the chest's turn and the heading.
    pub neck: [f64; 3],
    /// Head, against the heading: the gaze.
    pub head: [f64; 3],
    /// Tail: root up, root to the left, the rest curled up, curled to the left.
    pub tail: [f64; 4],
    /// Ears laid back.
    pub ears: f64,
    /// Paws: left hind, right hind, left fore, right fore; each moved outward, up, forward, and its heel up.
    pub paws: [[f64; 4]; 4],
}

impl Channels for Stance {
    fn zip(&self, other: &Stance, f: impl Fn(f64, f64) -> f64 + Copy) -> Stance {
        Stance {
            heading: f(self.heading, other.heading),
            hips: self.hips.zip(&other.hips, f),
            trunk: self.trunk.zip(&other.trunk, f),
            spine: self.spine.zip(&other.spine, f),
            neck: self.neck.zip(&other.neck, f),
            head: self.head.zip(&other.head, f),
            tail: self.tail.zip(&other.tail, f),
            ears: f(self.ears, other.ears),
            paws: self.paws.zip(&other.paws, f),
        }
    }
}

impl Stance {
    /// Left and right exchanged.
    pub fn mirrored(&self) -> Stance {
        let flip = |[up, left, roll]: [f64; 3]| [up, -left, -roll];
        let Stance { heading, hips: [left, up, forward], trunk, spine, neck, head, tail, ears, paws } = *self;
        Stance {
            heading: -heading,
            hips: [-left, up, forward],
            trunk: flip(trunk),
            spine: flip(spine),
            neck: flip(neck),
            head: flip(head),
            tail: [tail[0], -tail[1], tail[2], -tail[3]],
            ears,
            paws: [paws[1], paws[0], paws[3], paws[2]],
        }
    }
}

/// A motion as key stances.
pub type Move = curve::Move<Stance>;

/// At ease: what every move starts from. The knees give a little.
pub const STAND: Stance = Stance {
    heading: 0.0,
    hips: [0.0, -0.025, 0.0],
    trunk: [0.0; 3],
    spine: [0.0; 3],
    neck: [0.0; 3],
    head: [0.0; 3],
    tail: [4.0, 0.0, 6.0, 0.0],
    ears: 0.0,
    paws: [[0.0; 4]; 4],
};

/// Down on the belly, forearms along the floor.
pub const LIE: Stance = Stance {
    hips: [0.0, -0.58, 0.0],
    trunk: [1.0, 0.0, 0.0],
    spine: [6.0, 0.0, 0.0],
    neck: [8.0, 0.0, 0.0],
    tail: [36.0, 0.0, 10.0, 40.0],
    paws: [[0.08, 0.0, 0.32, -76.0], [0.08, 0.0, 0.32, -76.0], [0.0, 0.0, 0.46, -74.0], [0.0, 0.0, 0.46, -74.0]],
    ..STAND
};

/// The keys at even intervals.
pub fn even(name: &'static str, interval: f64, stances: &[Stance]) -> Move {
    let keys: Vec<(f64, Stance)> = stances.iter().enumerate().map(|(i, &s)| (interval * i as f64, s)).collect();
    Move { name, period: interval * stances.len() as f64, keys }
}
