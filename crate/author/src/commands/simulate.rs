//! `ctsn simulate`: the truth to learn from.

use super::{bar, file_name};
use anyhow::{Result, bail};
use ctsn_author::garment;
use ctsn_author::gltf;
use ctsn_author::ground_truth::{self, Count};
use ctsn_author::rig::{Character, Garment};
use std::path::{Path, PathBuf};

/// Simulate a garment on every frame of a character's clips
///
/// Every pose is simulated on its own: the garment is draped on the canonical pose, carried to the pose along a fixed path, and
/// relaxed to rest. Poses already in the folder are kept, so an interrupted run goes on where it stopped.
#[derive(clap::Args)]
pub struct Arguments {
    /// Rigged character (glTF)
    pub character: PathBuf,
    /// Garment, worn in the character's canonical pose (glTF)
    pub garment: PathBuf,
    /// Dataset folder
    #[arg(short, long)]
    pub output: PathBuf,
    #[command(flatten)]
    pub motion: Motion,
}

/// Which poses.
#[derive(clap::Args, Clone)]
pub struct Motion {
    /// Poses per second sampled from every clip
    #[arg(long, default_value_t = 10.0)]
    pub rate: f64,
    /// Clip to use, by name; may be given several times. Default: all
    #[arg(long = "clip")]
    pub clips: Vec<String>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let character = character(&arguments.character, &arguments.motion)?;
    let (garment, warnings) = garment::load(&arguments.garment, &character)?;
    warnings.iter().for_each(|warning| eprintln!("  {}: {warning}", arguments.garment.display()));
    let names = [file_name(&arguments.character), file_name(&arguments.garment)];
    run_on(&character, &garment, &names, &arguments.output)
}

/// Reads a character with the chosen clips.
pub fn character(path: &Path, motion: &Motion) -> Result<Character> {
    if !(motion.rate > 0.0 && motion.rate <= 1000.0) {
        bail!("--rate: wanted more than 0 and at most 1000 poses per second, found {}", motion.rate);
    }
    let mut character = gltf::read_character(path, motion.rate)?;
    if let Some(name) = motion.clips.iter().find(|name| character.clips.iter().all(|clip| clip.name != **name)) {
        let known: Vec<_> = character.clips.iter().map(|clip| clip.name.as_str()).collect();
        bail!("{}: no clip {name}; it has: {}", path.display(), known.join(", "));
    }
    character.clips.retain(|clip| motion.clips.is_empty() || motion.clips.contains(&clip.name));
    Ok(character)
}

/// Simulates into `folder` with a progress bar, and says what came out.
pub fn run_on(character: &Character, garment: &Garment, names: &[String; 2], folder: &Path) -> Result<()> {
    let poses: usize = character.clips.iter().map(|clip| clip.poses.len()).sum();
    println!(
        "{} on {}: {} vertices, {poses} poses in {} clips",
        names[1],
        names[0],
        garment.mesh.positions.len(),
        character.clips.len()
    );
    let bar = bar(poses, "simulate");
    let seconds = std::sync::Mutex::new(Vec::new());
    let Count { simulated, found, rejected } =
        ground_truth::simulate(character, garment, [&names[0], &names[1]], folder, |record| {
            bar.inc(1);
            if let Some(reason) = &record.rejected {
                // `println` of a bar that is not drawn, in a log file say, prints nothing.
                bar.suspend(|| eprintln!("  left out: clip {} frame {}: {reason}", record.clip, record.frame));
            }
            if let Ok(mut seconds) = seconds.lock() {
                seconds.push(record.seconds);
            }
        })?;
    bar.finish_and_clear();
    let mut seconds = seconds.into_inner().unwrap_or_default();
    seconds.sort_by(f64::total_cmp);
    let median = seconds.get(seconds.len() / 2).copied().unwrap_or_default();
    println!(
        "{simulated} poses simulated, {found} found done, {rejected} left out; median {median:.2} s a pose and core"
    );
    if rejected == poses {
        bail!("no pose converged; the reasons stand above");
    }
    Ok(())
}
