//! `ctsn garment`: a garment for any character.

use anyhow::Result;
use ctsn_cloth::garment::{Cut, Rest, default_kind, drape, load, shell};
use ctsn_rig::Garment;
use ctsn_rig::gltf;
use std::path::{Path, PathBuf};

/// Make a garment for any rigged character, or check one of your own
///
/// The garment is cut from a shell of the body, evenly meshed, and hung on the canonical pose. Fractions run along a
/// limb, from where it leaves the trunk (0) to its tip (1); the tip of a leg is the ankle. Waistbands and collars are
/// pinned to the body: the vertex attribute _PIN (scalar, 1 = pinned) marks their vertices. A garment of your own may
/// have it too.
///
/// --check reads a garment of your own and says what is wrong with it: scale, fit, cloth inside the body, inside out,
/// non-manifold edges, duplicated faces, holes, loose pieces, with the file's vertex numbers. `simulate` and `bake`
/// check the same.
#[derive(clap::Args)]
pub struct Arguments {
    /// Rigged character (glTF)
    character: PathBuf,
    /// Where to write the garment (GLB)
    #[arg(short, long, required_unless_present = "check")]
    output: Option<PathBuf>,
    /// Check this garment instead (glTF)
    #[arg(long, conflicts_with = "output")]
    check: Option<PathBuf>,
    #[command(flatten)]
    cut: Cut,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    if let Some(garment) = &arguments.check {
        return check(&arguments.character, garment);
    }
    arguments.output.as_ref().map_or(Ok(()), |output| make(&arguments.character, &arguments.cut, output))
}

/// Says what is wrong with a garment; fails on what makes it unusable.
fn check(character: &Path, garment: &Path) -> Result<()> {
    let character = gltf::read_character(character, 1.0)?;
    let (cloth, warnings) = load(garment, &character)?;
    warnings.iter().for_each(|warning| println!("{warning}"));
    let (vertices, pins) = (cloth.mesh.positions.len(), cloth.pins.len());
    println!(
        "{}: {vertices} vertices, {pins} pins; fit to be simulated, {} warnings",
        garment.display(),
        warnings.len()
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
