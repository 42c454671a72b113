//! What animals do in one place: stand, look, sniff, sit, lie, stretch. Key stances, closed and C¹ by `through`.
//! Lengths in leg lengths, angles in degrees; see [`Stance`] for the channels.

use super::actions::actions;
use super::stance::{LIE, Move, STAND, Stance, even};

/// On its haunches, forelegs straight.
const SIT: Stance = Stance {
    hips: [0.0, -0.66, 0.20],
    trunk: [43.0, 0.0, 0.0],
    spine: [16.0, 0.0, 0.0],
    neck: [6.0, 0.0, 0.0],
    head: [0.0; 3],
    tail: [48.0, 0.0, 16.0, 34.0],
    paws: [[0.06, 0.0, 0.60, -74.0], [0.06, 0.0, 0.60, -74.0], [-0.02, 0.0, -0.06, 0.0], [-0.02, 0.0, -0.06, 0.0]],
    ..STAND
};

/// Every move made of key stances.
pub fn moves() -> Vec<Move> {
    let mut all = vec![stand(), look(), sniff(), sit(), lie(), bow(), stretch(), arch()];
    all.extend(actions());
    all
}

/// Breath, weight from one side to the other, the tail at play.
fn stand() -> Move {
    let left = Stance {
        hips: [0.035, -0.035, 0.0],
        trunk: [-1.0, 2.0, -2.0],
        spine: [2.0, 5.0, 0.0],
        neck: [-6.0, 8.0, 0.0],
        head: [-4.0, 12.0, 4.0],
        tail: [10.0, 14.0, 10.0, 26.0],
        ..STAND
    };
    let breath = Stance { spine: [4.0, 0.0, 0.0], neck: [4.0, 0.0, 0.0], head: [3.0, 0.0, 0.0], ears: 12.0, ..STAND };
    even("stand", 1.1, &[STAND, left, breath, left.mirrored(), STAND, breath])
}

fn look() -> Move {
    let left = Stance {
        hips: [0.02, -0.03, 0.0],
        spine: [0.0, 14.0, 0.0],
        neck: [0.0, 42.0, 0.0],
        head: [4.0, 76.0, 6.0],
        tail: [14.0, -8.0, 10.0, -18.0],
        ..STAND
    };
    let back = Stance {
        spine: [0.0, 34.0, -4.0],
        trunk: [0.0, 6.0, 0.0],
        neck: [-6.0, 66.0, 0.0],
        head: [-8.0, 118.0, 8.0],
        ..left
    };
    let up = Stance { trunk: [4.0, 0.0, 0.0], neck: [24.0, 0.0, 0.0], head: [30.0, 0.0, 0.0], ..STAND };
    let low = Stance { trunk: [-6.0, 0.0, 0.0], neck: [-38.0, 0.0, 0.0], head: [-22.0, 0.0, 0.0], ..STAND };
    let keys = [STAND, left, left, back, left, STAND, up, up, left.mirrored(), back.mirrored(), left.mirrored(), low];
    even("look around", 0.8, &keys)
}

/// Nose along the ground, from side to side.
fn sniff() -> Move {
    let down = Stance {
        hips: [0.0, -0.05, 0.0],
        trunk: [-24.0, 0.0, 0.0],
        spine: [6.0, 0.0, 0.0],
        neck: [-98.0, 0.0, 0.0],
        head: [-66.0, 0.0, 0.0],
        tail: [12.0, 0.0, 8.0, 0.0],
        paws: [[0.0; 4], [0.0; 4], [0.05, 0.0, 0.12, 0.0], [0.05, 0.0, 0.02, 0.0]],
        ..STAND
    };
    let side = Stance {
        trunk: [-24.0, 4.0, 0.0],
        spine: [4.0, 12.0, 0.0],
        neck: [-94.0, 30.0, 0.0],
        head: [-56.0, 36.0, 0.0],
        tail: [16.0, 10.0, 10.0, 24.0],
        ..down
    };
    let near = Stance { neck: [-99.0, 0.0, 0.0], head: [-72.0, 0.0, 0.0], ..down };
    let half = Stance { neck: [-40.0, 0.0, 0.0], head: [-24.0, 0.0, 0.0], trunk: [-8.0, 0.0, 0.0], ..down };
    even("sniff", 0.75, &[STAND, half, down, side, near, side.mirrored(), down, side, half])
}

fn sit() -> Move {
    let half = Stance {
        hips: [0.0, -0.34, 0.06],
        trunk: [24.0, 0.0, 0.0],
        spine: [14.0, 0.0, 0.0],
        tail: [40.0, 0.0, 14.0, 10.0],
        paws: [[0.04, 0.0, 0.30, -30.0], [0.04, 0.0, 0.30, -30.0], [0.0; 4], [0.0; 4]],
        ..STAND
    };
    let left = Stance { neck: [4.0, 34.0, 0.0], head: [2.0, 58.0, 8.0], ears: 10.0, ..SIT };
    let right = Stance { neck: [10.0, -30.0, 0.0], head: [12.0, -46.0, -14.0], ..SIT };
    let wag = |curl: f64| Stance { tail: [48.0, 0.3 * curl, 16.0, curl], ..SIT };
    even("sit", 0.7, &[STAND, half, SIT, wag(10.0), left, left, wag(60.0), right, right, wag(0.0), SIT, half])
}

fn lie() -> Move {
    let half = Stance {
        hips: [0.0, -0.32, 0.0],
        trunk: [-4.0, 0.0, 0.0],
        spine: [8.0, 0.0, 0.0],
        tail: [24.0, 0.0, 10.0, 10.0],
        paws: [[0.04, 0.0, 0.14, -26.0], [0.04, 0.0, 0.14, -26.0], [0.0, 0.0, 0.24, -24.0], [0.0, 0.0, 0.24, -24.0]],
        ..STAND
    };
    let left = Stance { spine: [6.0, 16.0, 0.0], neck: [8.0, 36.0, 0.0], head: [2.0, 60.0, 4.0], ..LIE };
    let rest =
        Stance { neck: [-44.0, 0.0, 0.0], head: [-14.0, 0.0, 0.0], ears: 20.0, tail: [36.0, 0.0, 10.0, 60.0], ..LIE };
    even("lie down", 0.8, &[STAND, half, LIE, left, left, LIE, left.mirrored(), LIE, rest, rest, LIE, half])
}

/// The play bow: elbows down, rump and tail up.
pub const BOW: Stance = Stance {
    hips: [0.0, -0.02, -0.10],
    trunk: [-31.0, 0.0, 0.0],
    spine: [-14.0, 0.0, 0.0],
    neck: [26.0, 0.0, 0.0],
    head: [14.0, 0.0, 0.0],
    tail: [66.0, 0.0, 30.0, 0.0],
    paws: [[0.02, 0.0, 0.0, 0.0], [0.02, 0.0, 0.0, 0.0], [0.04, 0.0, 0.50, -58.0], [0.04, 0.0, 0.50, -58.0]],
    ..STAND
};

fn bow() -> Move {
    let half = Stance {
        trunk: [-14.0, 0.0, 0.0],
        tail: [40.0, 0.0, 20.0, 0.0],
        paws: [[0.0; 4], [0.0; 4], [0.03, 0.04, 0.24, -16.0], [0.03, 0.0, 0.20, -22.0]],
        ..STAND
    };
    let wag = |side: f64| Stance {
        hips: [0.03 * side, -0.02, -0.10],
        spine: [-14.0, 10.0 * side, 0.0],
        head: [14.0, 14.0 * side, 8.0 * side],
        tail: [66.0, 22.0 * side, 30.0, 30.0 * side],
        ..BOW
    };
    even("play bow", 0.55, &[STAND, half, BOW, wag(1.0), wag(-1.0), wag(1.0), wag(-1.0), BOW, BOW, half])
}

/// Weight forward, one hind leg after the other stretched out behind.
fn stretch() -> Move {
    let forward = Stance {
        hips: [0.0, -0.06, 0.14],
        trunk: [3.0, 0.0, 0.0],
        spine: [-12.0, 0.0, 0.0],
        neck: [14.0, 0.0, 0.0],
        head: [16.0, 0.0, 0.0],
        tail: [40.0, 0.0, 24.0, 0.0],
        ..STAND
    };
    let out = Stance {
        hips: [-0.05, -0.05, 0.16],
        paws: [[0.02, 0.10, -0.52, 70.0], [0.0; 4], [0.0; 4], [0.0; 4]],
        ..forward
    };
    even("stretch", 0.75, &[STAND, forward, out, out, forward, out.mirrored(), out.mirrored(), forward])
}

/// Back up in a hoop, then hollow.
fn arch() -> Move {
    let hoop = Stance {
        hips: [0.0, 0.01, 0.02],
        trunk: [-2.0, 0.0, 0.0],
        spine: [72.0, 0.0, 0.0],
        neck: [-34.0, 0.0, 0.0],
        head: [-34.0, 0.0, 0.0],
        tail: [58.0, 0.0, 44.0, 0.0],
        ears: 30.0,
        paws: [[0.0, 0.0, 0.16, 0.0], [0.0, 0.0, 0.16, 0.0], [0.0, 0.0, -0.14, 0.0], [0.0, 0.0, -0.14, 0.0]],
        ..STAND
    };
    let hollow = Stance {
        hips: [0.0, -0.10, 0.0],
        spine: [-34.0, 0.0, 0.0],
        neck: [16.0, 0.0, 0.0],
        head: [20.0, 0.0, 0.0],
        tail: [50.0, 0.0, 20.0, 0.0],
        ..STAND
    };
    let side = Stance { spine: [60.0, 24.0, 8.0], head: [-24.0, 36.0, 0.0], neck: [-26.0, 20.0, 0.0], ..hoop };
    even("arch", 0.9, &[STAND, hoop, hoop, side, hoop, STAND, hollow, hollow])
}
