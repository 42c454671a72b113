//! `ctsn split`: a character whose clothes are meshes of its own, taken apart.

use super::list_clips;
use anyhow::{Result, bail, ensure};
use ctsn_cast::motion::RATE;
use ctsn_rig::gltf::{self, Listed, part_character, read_parts};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// List what a character's file is made of, and write character and garments apart
///
/// Every mesh is listed with what it looks like: by the names of material, mesh and node, or, with a question mark, by
/// where it is on the body. With -o FOLDER, every named top, skirt, dress or pair of trousers becomes a garment
/// (top.glb …), and the rest is the character (character.glb), with its clips and, of a VRM file, its bones. Skin that
/// was deleted under the clothes is made anew inside a garment when it is simulated. Hair, eyes and accessories stay on
/// the character, but hold no cloth.
#[derive(clap::Args)]
pub struct Arguments {
    /// The character (glTF)
    character: PathBuf,
    /// Numbers of the parts that are one garment, in place of those that look like one: 2,3
    #[arg(long, value_delimiter = ',', requires = "output")]
    garment: Vec<usize>,
    /// Poses per second at which the character's clips are written
    #[arg(long, default_value_t = RATE)]
    rate: f64,
    /// Folder to write into
    #[arg(short, long)]
    output: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let parts = read_parts(&arguments.character)?;
    for (number, Listed { name, look, named, size: [vertices, triangles], skinned }) in parts.iter().enumerate() {
        let holds = if look.holds_cloth() { "" } else { "; holds no cloth" };
        let skin = if *skinned { "" } else { "; follows no joint, left out" };
        let look = if *named { look.name().to_owned() } else { format!("{}?", look.name()) };
        println!("{number:>3}  {look:<10} {name}: {vertices} vertices, {triangles} triangles{holds}{skin}");
    }
    let Some(folder) = &arguments.output else { return Ok(()) };
    let skinned = |part: &usize| parts.get(*part).is_some_and(|listed| listed.skinned);
    if let Some(wrong) = arguments.garment.iter().find(|part| !skinned(part)) {
        bail!("--garment {wrong}: wanted the number of a part that follows joints, as listed above");
    }
    let mut garments: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    if arguments.garment.is_empty() {
        let worn =
            (0..parts.len()).filter(|part| skinned(part) && parts[*part].named && parts[*part].look.is_garment());
        worn.for_each(|part| garments.entry(parts[part].look.name()).or_default().push(part));
    } else {
        garments.insert("garment", arguments.garment.clone());
    }
    let worn: Vec<usize> = garments.values().flatten().copied().collect();
    ensure!(!worn.is_empty(), "none of its parts is named like a garment; choose them: --garment 2,3");
    ensure!(
        worn.len() < parts.iter().filter(|part| part.skinned).count(),
        "all of its parts are garments: no body is left"
    );
    for (name, list) in &garments {
        let (garment, _) = part_character(&arguments.character, arguments.rate, list)?;
        let path = folder.join(format!("{name}.glb"));
        gltf::write_part(&path, &garment)?;
        println!("{}: {} vertices", path.display(), garment.mesh.positions.len());
    }
    let (_, character) = part_character(&arguments.character, arguments.rate, &worn)?;
    let path = folder.join("character.glb");
    gltf::write_character(&path, &character, &gltf::Appearance::default())?;
    list_clips(&path, &character);
    Ok(())
}
