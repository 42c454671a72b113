//! Postures that cover the joint limits evenly, joined smoothly: they cover what lies between the authored moves.
//! A Korobov lattice of P points: channel c of point i is frac(i gᶜ / P), so each channel takes each level once.
//! Plain random draws left gaps; in 33 channels Halton's large primes march in step over the first hundred points.

use super::posture::Posture;
use crate::motion::curve::Channels;

/// Seconds until a wandering repeats.
pub const PERIOD: f64 = 9.9;
/// How many wanderings there are.
pub const COUNT: u64 = 4;
/// Key postures in a wandering.
pub const KEYS: u64 = 9;
/// P, a prime: one more than the number of all keys. g, a primitive root of P.
const LATTICE: (u64, u64) = (37, 5);

/// The share of the way from between the feet to one of them that the hips go at most. With that, straighter legs and
/// pelvises tilted back thighs come behind the hips, as in any stride: docs/decisions/poses.md.
const OVER: f64 = 0.8;

/// The lower limits; the hips' are those above feet side by side, see [`above`].
pub const LEAST: Posture = Posture {
    heading: -20.0,
    hips: [-0.06, -0.14, -0.05],
    tilt: [-14.0, -18.0, -7.0],
    spine: [-14.0, -32.0, -24.0],
    head: [-20.0, -42.0, -14.0],
    arms: [[20.0, -24.0, -14.0, 6.0, -12.0]; 2],
    feet: [[0.01, 0.0, -0.4, 2.0, 0.0]; 2],
};
/// The upper limits. Arms that reach across the breast brought a dance that holds them there no nearer, and feet lifted
/// so that a knee comes to the breast brought frames with one there nearer and others further off:
/// docs/decisions/poses.md.
pub const MOST: Posture = Posture {
    heading: 20.0,
    hips: [0.06, 0.0, 0.05],
    tilt: [14.0, 18.0, 7.0],
    spine: [32.0, 32.0, 24.0],
    head: [24.0, 42.0, 14.0],
    arms: [[145.0, 76.0, 56.0, 96.0, 22.0]; 2],
    feet: [[0.45, 0.0, 0.4, 30.0, 10.0]; 2],
};

/// The hips between the feet, moved from there towards the foot in front or behind by the share of [`OVER`] that their
/// own shift is of its limit, and as much lower as the leg that is then set further off reaches less high.
fn above(posture: Posture) -> Posture {
    let Posture { mut hips, feet: [left, right], .. } = posture;
    let (aside, ahead) = ((left[0] + right[0]) / 2.0, (left[2] - right[2]) / 2.0);
    let towards = OVER * hips[2] / MOST.hips[2] * ahead.abs();
    let farthest = ahead.abs() + towards.abs();
    hips[0] += (left[0] - right[0]) / 2.0;
    hips[1] -= 1.0 - (1.0 - aside * aside - farthest * farthest).sqrt();
    hips[2] += (left[2] + right[2]) / 2.0 + towards;
    Posture { hips, ..posture }
}

/// Key postures of wandering number `which`, from 0.
pub fn keys(which: u64) -> Vec<(f64, Posture)> {
    let (prime, root) = LATTICE;
    let key = |i: u64| {
        let level = std::cell::Cell::new((which * KEYS + i) % (prime - 1) + 1);
        let posture = LEAST.zip(&MOST, |least, most| {
            level.set(level.get() * root % prime);
            least + (most - least) * level.get() as f64 / prime as f64
        });
        (PERIOD * i as f64 / KEYS as f64, above(posture))
    };
    (0..KEYS).map(key).collect()
}
