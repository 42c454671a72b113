//! What can be mended is mended before anything is refused: faces, winding, small holes, cloth inside the body or
//! through itself. Each mend is said with counts and places. A sound garment comes back bit by bit as it was.
//! simulation.md §4.3.

mod faces;
mod holes;
mod lift;
mod patch;
mod plugs;
mod slivers;
#[cfg(test)]
mod test;

pub(super) use lift::place;
pub(super) use plugs::open;

use super::check::list;
use ctsn_rig::Garment;
use ctsn_rig::gltf::Source;
use patch::Patch;

/// A garment with sound faces, how its file numbers its vertices, and what was mended.
pub(super) fn mend(garment: Garment, source: Source) -> (Garment, Source, Vec<String>) {
    let mut patch = Patch::new(&garment, &source);
    let mut said = Vec::new();
    faces::remove_copies(&mut patch, &mut said);
    faces::split(&mut patch, &mut said);
    slivers::mend(&mut patch, &mut said);
    faces::split(&mut patch, &mut said);
    faces::wind(&mut patch, &mut said);
    holes::fill(&mut patch, &mut said);
    if said.is_empty() {
        return (garment, source, said);
    }
    let (garment, numbers) = patch.finish(&garment);
    (garment, Source { numbers, ..source }, said)
}

/// "3 faces …, at vertices 1-2-3, …"
fn at(what: &str, places: Vec<String>) -> String {
    format!("{} {what}: {}", places.len(), list(places.into_iter()))
}
