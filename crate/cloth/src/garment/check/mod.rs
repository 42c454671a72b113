//! What is wrong with a garment somebody made, found before hours are spent on simulating it: with the file's vertex
//! numbers. Errors stop every command that wants the garment; warnings are said and the work goes on.

mod fit;
mod sketch;
#[cfg(test)]
mod test;
mod topology;

pub use sketch::{Fault, sketch};

pub(super) use fit::{INWARDS, Outside, Place, inside, inwards, mistaken};
pub(super) use topology::{HOLE_EDGES, HOLE_SHARE, SLIVER};

use super::resampling::{Resample, resample};
use super::{hold, mend};
use crate::simulate::{Elements, Material, Settings, Simulator};
use crate::wrap::{bones, complete};
use crate::{Error, Result};
use ctsn_rig::gltf::{Source, read_garment};
use ctsn_rig::{Character, Garment};
use std::collections::BTreeSet;
use std::path::Path;

/// What a check found. One sentence each, with vertex numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings {
    /// Faults with which a garment cannot be simulated.
    pub errors: Vec<String>,
    /// Faults that may be meant.
    pub warnings: Vec<String>,
}

/// A garment fit to be simulated, and what there is to say of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// As it is simulated: mended, with what holds it.
    pub garment: Garment,
    /// What was mended and what was found to hold it, one sentence each, with the file's vertex numbers.
    pub mended: Vec<String>,
    /// Faults that may be meant.
    pub warnings: Vec<String>,
}

/// Checks a garment modelled on the character's canonical pose. `source`: how its file numbers its vertices.
pub fn check(character: &Character, garment: &Garment, source: &Source) -> Result<Findings> {
    Ok(check_beside(&Outside::new(character)?, garment, source))
}

/// The same beside a body whose outer skin is known.
fn check_beside(outside: &Outside, garment: &Garment, source: &Source) -> Findings {
    let mut findings = Findings::default();
    topology::check(garment, source, &mut findings);
    fit::check(outside, garment, source, &mut findings);
    crossings(garment, source, &mut findings);
    findings
}

/// Faces through one another: those of two vertices in common are counted by what folds there.
fn crossings(garment: &Garment, source: &Source, findings: &mut Findings) {
    let mesh = &garment.mesh;
    let pairs = Elements::new(&mesh.triangles, mesh.positions.len()).crossings(&mesh.positions);
    if !pairs.is_empty() {
        let first = |[face, _]: &[u32; 2]| source.numbers[mesh.triangles[*face as usize][0] as usize].to_string();
        let near = list(pairs.iter().map(first));
        findings
            .errors
            .push(format!("cloth through cloth: {} pairs of faces cross, near vertices {near}", pairs.len()));
    }
}

/// Opens and mends a garment, adds to the body what is missing under it, makes the mesh to simulate where `wanted`,
/// finds what holds the garment, and checks it. What makes it unusable is an error, which names all that does.
///
/// Whatever simulates a garment takes it and the body from here, so that what this accepts is what is simulated.
pub fn fit(character: &mut Character, garment: Garment, source: Source, wanted: Resample) -> Result<Fitted> {
    let mut mended = Vec::new();
    let (garment, source) = mend::open(character, &bones(character), garment, source, &mut mended);
    mended.extend(complete(character, &garment.mesh));
    fit_beside(&Outside::new(character)?, garment, source, wanted, mended)
}

/// The same beside a body that is whole and whose outer skin is known; `mended`: what was already.
pub(super) fn fit_beside(
    outside: &Outside,
    garment: Garment,
    source: Source,
    wanted: Resample,
    mut mended: Vec<String>,
) -> Result<Fitted> {
    let (garment, source, faces) = mend::mend(garment, source);
    mended.extend(faces);
    let (mut garment, source) = resample(outside, garment, source, wanted, &mut mended);
    let mut findings = Findings::default();
    mend::place(outside, &mut garment, &source, &mut mended, &mut findings);
    // What is lifted or smoothed may leave a sliver where cloth was folded.
    let (mut garment, source, again) = mend::mend(garment, source);
    mended.extend(again);
    if findings.errors.is_empty() {
        hold::hold(outside, &mut garment, &source, &mut mended, &mut findings);
        let Findings { errors, warnings } = check_beside(outside, &garment, &source);
        findings.errors.extend(errors);
        findings.warnings.extend(warnings);
    }
    let Findings { errors, warnings } = findings;
    match errors.is_empty() {
        true => Ok(Fitted { garment, mended, warnings }),
        false => {
            let said = mended.iter().map(|mend| format!("\n  mended: {mend}"));
            Err(Error::Garment(errors.join("\n  ") + &said.collect::<String>()))
        }
    }
}

/// Reads a garment and fits it; the character's body is completed under it.
pub fn load(path: &Path, character: &mut Character, wanted: Resample) -> Result<Fitted> {
    let (garment, source) = read_garment(path, character.metres_per_unit)?;
    fit(character, garment, source, wanted).map_err(|error| match error {
        Error::Garment(reason) => Error::File { path: path.into(), reason },
        other => other,
    })
}

/// Hangs a fitted garment, with which every simulation begins. -> how far its vertices move until it rests, metres, at
/// most. `pinched`: as of [`Settings`].
pub fn rehearse(character: &Character, garment: &Garment, pinched: f64) -> Result<f64> {
    let settings = Settings { attached: garment.pins.clone(), pinched, ..Settings::default() };
    let rest = Simulator::new(character, garment, Material::default(), settings)?.drape()?;
    let moved = rest.iter().zip(&garment.mesh.positions).map(|(now, then)| now.distance(*then));
    Ok(moved.fold(0.0, f64::max))
}

/// The first few of a list, each once, and how many there are: several vertices of an even mesh stand for one of the
/// file's.
pub(super) fn list(items: impl Iterator<Item = String>) -> String {
    const SHOWN: usize = 6;
    let mut seen = BTreeSet::new();
    let items: Vec<String> = items.filter(|item| seen.insert(item.clone())).collect();
    let shown = items[..items.len().min(SHOWN)].join(", ");
    if items.len() > SHOWN { format!("{shown}, … ({} in all)", items.len()) } else { shown }
}
