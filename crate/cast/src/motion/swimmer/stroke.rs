//! A stroke of a swimmer as anatomical channels, in which its motions are written and blended.
//! Angles in degrees, lengths in metres; all zero is the canonical pose, stretched out.

use crate::motion::curve::Channels;

/// Channels of one stroke. Triples of angles are up, to the left, rolled to the left (left side down).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stroke {
    /// Strength of the wave, 1 in a cruise.
    pub beat: f64,
    /// Shift of the body's middle: to the left, up, forward.
    pub place: [f64; 3],
    /// Turn of the body's middle.
    pub turn: [f64; 3],
    /// Fore part against the middle, shared by its joints: up, to the left, twisted to the left.
    pub fore: [f64; 3],
    /// Tail against the middle: flukes up, to the left, twisted to the left.
    pub tail: [f64; 3],
    /// Flukes against the tail: up.
    pub fluke: f64,
    /// Left and right pectoral fin: raised, swept back, leading edge up.
    pub fins: [[f64; 3]; 2],
}

impl Channels for Stroke {
    fn zip(&self, other: &Stroke, f: impl Fn(f64, f64) -> f64 + Copy) -> Stroke {
        Stroke {
            beat: f(self.beat, other.beat),
            place: self.place.zip(&other.place, f),
            turn: self.turn.zip(&other.turn, f),
            fore: self.fore.zip(&other.fore, f),
            tail: self.tail.zip(&other.tail, f),
            fluke: f(self.fluke, other.fluke),
            fins: self.fins.zip(&other.fins, f),
        }
    }
}

impl Stroke {
    /// Left and right exchanged.
    pub fn mirrored(&self) -> Stroke {
        let flip = |[up, left, roll]: [f64; 3]| [up, -left, -roll];
        Stroke {
            place: [-self.place[0], self.place[1], self.place[2]],
            turn: flip(self.turn),
            fore: flip(self.fore),
            tail: flip(self.tail),
            fins: [self.fins[1], self.fins[0]],
            ..*self
        }
    }
}
