//! The project's own characters, built from tables: smooth union of lofts -> even mesh -> skin weights -> motion.
//! simulation.md §4.1.

mod andy;
mod anna;
mod cat;
mod colour;
mod dolphin;
mod face;
mod figure;
mod fox;
mod hand;
mod loft;
mod mannequin;
mod monster;
mod paw;
mod person;
mod prop;
mod qman;
mod remesh;
mod shoe;
mod surface;
mod weights;

pub use figure::{BALL, BOX, Figure, JointRow, PART, Part};
pub use loft::Role;

use crate::motion;
use crate::{Error, Result};
use ctsn_rig::{Character, SkinnedMesh, Surface};
use glam::DVec3;
use loft::Loft;

/// Every character this module can build, by name.
const FIGURES: &[(&str, Figure)] = &[
    ("mannequin", mannequin::MANNEQUIN),
    ("andy", andy::ANDY),
    ("anna", anna::ANNA),
    ("qman", qman::QMAN),
    ("monster", monster::MONSTER),
    ("cat", cat::CAT),
    ("dolphin", dolphin::DOLPHIN),
    ("fox", fox::FOX),
    ("sphere", prop::SPHERE),
    ("box", prop::BOX),
];

/// The names, for help and errors.
pub fn names() -> String {
    FIGURES.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

/// The character of that name, with the project's clips.
pub fn character(name: &str) -> Result<Character> {
    let found = FIGURES.iter().find(|(known, _)| *known == name);
    let (_, figure) = found.ok_or_else(|| Error::Character(format!("wanted one of {}, found {name:?}", names())))?;
    let mut character = build(figure);
    character.clips = motion::clips(&character, motion::RATE)?;
    Ok(character)
}

/// A figure's body, skeleton and skin weights in the canonical pose, without motion.
pub fn build(figure: &Figure) -> Character {
    let joints = figure.skeleton();
    let lofts = figure.lofts(&joints);
    let mut character = Character {
        joints,
        root: 0,
        body: SkinnedMesh::default(),
        surface: Surface::default(),
        clips: vec![],
        metres_per_unit: 1.0,
        parts: Default::default(),
    };
    for shell in 0..=lofts.iter().map(|loft| loft.shell).max().unwrap_or(0) {
        let own: Vec<Loft> = lofts.iter().filter(|loft| loft.shell == shell).cloned().collect();
        let finest = own.iter().map(|loft| loft.edge).fold(f64::INFINITY, f64::min);
        if !own.is_empty() {
            add_shell(&mut character, &own, if shell == 0 { figure.cell } else { finest / 2.0 });
        }
    }
    character
}

/// Adds the closed mesh of one shell, made of `lofts` on a grid of spacing `cell` metres.
fn add_shell(character: &mut Character, lofts: &[Loft], cell: f64) {
    let edge = |p: DVec3| edge_length(lofts, p);
    let project = |p: DVec3| loft::project(lofts, p);
    let mut mesh = remesh::remesh(surface::extract(lofts, cell), &edge, &project, 8);
    colour::align(&mut mesh, lofts, project);
    let first = character.body.mesh.positions.len() as u32;
    colour::draw(&mut character.surface, &mesh, lofts, first);
    let weights = weights::weights(&mesh, lofts, character.joints.len());
    character.body.extend(SkinnedMesh { mesh, weights });
}

/// Wanted edge length at `p`, metres: a mean over the lofts around it that fades with their distance.
fn edge_length(lofts: &[Loft], p: DVec3) -> f64 {
    let share = |loft: &Loft| (loft.edge, (-loft.distance(p).max(0.0) / 0.01).exp());
    let (sum, weight) = lofts
        .iter()
        .filter(|loft| loft.role != Role::Paint && loft.near(p))
        .map(share)
        .fold((0.0, 1e-12), |(s, w), (edge, k)| (s + edge * k, w + k));
    if weight > 1e-9 { sum / weight } else { 0.02 }
}

#[cfg(test)]
mod animal_tests;
#[cfg(test)]
pub(crate) mod tests;
