//! Cloth that passes through itself, as predicted cloth may, made fit to start from: where triangles cross, umbrella
//! smoothing takes the folds away until none do.

use glam::DVec3;

use super::neighbourhood::Elements;
use ctsn_core::topology::Graph;

/// Rounds after which it is given up. Of 328 robes predicted by a weak network, one in eight crossed, none after ten.
const ROUNDS: usize = 60;
/// Rounds after which what is smoothed grows by one ring of neighbours more.
const WIDER: usize = 6;
/// Steps of smoothing in a round.
const STEPS: usize = 3;

/// Smooths `x` [n] where triangles cross, until none do; whether none do.
pub(crate) fn untangle(elements: &Elements, rings: &Graph<Vec<u32>>, x: &mut [DVec3]) -> bool {
    for round in 0..ROUNDS {
        let crossings = elements.crossings(x);
        if crossings.is_empty() {
            return true;
        }
        let mut marked = vec![false; x.len()];
        for triangle in crossings.iter().flatten() {
            elements.triangles[*triangle as usize].iter().for_each(|i| marked[*i as usize] = true);
        }
        for _ in 0..=round / WIDER {
            let near: Vec<u32> = marked_indices(&marked).flat_map(|i| rings.of(i).iter().copied()).collect();
            near.iter().for_each(|i| marked[*i as usize] = true);
        }
        for _ in 0..STEPS {
            let before = x.to_vec();
            for i in marked_indices(&marked).filter(|i| !rings.of(*i).is_empty()) {
                let ring = rings.of(i);
                let mean = ring.iter().map(|j| before[*j as usize]).sum::<DVec3>() / ring.len() as f64;
                x[i] = 0.5 * (before[i] + mean);
            }
        }
    }
    elements.crossings(x).is_empty()
}

fn marked_indices(marked: &[bool]) -> impl Iterator<Item = usize> {
    marked.iter().enumerate().filter(|(_, marked)| **marked).map(|(i, _)| i)
}
