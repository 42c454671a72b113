//! Φ in parts: one for every limb, which hears that limb and the trunk, and one that hears all joints. Each is a small
//! MLP of its own; together they are the MLP of network.md §2, whose weights between parts are zero and stay so. What
//! arms and legs do together in the clips would otherwise be taken for a law.

use super::initial::linear;
use ctsn_core::model::Linear;
use ctsn_rig::limbs;

/// Hidden layers of Φ where there are no limbs.
const ALONE: [usize; 2] = [128, 64];
/// Hidden layers of each of several parts. Validation errors of the skeleton stream alone, m = 32, 30 epochs, for one
/// MLP (means of three seeds) and for parts (two seeds): robe 18.2; 16.8, 16.6 mm; cape 15.6; 15.7, 14.7; T-shirt 8.1;
/// 8.0, 7.4. With m = 64: robe 16.1, 17.8, cape 14.3, 15.0, T-shirt 7.9, 7.8. Tried, in shorter trainings: as many
/// parts that all hear all (robe 17.4, 17.1, where these gave 16.8, 16.9), limbs that carry the same cloth heard
/// together (nearly all end up together), pairs of limbs (no better, three times as many), 128 and 64 hidden units a
/// part (16.0, 16.3, but three times as large).
const HIDDEN: [usize; 2] = [64, 32];
/// Most limbs with a part of their own, those that carry most cloth: the layers of Φ grow with its square.
const LIMBS: usize = 8;

/// Which joints each part of Φ hears, the whole last. `carried` is the cloth that each joint carries, `heard` whether
/// it is heard at all; joints without `parents` have no limbs.
pub fn parts(parents: &[Option<usize>], carried: &[f64], heard: &[bool]) -> Vec<Vec<bool>> {
    let joints = heard.len();
    // Cloth carried by what hangs from each joint: parents stand before their children.
    let (mut below, mut hears) = (carried.to_vec(), heard.to_vec());
    for (joint, parent) in parents.iter().enumerate().rev() {
        if let Some(parent) = *parent {
            below[parent] += below[joint];
            hears[parent] |= hears[joint];
        }
    }
    let root = limbs(parents, |joint| hears[joint]);
    // The limb each joint belongs to, the innermost where limbs hang from limbs; those are trunk.
    let mut limb: Vec<Option<usize>> = vec![None; joints];
    let mut trunk = vec![false; joints];
    for (joint, parent) in parents.iter().enumerate() {
        let above = parent.and_then(|parent| limb[parent]);
        limb[joint] = if root[joint] { Some(joint) } else { above };
        if root[joint] {
            above.into_iter().for_each(|above| trunk[above] = true);
        }
    }
    let mut ends: Vec<usize> = (0..parents.len()).filter(|joint| root[*joint] && !trunk[*joint]).collect();
    ends.sort_by(|a, b| below[*b].total_cmp(&below[*a]));
    let of = |joint: usize| limb[joint].filter(|limb| ends.contains(limb));
    let hears =
        |part: usize| (0..joints).map(|joint| heard[joint] && of(joint).is_none_or(|limb| limb == part)).collect();
    let mut parts: Vec<Vec<bool>> = ends.iter().take(LIMBS).map(|limb| hears(*limb)).collect();
    parts.push(heard.to_vec());
    parts
}

/// Φ [12J] -> [m] of `parts`, seeded. `m` is dealt evenly; where it is too small for every part to have two, the whole
/// has it all.
pub fn embedding(parts: &[Vec<bool>], m: usize, rng: &mut fastrand::Rng) -> Vec<Linear<Vec<f32>>> {
    let parts = if m < 2 * parts.len() { &parts[parts.len() - 1..] } else { parts };
    let count = parts.len();
    let [first, second] = if count == 1 { ALONE } else { HIDDEN };
    let widths = |part: usize| [first, second, m * (part + 1) / count - m * part / count];
    let inputs = 12 * parts[0].len();
    let mut layers: Vec<Linear<Vec<f32>>> = Vec::new();
    for depth in 0..3 {
        let outputs = (0..count).map(|part| widths(part)[depth]).sum();
        let before = layers.last().map_or(inputs, |layer| layer.outputs);
        let mut whole = Linear { weight: vec![0.0; before * outputs], bias: Vec::new(), inputs: before, outputs };
        let (mut row, mut column) = (0, 0);
        for (part, hears) in parts.iter().enumerate() {
            let mut own = linear(if depth == 0 { inputs } else { widths(part)[depth - 1] }, widths(part)[depth], rng);
            if depth == 0 {
                let unheard = own.weight.chunks_exact_mut(12 * own.outputs).zip(hears).filter(|(_, hears)| !**hears);
                unheard.for_each(|(weights, _)| weights.fill(0.0));
            }
            for (i, weights) in own.weight.chunks_exact(own.outputs).enumerate() {
                let at = (row + i) * outputs + column;
                whole.weight[at..at + own.outputs].copy_from_slice(weights);
            }
            whole.bias.extend(own.bias);
            row += if depth == 0 { 0 } else { own.inputs };
            column += own.outputs;
        }
        layers.push(whole);
    }
    layers
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hips, legs of two joints, a spine with a head and arms of two joints; the head carries no cloth, the left arm
    /// the most.
    const PARENTS: [Option<usize>; 11] =
        [None, Some(0), Some(1), Some(0), Some(3), Some(0), Some(5), Some(5), Some(7), Some(5), Some(9)];

    fn scene() -> (Vec<f64>, Vec<bool>) {
        let carried = vec![9.0, 1.0, 1.0, 1.0, 0.5, 9.0, 0.0, 3.0, 3.0, 2.0, 2.0];
        let heard = carried.iter().map(|carried| *carried > 0.0).collect();
        (carried, heard)
    }

    fn listed(part: &[bool]) -> Vec<usize> {
        (0..part.len()).filter(|joint| part[*joint]).collect()
    }

    #[test]
    fn a_part_hears_its_limb_and_the_trunk() {
        let (carried, heard) = scene();
        let found: Vec<Vec<usize>> = parts(&PARENTS, &carried, &heard).iter().map(|part| listed(part)).collect();
        let whole = vec![0, 1, 2, 3, 4, 5, 7, 8, 9, 10];
        assert_eq!(found, [vec![0, 5, 7, 8], vec![0, 5, 9, 10], vec![0, 1, 2, 5], vec![0, 3, 4, 5], whole.clone()]);
        assert_eq!(parts(&[], &carried, &heard).iter().map(|part| listed(part)).collect::<Vec<_>>(), [whole]);
    }

    #[test]
    fn parts_do_not_hear_each_other() {
        let (carried, heard) = scene();
        let parts = parts(&PARENTS, &carried, &heard);
        let phi = embedding(&parts, 13, &mut fastrand::Rng::with_seed(1));
        let outputs = |pose: &[f32]| {
            phi.iter().fold(pose.to_vec(), |x, layer| {
                let mut y = layer.bias.clone();
                for (x, weights) in x.iter().zip(layer.weight.chunks_exact(layer.outputs)) {
                    y.iter_mut().zip(weights).for_each(|(y, weight)| *y += x * weight);
                }
                if layer.outputs == 13 { y } else { y.iter().map(|y| y.max(0.0)).collect() }
            })
        };
        let rest = outputs(&[0.1; 132]);
        // 13 among five parts.
        let ranges = [0..2, 2..5, 5..7, 7..10, 10..13];
        for joint in 0..11 {
            let mut pose = [0.1; 132];
            pose[12 * joint..12 * joint + 12].fill(3.0);
            let moved = outputs(&pose);
            for (part, range) in parts.iter().zip(&ranges) {
                let same = moved[range.clone()] == rest[range.clone()];
                assert_eq!(same, !part[joint], "joint {joint}, embedding {range:?}");
            }
        }
        let few = embedding(&parts, 9, &mut fastrand::Rng::with_seed(1));
        assert_eq!(few.iter().map(|layer| layer.outputs).collect::<Vec<_>>(), [128, 64, 9]);
    }
}
