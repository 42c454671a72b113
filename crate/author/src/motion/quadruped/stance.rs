//! A stance of any four-legged animal as anatomical channels: what its motions are written in and blended in.
//! Angles in degrees, lengths in leg lengths (hip to floor); all zero is the canonical pose, standing.

use crate::motion::curve::Channels;

/// Channels of one stance. Triples of angles are up, to the left, rolled to the left (left side down).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stance {
    /// Turn of the whole body about the vertical, to the left.
    pub heading: f64,
    /// Hips moved from standing: to the left, up, forward.
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
