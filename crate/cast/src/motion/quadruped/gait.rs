//! Gaits: four paws on one path with phase offsets, trunk, neck and tail in step with them; simulation.md §5.
//! Phases: walk and trot after Hildebrand (1965), rotary gallop as cats and foxes run.

use super::stance::Stance;
use crate::motion::curve::through;
use std::f64::consts::TAU;

/// How an animal goes. Lengths in leg lengths, angles in degrees; the paws' order is that of [`Stance::paws`].
#[derive(Clone, Copy, Debug)]
pub struct Gait {
    /// Name of the clip.
    pub name: &'static str,
    /// Seconds per stride, and strides per clip.
    pub stride: (f64, usize),
    /// Share of the stride at which each paw lands.
    pub phase: [f64; 4],
    /// Of a paw: share of the stride it is down, how far it moves back meanwhile, how high it is lifted.
    pub step: [f64; 3],
    /// Hips: height, bob, sway to the side. The bob comes once a stride in a gallop, else twice.
    pub hips: [f64; 3],
    /// Bound of the trunk once a stride, as in a gallop: pitch, arch.
    pub bound: [f64; 2],
    /// Swing of the spine to the side, roll of the trunk.
    pub swing: [f64; 2],
    /// Neck and head: neck up, nod, head up.
    pub head: [f64; 3],
    /// Tail: root up, swing, curled up.
    pub tail: [f64; 3],
    /// Steady bend to the left, in a turn.
    pub turn: f64,
}

const WALK: Gait = Gait {
    name: "walk",
    stride: (0.90, 6),
    phase: [0.0, 0.5, 0.25, 0.75],
    step: [0.64, 0.62, 0.13],
    hips: [-0.045, 0.010, 0.018],
    bound: [0.0, 0.0],
    swing: [7.0, 2.5],
    head: [-8.0, 4.0, -4.0],
    tail: [8.0, 10.0, 10.0],
    turn: 0.0,
};

const TROT: Gait = Gait {
    name: "trot",
    stride: (0.50, 10),
    phase: [0.0, 0.5, 0.5, 0.0],
    step: [0.46, 0.66, 0.22],
    hips: [-0.05, 0.030, 0.008],
    swing: [5.0, 2.0],
    head: [-4.0, 2.0, 0.0],
    tail: [26.0, 7.0, 8.0],
    ..WALK
};

const GALLOP: Gait = Gait {
    name: "gallop",
    stride: (0.46, 11),
    phase: [0.0, 0.10, 0.62, 0.52],
    step: [0.32, 0.80, 0.28],
    hips: [-0.09, 0.055, 0.0],
    bound: [9.0, 26.0],
    swing: [1.5, 1.0],
    head: [-22.0, 3.0, -6.0],
    tail: [36.0, 4.0, 6.0],
    turn: 0.0,
};

/// Every gait.
pub const GAITS: &[Gait] = &[
    WALK,
    TROT,
    Gait {
        name: "pace",
        stride: (0.62, 8),
        phase: [0.0, 0.5, 0.06, 0.56],
        step: [0.54, 0.58, 0.16],
        hips: [-0.05, 0.016, 0.034],
        swing: [3.0, 5.0],
        ..WALK
    },
    Gait {
        name: "canter",
        stride: (0.58, 9),
        phase: [0.0, 0.22, 0.26, 0.50],
        step: [0.38, 0.72, 0.24],
        hips: [-0.05, 0.045, 0.0],
        bound: [7.0, 13.0],
        swing: [2.5, 2.0],
        head: [-12.0, 4.0, -3.0],
        tail: [28.0, 5.0, 8.0],
        ..WALK
    },
    GALLOP,
    Gait {
        name: "turn left",
        stride: (1.25, 5),
        step: [0.64, 0.54, 0.12],
        hips: [-0.07, 0.010, 0.018],
        turn: 30.0,
        ..WALK
    },
    Gait {
        name: "turn right",
        stride: (1.25, 5),
        step: [0.64, 0.54, 0.12],
        hips: [-0.07, 0.010, 0.018],
        turn: -30.0,
        ..WALK
    },
    Gait { name: "trot left", stride: (0.52, 10), turn: 22.0, ..TROT },
    Gait { name: "trot right", stride: (0.52, 10), turn: -22.0, ..TROT },
    Gait {
        name: "stalk",
        stride: (1.60, 4),
        step: [0.72, 0.56, 0.15],
        hips: [-0.30, 0.008, 0.012],
        swing: [9.0, 3.0],
        head: [-46.0, 2.0, -4.0],
        tail: [14.0, 6.0, 22.0],
        ..WALK
    },
    Gait {
        name: "prance",
        stride: (0.66, 8),
        step: [0.42, 0.40, 0.42],
        hips: [-0.04, 0.050, 0.0],
        head: [12.0, 5.0, -2.0],
        tail: [62.0, 12.0, 30.0],
        ..TROT
    },
    Gait { name: "back up", stride: (1.05, 5), step: [0.62, -0.42, 0.12], head: [4.0, 3.0, -6.0], ..WALK },
];

impl Gait {
    /// Stance at `time` seconds.
    pub fn at(&self, time: f64) -> Stance {
        let phase = time / self.stride.0;
        let angle = TAU * phase;
        let [height, bob, sway] = self.hips;
        let [pitch, arch] = self.bound;
        let [swing, roll] = self.swing;
        let [neck, nod, head] = self.head;
        let [tail, wag, curl] = self.tail;
        // The left hind paw lands at phase 0. The trunk is low twice a stride, in a gallop once.
        let bounding = arch > 0.0;
        let beat = if bounding { angle - 2.2 } else { 2.0 * angle - 0.9 };
        let side = (angle + 0.3).cos();
        let nodding = nod * (if bounding { angle + 1.0 } else { 2.0 * angle + 0.6 }).sin();
        // A turning gait goes round once per clip.
        let laps = self.turn.signum() * f64::from(u8::from(self.turn != 0.0));
        let heading = 360.0 * laps * phase / self.stride.1 as f64;
        let paws = std::array::from_fn(|paw| self.paw(paw, phase));
        Stance {
            heading,
            hips: [sway * (angle - 0.5).sin(), height - bob * beat.cos(), 0.0],
            trunk: [pitch * (angle - 0.9).sin(), 0.5 * swing * side, roll * (angle - 0.6).sin() + 0.15 * self.turn],
            spine: [arch * (angle - 0.2).cos() - 0.2 * arch, self.turn - swing * side, -roll * (angle - 0.6).sin()],
            neck: [neck + nodding, 0.9 * self.turn, 0.0],
            head: [head + 0.5 * nodding, 1.3 * self.turn, 0.0],
            tail: [
                tail + 0.5 * bob * 200.0 * (beat + 0.8).cos(),
                wag * (angle + 0.9).sin() + 0.5 * self.turn,
                curl + 60.0 * bob * (beat - 0.4).cos(),
                1.6 * wag * (angle - 0.3).sin() + 0.6 * self.turn,
            ],
            ears: 0.6 * arch,
            paws,
        }
    }

    /// Channels of one paw at a phase of the stride.
    fn paw(&self, paw: usize, phase: f64) -> [f64; 4] {
        let [duty, length, lift] = self.step;
        let air = 1.0 - duty;
        let fore = paw >= 2;
        // A hind paw rolls off further, a forepaw folds more.
        let [off, fold] = if fore { [26.0, 78.0] } else { [34.0, 52.0] };
        let fold = fold * (lift / 0.2).min(1.3);
        let keys = [
            (0.0, [0.50, 0.0, -6.0]),
            (0.33 * duty, [0.17, 0.0, 0.0]),
            (0.67 * duty, [-0.17, 0.0, 4.0]),
            (duty, [-0.50, 0.0, off]),
            (duty + 0.28 * air, [-0.44, 0.62 * lift, fold]),
            (duty + 0.62 * air, [0.22, lift, 0.7 * fold]),
            (duty + 0.88 * air, [0.54, 0.30 * lift, 4.0]),
        ];
        let [forward, up, heel] = through(&keys, 1.0, phase - self.phase[paw]);
        // In a turn the inner steps are shorter, and the paws follow the bend.
        let inner = if paw.is_multiple_of(2) { 1.0 } else { -1.0 } * self.turn / 220.0;
        [-0.02, up, forward * length * (1.0 - inner), heel]
    }
}
