//! How a dolphin swims: key strokes over a wave of one period per beat, closed and C¹ by `through`.
//! Angles in degrees, lengths in metres; see [`Stroke`] for the channels.

use super::stroke::Stroke;

/// A motion that repeats, with a whole number of beats.
pub struct Move {
    /// Name of the clip.
    pub name: &'static str,
    /// Seconds until it repeats.
    pub period: f64,
    /// Beats of the flukes per period.
    pub beats: usize,
    /// Key strokes in time order.
    pub keys: Vec<(f64, Stroke)>,
}

const CRUISE: Stroke = Stroke {
    beat: 1.0,
    place: [0.0; 3],
    turn: [0.0; 3],
    fore: [0.0; 3],
    tail: [0.0; 3],
    fluke: 0.0,
    fins: [[0.0, 8.0, 0.0]; 2],
};
const GLIDE: Stroke = Stroke { beat: 0.12, fins: [[10.0, 0.0, 0.0]; 2], ..CRUISE };
const SLOW: Stroke = Stroke { beat: 0.5, ..CRUISE };

/// The strokes at even intervals over `period` seconds.
fn even(name: &'static str, period: f64, beats: usize, strokes: &[Stroke]) -> Move {
    let interval = period / strokes.len() as f64;
    let keys = strokes.iter().enumerate().map(|(i, &stroke)| (interval * i as f64, stroke)).collect();
    Move { name, period, beats, keys }
}

/// Every move.
pub fn moves() -> Vec<Move> {
    let mut all = swims();
    all.extend(turns());
    all.extend(tricks());
    all.extend(play());
    all
}

/// Straight ahead.
fn swims() -> Vec<Move> {
    let fast = Stroke { beat: 1.55, fins: [[-6.0, 34.0, 0.0]; 2], ..CRUISE };
    let drift = Stroke { turn: [3.0, 0.0, 5.0], fore: [4.0, 8.0, 0.0], ..GLIDE };
    let brake =
        Stroke { beat: 0.2, turn: [14.0, 0.0, 0.0], tail: [-26.0, 0.0, 0.0], fins: [[26.0, -18.0, 34.0]; 2], ..CRUISE };
    let kick = Stroke { beat: 1.9, ..fast };
    vec![
        even("cruise", 8.0, 8, &[CRUISE]),
        even("slow swim", 9.0, 5, &[SLOW, Stroke { beat: 0.65, fore: [3.0, 5.0, 0.0], ..SLOW }]),
        even("fast swim", 6.0, 12, &[fast, Stroke { turn: [2.0, 0.0, 2.0], ..fast }]),
        even("glide", 7.0, 3, &[GLIDE, drift, GLIDE, drift.mirrored()]),
        even("burst and glide", 8.0, 12, &[GLIDE, kick, fast, GLIDE, GLIDE, GLIDE]),
        even("brake", 6.0, 5, &[CRUISE, brake, brake, SLOW]),
    ]
}

/// To the sides and up and down.
fn turns() -> Vec<Move> {
    let left = Stroke {
        beat: 0.8,
        turn: [0.0, 8.0, 28.0],
        fore: [2.0, 26.0, 4.0],
        tail: [0.0, 34.0, 6.0],
        fins: [[-14.0, -6.0, 0.0], [16.0, 10.0, 0.0]],
        ..CRUISE
    };
    let tight =
        Stroke { beat: 0.35, turn: [4.0, 14.0, 48.0], fore: [10.0, 36.0, 8.0], tail: [10.0, 52.0, 8.0], ..left };
    let dive = Stroke { turn: [-42.0, 0.0, 0.0], place: [0.0, -0.2, 0.0], fore: [-12.0, 0.0, 0.0], ..CRUISE };
    let enter = Stroke { turn: [-16.0, 0.0, 0.0], fore: [-26.0, 0.0, 0.0], tail: [-20.0, 0.0, 0.0], ..CRUISE };
    let level = Stroke { turn: [-12.0, 0.0, 0.0], fore: [24.0, 0.0, 0.0], tail: [22.0, 0.0, 0.0], ..CRUISE };
    let rise = Stroke { beat: 1.2, turn: [34.0, 0.0, 0.0], fore: [14.0, 0.0, 0.0], ..CRUISE };
    let breath =
        Stroke { beat: 0.3, turn: [8.0, 0.0, 0.0], fore: [-16.0, 0.0, 0.0], tail: [-18.0, 0.0, 0.0], ..CRUISE };
    let s = Stroke { beat: 0.6, fore: [0.0, 28.0, 0.0], tail: [0.0, -38.0, 0.0], turn: [0.0, -10.0, 10.0], ..CRUISE };
    vec![
        even("bank left", 6.0, 5, &[CRUISE, left, left, CRUISE]),
        even("bank right", 6.0, 5, &[CRUISE, left.mirrored(), left.mirrored(), CRUISE]),
        even("tight turn left", 7.0, 5, &[CRUISE, left, tight, tight, left]),
        even("tight turn right", 7.0, 5, &[CRUISE, left, tight, tight, left].map(|stroke| stroke.mirrored())),
        even("weave", 8.0, 8, &[CRUISE, left, CRUISE, left.mirrored()]),
        even("dive", 7.0, 7, &[CRUISE, enter, dive, dive, level]),
        even("surface", 7.0, 7, &[CRUISE, level, rise, breath, enter]),
        even("s-bend", 8.0, 7, &[s, SLOW, s.mirrored(), SLOW]),
    ]
}

/// Leaps and rolls.
fn tricks() -> Vec<Move> {
    let up =
        Stroke { beat: 1.5, turn: [46.0, 0.0, 0.0], place: [0.0, 0.0, 0.0], fins: [[-4.0, 30.0, 0.0]; 2], ..CRUISE };
    let top = Stroke {
        beat: 0.1,
        turn: [2.0, 0.0, 4.0],
        place: [0.0, 0.7, 0.1],
        fore: [-34.0, 0.0, 0.0],
        tail: [-46.0, 0.0, 0.0],
        ..CRUISE
    };
    let down = Stroke { turn: [-46.0, 0.0, 0.0], place: [0.0, 0.1, 0.1], fore: [-8.0, 0.0, 0.0], beat: 0.4, ..CRUISE };
    let roll = |turn: f64| Stroke {
        beat: 0.7,
        turn: [0.0, 0.0, turn],
        fore: [0.0, 0.0, 14.0],
        tail: [0.0, 0.0, -14.0],
        fins: [[-10.0, 4.0, 0.0], [10.0, 4.0, 0.0]],
        ..CRUISE
    };
    let coil = |turn: f64| Stroke {
        fore: [14.0 * turn.to_radians().cos(), 18.0 * turn.to_radians().sin(), 16.0],
        tail: [20.0 * turn.to_radians().cos(), -24.0 * turn.to_radians().sin(), -16.0],
        ..roll(turn)
    };
    let stand =
        Stroke { beat: 1.3, turn: [66.0, 0.0, 0.0], fore: [-22.0, 0.0, 0.0], tail: [-14.0, 0.0, 0.0], ..CRUISE };
    vec![
        even(
            "leap",
            6.0,
            6,
            &[CRUISE, up, top, down, Stroke { turn: [-18.0, 0.0, 0.0], fore: [20.0, 0.0, 0.0], ..SLOW }],
        ),
        even(
            "roll",
            7.0,
            5,
            &[CRUISE, roll(34.0), roll(80.0), roll(34.0), CRUISE, roll(-34.0), roll(-80.0), roll(-34.0)],
        ),
        even("corkscrew", 9.0, 6, &[-135.0, -95.0, -40.0, 20.0, 80.0, 125.0, 80.0, 20.0, -40.0, -95.0].map(coil)),
        even("tail stand", 7.0, 10, &[CRUISE, up, stand, Stroke { turn: [66.0, 14.0, 0.0], ..stand }, stand, SLOW]),
    ]
}

/// Play with head, fins and tail.
fn play() -> Vec<Move> {
    let look = Stroke { beat: 0.3, fore: [8.0, 38.0, 10.0], turn: [2.0, 4.0, 6.0], ..GLIDE };
    let nod = |up: f64| Stroke { beat: 0.3, fore: [up, 0.0, 0.0], ..GLIDE };
    let flap = |raised: f64, edge: f64| Stroke { beat: 0.35, fins: [[raised, 4.0, edge]; 2], ..CRUISE };
    let paddle =
        Stroke { beat: 0.4, fins: [[26.0, -22.0, 24.0], [-18.0, 34.0, -12.0]], turn: [0.0, 0.0, 8.0], ..CRUISE };
    let slap =
        |up: f64| Stroke { beat: 0.1, tail: [up, 0.0, 0.0], fluke: 0.4 * up, fore: [0.3 * up, 0.0, 0.0], ..GLIDE };
    let curl = Stroke { beat: 0.1, fore: [-42.0, 0.0, 0.0], tail: [-62.0, 0.0, 0.0], fluke: -12.0, ..GLIDE };
    let hollow = Stroke { fore: [36.0, 0.0, 0.0], tail: [48.0, 0.0, 0.0], fluke: 10.0, ..curl };
    let twist = Stroke { beat: 0.4, fore: [0.0, 6.0, 30.0], tail: [0.0, 6.0, -38.0], ..CRUISE };
    vec![
        even("look around", 8.0, 4, &[GLIDE, look, look, GLIDE, look.mirrored(), look.mirrored()]),
        even("nod", 6.0, 3, &[GLIDE, nod(20.0), nod(-22.0), nod(18.0), nod(-18.0), GLIDE]),
        even(
            "fin flaps",
            6.0,
            4,
            &[(30.0, 14.0), (-16.0, -14.0)].repeat(4).iter().map(|&(r, e)| flap(r, e)).collect::<Vec<_>>(),
        ),
        even("paddle", 6.0, 5, &[paddle, CRUISE, paddle.mirrored(), CRUISE, paddle, SLOW, paddle.mirrored(), SLOW]),
        even("tail slap", 6.0, 3, &[GLIDE, slap(40.0), slap(-36.0), slap(30.0), slap(-30.0), GLIDE]),
        even("curl", 7.0, 4, &[GLIDE, curl, curl, GLIDE, hollow, hollow]),
        even("twist", 7.0, 5, &[SLOW, twist, SLOW, twist.mirrored()]),
    ]
}
