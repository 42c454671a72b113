//! What is wrong with a garment somebody made, found before hours are spent on simulating it: with the file's vertex
//! numbers. Errors stop every command that wants the garment; warnings are said and the work goes on.

mod fit;
#[cfg(test)]
mod test;
mod topology;

use crate::{Error, Result};
use ctsn_rig::gltf::{Source, read_garment};
use ctsn_rig::{Character, Garment};
use std::path::Path;

/// What a check found. One sentence each, with vertex numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings {
    /// Faults with which a garment cannot be simulated.
    pub errors: Vec<String>,
    /// Faults that may be meant.
    pub warnings: Vec<String>,
}

/// Checks a garment modelled on the character's canonical pose. `source`: how its file numbers its vertices.
pub fn check(character: &Character, garment: &Garment, source: &Source) -> Result<Findings> {
    let mut findings = Findings::default();
    topology::check(&garment.mesh, source, &mut findings);
    fit::check(character, garment, source, &mut findings)?;
    Ok(findings)
}

/// Reads a garment and checks it. -> the garment and warnings; what makes it unusable is an error.
pub fn load(path: &Path, character: &Character) -> Result<(Garment, Vec<String>)> {
    let (garment, source) = read_garment(path, character.metres_per_unit)?;
    let Findings { errors, warnings } = check(character, &garment, &source)?;
    match errors.is_empty() {
        true => Ok((garment, warnings)),
        false => Err(Error::File { path: path.into(), reason: errors.join("\n  ") }),
    }
}

/// The first few of a list, and how many there are.
fn list(items: impl Iterator<Item = String>) -> String {
    const SHOWN: usize = 6;
    let items: Vec<String> = items.collect();
    let shown = items[..items.len().min(SHOWN)].join(", ");
    if items.len() > SHOWN { format!("{shown}, … ({} in all)", items.len()) } else { shown }
}
