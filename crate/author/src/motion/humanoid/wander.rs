//! Seeded random postures within joint limits, joined smoothly: what a network should see between the authored moves.

use super::moves::STAND;
use super::posture::Posture;

/// Seconds until it repeats.
pub const PERIOD: f64 = 8.0;
/// Key postures per period.
const KEYS: usize = 8;

/// Bounds of the random postures, as (least, most); arms and feet for either side.
const LEAST: Posture = Posture {
    heading: -20.0,
    hips: [-0.05, -0.14, -0.04],
    tilt: [-6.0, -16.0, -6.0],
    spine: [-12.0, -26.0, -20.0],
    head: [-14.0, -35.0, -12.0],
    arms: [[26.0, -20.0, -10.0, 10.0, -10.0]; 2],
    feet: [[0.01, 0.0, -0.07, 2.0, 0.0]; 2],
};
const MOST: Posture = Posture {
    heading: 20.0,
    hips: [0.05, -0.02, 0.04],
    tilt: [12.0, 16.0, 6.0],
    spine: [26.0, 26.0, 20.0],
    head: [20.0, 35.0, 12.0],
    arms: [[135.0, 60.0, 50.0, 85.0, 20.0]; 2],
    feet: [[0.09, 0.0, 0.07, 20.0, 8.0]; 2],
};

/// Key postures of one seed. Every other one is drawn halfway to standing, as people return between gestures.
pub fn keys(seed: u64) -> Vec<(f64, Posture)> {
    let state = std::cell::Cell::new(seed);
    let draw = |least: f64, most: f64| least + (most - least) * uniform(&state);
    let key = |i: usize| {
        let random = LEAST.zip(&MOST, draw);
        let posture = if i.is_multiple_of(2) { random } else { random.blend(&STAND, 0.5) };
        (PERIOD * i as f64 / KEYS as f64, posture)
    };
    (0..KEYS).map(key).collect()
}

/// SplitMix64 (Steele, Lea & Flood 2014), in [0, 1).
fn uniform(state: &std::cell::Cell<u64>) -> f64 {
    state.set(state.get().wrapping_add(0x9E37_79B9_7F4A_7C15));
    let mut z = state.get();
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}
