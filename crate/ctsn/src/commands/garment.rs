//! `ctsn garment`: a garment for any character.

use super::file_name;
use super::simulate::{PINCHED, add_body};
use crate::pages;
use anyhow::{Context, Result};
use ctsn_cloth::garment::{Cut, Resample, Rest, default_kind, drape, load, rehearse, shell, sketch};
use ctsn_rig::{Garment, file, gltf};
use std::path::{Path, PathBuf};

/// Make a garment for any rigged character, or check one of your own
///
/// The garment is cut from a shell of the body, evenly meshed, and hung on the canonical pose. Fractions run along a
/// limb, from where it leaves the trunk (0) to its tip (1); the tip of a leg is the ankle. Waistbands and collars are
/// pinned to the body: the vertex attribute _PIN (scalar, 1 = pinned) marks their vertices. A garment of your own may
/// have it too.
///
/// --check reads a garment of your own, mends what can be mended and says so: slivers, duplicated faces, crowded edges,
/// faces that look the other way, small holes, cloth inside the body or through itself; a waistband that nobody pinned
/// is found. What cannot be mended it says with the file's vertex numbers: scale, place, a garment that would fall.
/// Then it hangs the garment, as every simulation begins. `simulate` and `bake` do the same with it; the file stays as
/// it is.
#[derive(clap::Args)]
pub struct Arguments {
    /// Rigged character (glTF)
    character: PathBuf,
    /// Where to write the garment (GLB)
    #[arg(short, long, required_unless_present = "check")]
    output: Option<PathBuf>,
    /// Check this garment instead (glTF)
    #[arg(long, conflicts_with_all = ["output", "Cut"])]
    check: Option<PathBuf>,
    /// With --check, write what was found as a page with pictures: the garment on the body, faults in colour (HTML)
    #[arg(long, value_name = "FILE", requires = "check")]
    html: Option<PathBuf>,
    /// With --check, take the body of this file (glTF) where the character's own skin is missing
    #[arg(long, value_name = "OTHER", requires = "check")]
    body: Option<PathBuf>,
    /// The mesh that --check simulates, as of `simulate`: auto, never, or the length of an edge in mm
    #[arg(long, value_name = "WHEN", default_value_t = Resample::Auto, requires = "check")]
    resample: Resample,
    #[command(flatten)]
    cut: Cut,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    if let Some(garment) = &arguments.check {
        return check(arguments, garment);
    }
    arguments.output.as_ref().map_or(Ok(()), |output| make(&arguments.character, &arguments.cut, output))
}

/// Says what is wrong with a garment and what of it is mended; fails on what makes it unusable.
fn check(arguments: &Arguments, path: &Path) -> Result<()> {
    let mut character = gltf::read_character(&arguments.character, 1.0)?;
    arguments.body.as_deref().map_or(Ok(()), |other| add_body(&mut character, other))?;
    let bare = character.clone();
    let found = load(path, &mut character, arguments.resample);
    let hung = found.and_then(|fitted| {
        let moved = rehearse(&character, &fitted.garment, PINCHED)?;
        Ok((fitted, moved))
    });
    if let Some(page) = &arguments.html {
        let names = [path, &arguments.character].map(file_name);
        let text = pages::check::page(names, &bare, &character, &sketch(path, &bare)?, &hung)?;
        file::write(page, text.as_bytes())?;
    }
    let (fitted, moved) = hung.with_context(|| path.display().to_string())?;
    fitted.mended.iter().for_each(|mend| println!("mended: {mend}"));
    fitted.warnings.iter().for_each(|warning| println!("{warning}"));
    let Garment { mesh, pins, .. } = &fitted.garment;
    println!(
        "{}: {} vertices, {} pins; fit to be simulated, {} mended, {} warnings; hung, it moves by up to {:.0} mm",
        path.display(),
        mesh.positions.len(),
        pins.len(),
        fitted.mended.len(),
        fitted.warnings.len(),
        1e3 * moved
    );
    Ok(())
}

/// Cuts a garment for the character, hangs it and writes it.
pub fn make(character: &Path, cut: &Cut, output: &Path) -> Result<()> {
    // Any rate will do: a garment is cut on the canonical pose.
    let character = gltf::read_character(character, 1.0)?;
    let kind = cut.kind.map_or_else(|| default_kind(&character), Ok)?;
    let cloth = shell(&character, &Cut { kind: Some(kind), ..cut.clone() })?;
    eprintln!("{}: cut, {} vertices; hanging it", kind.name(), cloth.mesh.positions.len());
    let Rest { mut garment, moved, strain } = drape(&character, &cloth)?;
    // In the units of the character's file, so that the two belong together in any tool.
    garment.mesh.positions.iter_mut().for_each(|position| *position /= character.metres_per_unit);
    gltf::write_garment(output, &garment)?;
    let Garment { mesh, pins, .. } = &garment;
    println!(
        "{}: {}, {} vertices, {} triangles, {} pins; sank by up to {:.0} mm, edges changed by {:.1} % (95 of 100; at most {:.1} %)",
        output.display(),
        kind.name(),
        mesh.positions.len(),
        mesh.triangles.len(),
        pins.len(),
        1e3 * moved,
        1e2 * strain[0],
        1e2 * strain[1]
    );
    Ok(())
}
