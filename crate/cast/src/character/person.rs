//! What the people share: where their rows go, and which joints those follow. Heads, hands and shoes are drawn about an
//! origin, once for all of them, and put in place by [`placed`]. Lengths in metres.

use super::figure::{PART, Part};

pub type Influence = &'static [(&'static str, f64, f64)];

pub const UP: [f64; 3] = [0.0, 1.0, 0.0];
pub const FRONT: [f64; 3] = [0.0, 0.0, 1.0];
/// Along the left arm: cos 42°, -sin 42°; and from the back of the hand to the palm.
pub const ARM: [f64; 3] = [0.7431, -0.6691, 0.0];
pub const PALM: [f64; 3] = [-0.6691, -0.7431, 0.0];

pub const HEAD: Influence = &[("Head", 0.0, 0.01)];
pub const CHEST: Influence = &[("Spine2", 0.0, 0.01)];

/// `rows` drawn about the origin, `scale` times as large, around `at`.
pub const fn placed<const N: usize>(mut rows: [Part; N], at: [f64; 3], scale: f64) -> [Part; N] {
    let mut i = 0;
    while i < N {
        let Part { start: [x, y, z], size: [wide, deep, long], blend, edge, .. } = rows[i];
        rows[i] = Part {
            start: [at[0] + scale * x, at[1] + scale * y, at[2] + scale * z],
            size: [scale * wide, scale * deep, scale * long],
            blend: scale * blend,
            edge: scale * edge,
            ..rows[i]
        };
        i += 1;
    }
    rows
}

/// The rows of all `lists`, `N` together.
pub const fn all<const N: usize>(lists: &[&[Part]]) -> [Part; N] {
    let mut rows = [PART; N];
    let (mut found, mut list) = (0, 0);
    while list < lists.len() {
        let mut i = 0;
        while i < lists[list].len() {
            rows[found] = lists[list][i];
            (found, i) = (found + 1, i + 1);
        }
        list += 1;
    }
    assert!(found == N, "N is not the number of rows");
    rows
}
