//! A model's file made small. Every tensor is kept as coarsely as the cloth bears: tried one by one over poses.

mod trial;
mod truth;

use anyhow::Result;
use ctsn_core::file::{Tensor, Tensors};
use ctsn_core::model::pack::{MOST_LEVELS, narrow, packable, quantise};
use ctsn_core::model::{MESH_BASIS, SKELETON_BASIS};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
pub use trial::{Difference, Trial};
pub use truth::truth;

/// What packing may change: mean distance of a vertex in metres, mean angle of a normal in degrees.
pub const BOUND: (f64, f64) = (1e-4, 0.1);
/// The share of it that each basis may take, and each other tensor. Errors of different tensors have nothing to do with
/// one another: their squares add up, to less than one.
const SHARES: [(&str, f64); 2] = [(SKELETON_BASIS, 0.65), (MESH_BASIS, 0.45)];
const SHARE: f64 = 0.11;
/// What is left of the shares when more is not tried: the rest is the file's, not ours.
const LEAST_PART: f64 = 0.3;
/// Trials go from 7 bits and a sign in steps of half a bit.
const FEWEST_LEVELS: f64 = 127.0;
const HALF_BITS: u32 = 16;

/// One tensor, packed.
pub struct Packed {
    pub name: String,
    /// Levels on either side of zero.
    pub levels: u32,
    /// What this tensor alone changes.
    pub difference: Difference,
}

/// A whole model, packed.
pub struct Small {
    pub file: Tensors<'static>,
    pub list: Vec<Packed>,
    /// What all of it changes, in the poses of the judge.
    pub difference: Difference,
}

/// Packs a model's tensors, so that in the poses of `judge` it predicts what the model does within [`BOUND`]. Where
/// together they change more, each gets less.
pub fn pack(file: &Tensors<'static>, [trial, judge]: [&Trial; 2], mut tell: impl FnMut(&str)) -> Result<Small> {
    let (mut part, mut tried) = (1.0, Tried::new());
    loop {
        let (mut small, mut list) = (file.clone(), Vec::new());
        for name in packable(file) {
            tell(&name);
            let packed = choose(file, &name, trial, part, &mut tried)?;
            quantise(&mut small, &name, packed.levels, importance(&name, trial))?;
            list.push(packed);
        }
        narrow(&mut small);
        let difference = judge.difference(&small)?;
        if difference.within(1.0) || part < LEAST_PART {
            return Ok(Small { file: small, list, difference });
        }
        part *= 0.9;
    }
}

/// What an error in each row of a tensor counts: in a basis, as much as the matrix is multiplied by.
fn importance<'a>(name: &str, trial: &'a Trial) -> Option<&'a [f32]> {
    let at = [SKELETON_BASIS, MESH_BASIS].iter().position(|basis| *basis == name)?;
    Some(&trial.coefficients[at])
}

/// What tensors alone change at levels that were tried already: a smaller part tries many of them again.
type Tried = BTreeMap<(String, u32), Difference>;

/// The fewest levels by which a tensor alone keeps to its share, by halving.
fn choose(file: &Tensors<'static>, name: &str, trial: &Trial, part: f64, tried: &mut Tried) -> Result<Packed> {
    let share = part * SHARES.iter().find(|(basis, _)| *basis == name).map_or(SHARE, |(_, share)| *share);
    let levels = |half_bits: u32| ((FEWEST_LEVELS * (0.5 * f64::from(half_bits)).exp2()) as u32).min(MOST_LEVELS);
    let mut attempt = |levels: u32| -> Result<Packed> {
        let difference = match tried.entry((name.to_owned(), levels)) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(new) => {
                let mut one = file.clone();
                quantise(&mut one, name, levels, importance(name, trial))?;
                *new.insert(trial.difference(&one)?)
            }
        };
        Ok(Packed { name: name.to_owned(), levels, difference })
    };
    // What is drawn alone does not show in a prediction.
    if name.starts_with("draw.") {
        return attempt(MOST_LEVELS);
    }
    let (mut low, mut high, mut best) = (0, HALF_BITS, None);
    while low < high {
        let middle = (low + high) / 2;
        let packed = attempt(levels(middle))?;
        if packed.difference.within(share) {
            (high, best) = (middle, Some(packed));
        } else {
            low = middle + 1;
        }
    }
    match best {
        Some(best) => Ok(best),
        None => attempt(levels(HALF_BITS)),
    }
}

/// Bytes of a tensor and of what belongs to it: its scales, its low bytes.
pub fn bytes(file: &Tensors, name: &str) -> Vec<u8> {
    let parts = ["", ".scale", ".fine"].iter().filter_map(|suffix| file.tensors.get(&format!("{name}{suffix}")));
    parts.flat_map(|tensor: &Tensor| tensor.bytes.iter().copied()).collect()
}
