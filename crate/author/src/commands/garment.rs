//! `ctsn garment`: a garment for any character.

use anyhow::Result;
use ctsn_author::garment::{Cut, shell};
use ctsn_author::gltf;
use std::path::{Path, PathBuf};

/// Make a garment for any rigged character
///
/// An offset shell of the body, cut at neck, sleeves and hem: a shirt for what walks upright, a coat for what goes on four legs.
/// Fractions run along a limb, from where it leaves the trunk (0) to its tip (1).
#[derive(clap::Args)]
pub struct Arguments {
    /// Rigged character (glTF)
    character: PathBuf,
    /// Where to write the garment (GLB)
    #[arg(short, long)]
    output: PathBuf,
    #[command(flatten)]
    cut: CutArguments,
}

/// How the garment is cut.
#[derive(clap::Args, Clone)]
pub struct CutArguments {
    /// Distance from the body, metres. Default: 12 mm on a human
    #[arg(long)]
    looseness: Option<f64>,
    /// Vertices, about: 500 to 10000
    #[arg(long, default_value_t = Cut::default().vertices)]
    vertices: usize,
    /// Covered joint, by name; may be given several times. Default: trunk and the fractions below
    #[arg(long = "cover")]
    joints: Vec<String>,
    /// Sleeves and leg holes: covered fraction of arms, or of an animal's legs
    #[arg(long, default_value_t = Cut::default().sleeve)]
    sleeve: f64,
    /// Hem: covered fraction of the legs of what walks upright
    #[arg(long, default_value_t = Cut::default().hem)]
    hem: f64,
    /// Collar: covered fraction of neck and tail
    #[arg(long, default_value_t = Cut::default().collar)]
    collar: f64,
}

impl CutArguments {
    /// The cut these arguments describe.
    pub fn cut(&self) -> Cut {
        let Self { looseness, vertices, ref joints, sleeve, hem, collar } = *self;
        let joints = Some(joints.clone()).filter(|joints| !joints.is_empty());
        Cut { looseness, vertices, joints, sleeve, hem, collar }
    }
}

pub fn run(arguments: &Arguments) -> Result<()> {
    make(&arguments.character, &arguments.cut.cut(), &arguments.output)
}

/// Cuts a garment for the character and writes it.
pub fn make(character: &Path, cut: &Cut, output: &Path) -> Result<()> {
    // Any rate will do: a garment is cut on the canonical pose.
    let character = gltf::read_character(character, 1.0)?;
    let mut garment = shell(&character, cut)?;
    // In the units of the character's file, so that the two belong together in any tool.
    garment.mesh.positions.iter_mut().for_each(|position| *position /= character.metres_per_unit);
    gltf::write_garment(output, &garment)?;
    let mesh = &garment.mesh;
    println!("{}: {} vertices, {} triangles", output.display(), mesh.positions.len(), mesh.triangles.len());
    Ok(())
}
