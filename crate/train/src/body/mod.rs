//! The body a model carries for the repair of penetration: the character's outer skin, as much of it as the cloth comes
//! near, and for every cloth vertex the places where it was seen. docs/decisions/repair.md.

mod cut;
mod seeds;
mod seen;
mod tear;
#[cfg(test)]
mod tests;

use crate::Result;
use crate::dataset::{Sample, Setup};
use ctsn_cloth::simulate::{covering, felt, fitted, outer_skin};
use ctsn_cloth::wrap::apart;
use ctsn_core::cpu::repair::closest::GAP;
use ctsn_core::model::Body;
use ctsn_core::topology::Graph;
use ctsn_rig::path::to_body_frame;
use ctsn_rig::{Character, pose, vertices};
use cut::cut;
use glam::DAffine3;
use rayon::prelude::*;
use seeds::{SEEDS, add_other_side, missed, spread};
use seen::{kept, nearest};
use std::collections::BTreeMap;
use tear::tear;

/// Vertices of the whole skin, about: twice as many triangles.
const VERTICES: usize = 2600;
/// Poses looked at, spread over the samples. With 200 of 2,093 a robe's deepest unseen vertex stayed 20.6 mm inside,
/// with 600 and with all of them 8.7 mm.
const POSES: usize = 600;
/// Poses that the skin is raised for, spread over the samples.
const BENT: usize = 60;
/// Poses whose cloth the skin is fitted to, spread over the samples.
const WORN: usize = 150;

/// The body for the cloth of `setup`, as `samples` wear it. It is fitted to those whose cloth was simulated finely,
/// `fine`: coarse cloth, and what nobody simulated, may lie in it where it should not.
pub fn body(setup: &Setup, samples: &[&Sample], fine: &[&Sample]) -> Result<Body<Vec<f32>, Vec<u32>>> {
    let character = setup.character()?;
    // What the simulated cloth did not feel is in its way nowhere: a figure's hands sank into its skirt, and trembled
    // there.
    let felt = felt(&character, &setup.cloth())?;
    let every = |count: usize| some(samples, count);
    let bent: Vec<_> = every(BENT).map(|sample| skinning(&character, sample)).collect();
    let skin = outer_skin(&character, &apart(&character), VERTICES)?;
    let skin = covering(skin, &character, &bent).part(|joint| felt[joint]);
    let worn = |sample: &&Sample| (skinning(&character, sample), vertices(&sample.truth));
    let mut skin = fitted(skin, f64::from(GAP), &some(fine, WORN).map(worn).collect::<Vec<_>>());
    let poses: Vec<&&Sample> = every(POSES).collect();
    tear(&mut skin, &character, &poses);
    let nearest = |sample: &&&Sample| nearest(&skin, &character, sample);
    let seen: Vec<Vec<Option<u32>>> = poses.par_iter().map(nearest).collect::<Result<_>>()?;
    let mut visits = vec![BTreeMap::new(); setup.template.len() / 3];
    for (vertex, place) in seen.iter().flat_map(|seen| seen.iter().enumerate()) {
        place.iter().for_each(|place| *visits[vertex].entry(*place).or_insert(0) += 1);
    }
    let mut seeds: Vec<[u32; SEEDS]> = visits.iter().map(|visits| spread(&skin.mesh.positions, visits)).collect();
    let around = skin.mesh.rings();
    let missed = |(sample, seen): (&&&Sample, &Vec<_>)| {
        missed(&skin.pose(&skinning(&character, sample)), &around, &seeds, &vertices(&sample.truth), seen)
    };
    let missed: Vec<Vec<Option<u32>>> = poses.par_iter().zip(&seen).map(missed).collect();
    add_other_side(&mut seeds, &missed, &Graph::new(setup.template.len() / 3, &setup.triangles));
    let kept = kept(&skin, &visits, &seeds);
    skin.mesh.triangles.retain(|triangle| triangle.iter().all(|i| kept[*i as usize]));
    Ok(cut(&skin, &kept, &seeds))
}

/// At most so many of them, spread over them all.
fn some<'a, 'b>(of: &'a [&'b Sample], count: usize) -> impl Iterator<Item = &'a &'b Sample> {
    of.iter().step_by(of.len().div_ceil(count).max(1))
}

/// `N·A_j` per joint in the pose of a sample: to its body frame.
fn skinning(character: &Character, sample: &Sample) -> Vec<DAffine3> {
    character.skinning(&to_body_frame(character, &pose(&sample.joints)))
}
