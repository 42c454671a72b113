//! Slow motion of a rigid obstacle beside a fixed root: pushed into the cloth, lifted, slid, turned, taken away.

use super::curve::{Channels, halton, through};
use super::{bones::euler, sample};
use crate::{Error, Result};
use ctsn_rig::{Character, Clip, Pose};
use glam::{DAffine3, DVec3};

/// Shift of the obstacle from its canonical place (left, up, forward; metres), and its turn (up, left, roll; degrees).
type Place = [[f64; 3]; 2];

/// Seconds until a clip repeats.
const PERIOD: f64 = 10.0;
/// Number of clips through low-discrepancy places, and of places in each. Six degrees of freedom want variety: after
/// training on 960 poses, a sheet over the box was wrong by 8.5, 13.2 and 6.1 mm on the last three clips with 30
/// wanderings, by 13.6, 16.1 and 13.3 mm with 8.
const WANDERINGS: usize = 30;
const KEYS: usize = 8;
/// Bounds of those places.
const LEAST: Place = [[-0.24, -0.12, -0.12], [-30.0, -45.0, -30.0]];
const MOST: Place = [[0.24, 0.18, 0.48], [30.0, 45.0, 30.0]];

/// Clips by name, with the places each goes through at even intervals.
const MOVES: &[(&str, &[Place])] = &[
    ("push", &[[[0.0; 3], [0.0; 3]], [[0.0, 0.0, 0.46], [0.0; 3]]]),
    ("push high", &[[[0.0, 0.1, 0.0], [0.0; 3]], [[0.02, 0.18, 0.4], [0.0, 20.0, 0.0]]]),
    ("push low", &[[[0.0, -0.06, 0.0], [0.0; 3]], [[-0.02, -0.12, 0.4], [0.0, -20.0, 0.0]]]),
    ("push left", &[[[0.2, 0.0, 0.0], [0.0; 3]], [[0.2, 0.02, 0.42], [0.0, 30.0, 0.0]]]),
    ("push right", &[[[-0.2, 0.0, 0.0], [0.0; 3]], [[-0.2, 0.02, 0.42], [0.0, -30.0, 0.0]]]),
    ("lift", &[[[0.0, -0.1, 0.22], [0.0; 3]], [[0.0, 0.18, 0.24], [10.0, 0.0, 0.0]]]),
    ("lift far out", &[[[0.0, -0.1, 0.42], [0.0; 3]], [[0.0, 0.15, 0.44], [20.0, 0.0, 0.0]]]),
    ("slide", &[[[-0.22, 0.0, 0.2], [0.0; 3]], [[0.22, 0.0, 0.2], [0.0; 3]]]),
    ("slide far out", &[[[0.22, 0.0, 0.4], [0.0, 0.0, 20.0]], [[-0.22, 0.0, 0.4], [0.0, 0.0, -20.0]]]),
    ("slide low", &[[[-0.2, -0.11, 0.3], [0.0; 3]], [[0.2, -0.11, 0.3], [0.0, 40.0, 0.0]]]),
    ("turn", &[[[0.0, 0.02, 0.34], [0.0, -45.0, 0.0]], [[0.0, 0.0, 0.36], [0.0, 45.0, 0.0]]]),
    ("tilt", &[[[0.05, 0.0, 0.28], [-30.0, 0.0, 0.0]], [[0.05, 0.04, 0.28], [30.0, 0.0, 0.0]]]),
    ("roll", &[[[-0.05, 0.0, 0.32], [0.0, 0.0, -30.0]], [[-0.05, 0.0, 0.3], [0.0, 0.0, 30.0]]]),
    (
        "level circle",
        &[
            [[0.0, 0.0, 0.1], [0.0; 3]],
            [[0.2, 0.0, 0.27], [0.0, 30.0, 0.0]],
            [[0.0, 0.0, 0.45], [0.0; 3]],
            [[-0.2, 0.0, 0.27], [0.0, -30.0, 0.0]],
        ],
    ),
    (
        "swing",
        &[
            [[0.0, -0.1, 0.32], [0.0; 3]],
            [[0.2, 0.1, 0.3], [0.0, 0.0, -25.0]],
            [[0.0, -0.1, 0.28], [0.0; 3]],
            [[-0.2, 0.1, 0.3], [0.0, 0.0, 25.0]],
        ],
    ),
    (
        "circle",
        &[
            [[0.18, 0.03, 0.35], [0.0; 3]],
            [[0.0, 0.16, 0.35], [20.0, 0.0, 0.0]],
            [[-0.18, 0.03, 0.35], [0.0, 30.0, 0.0]],
            [[0.0, -0.1, 0.35], [-20.0, 0.0, 0.0]],
        ],
    ),
    (
        "come and leave",
        &[
            [[0.1, 0.1, -0.12], [0.0; 3]],
            [[0.1, 0.08, 0.2], [10.0, 20.0, 0.0]],
            [[0.0, 0.05, 0.47], [20.0, 30.0, 10.0]],
            [[-0.1, 0.0, 0.2], [10.0, -10.0, 0.0]],
        ],
    ),
];

/// Every clip for `character`, a fixed root and one obstacle, at `rate` poses per second.
pub fn clips(character: &Character, rate: f64) -> Result<Vec<Clip>> {
    let joints = character.joints.len();
    if joints != 2 || character.root != 0 || !character.is_obstacle(1) {
        return Err(Error::Character(format!("wanted a root and one obstacle, found {joints} joints")));
    }
    let bind = character.canonical_pose();
    // A turning ball is the same to the cloth; the network would have to learn to ignore the turn.
    let turns = if is_ball(character, bind[1].translation) { 0.0 } else { 1.0 };
    let pose = |[place, turned]: Place| -> Pose {
        let turn = DAffine3::from_quat(euler(turned.map(|angle| angle * turns)));
        let there = DAffine3::from_translation(bind[1].translation + DVec3::from_array(place));
        vec![bind[0], there * turn * DAffine3::from_mat3(bind[1].matrix3)]
    };
    let play = |name: &str, places: &[Place]| {
        let step = PERIOD / places.len() as f64;
        let keys: Vec<(f64, Place)> = (0..places.len()).map(|i| (step * i as f64, places[i])).collect();
        sample(name, PERIOD, rate, |time| pose(through(&keys, PERIOD, time)))
    };
    // Wanderings go first: a trained model is tested on the last clips of a character.
    let wander = |seed: usize| play(&format!("wander {}", seed + 1), &wandering(seed));
    Ok((0..WANDERINGS).map(wander).chain(MOVES.iter().map(|(name, places)| play(name, places))).collect())
}

/// Whether the obstacle is equally wide (within 5 %) on every side of its joint.
fn is_ball(character: &Character, centre: DVec3) -> bool {
    let body = character.body.part(|joint| joint == 1);
    let radii = body.mesh.positions.iter().map(|point| point.distance(centre));
    let (least, most) = radii.fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), r| (least.min(r), most.max(r)));
    most < 1.05 * least
}

/// Places of wandering `seed`, from the Halton sequence.
fn wandering(seed: usize) -> Vec<Place> {
    let place = |key: usize| {
        let dimension = std::cell::Cell::new(0);
        LEAST.zip(&MOST, |least, most| {
            dimension.set(dimension.get() + 1);
            least + (most - least) * halton(1 + seed * KEYS + key, dimension.get() - 1)
        })
    };
    (0..KEYS).map(place).collect()
}
