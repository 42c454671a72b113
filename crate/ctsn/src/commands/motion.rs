//! `ctsn motion`: generated clips for a character.

use anyhow::{Context, Result, anyhow, bail};
use ctsn_cast::motion;
use ctsn_cast::motion::reading::{Reading, parts};
use ctsn_cast::motion::retarget::retarget;
use ctsn_rig::file::read;
use ctsn_rig::{Character, Clip, gltf};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Give a character generated clips, or those of another character, in place of its own
///
/// Which joint is which part of a body is read from the bones a VRM file names, from the names of the common families
/// (Mixamo, Unreal, VRoid, Rigify, Biped, …), and where names do not tell, from the skeleton itself: limbs are mirrored
/// pairs of chains, legs stand on the floor. What was taken for what is printed. If nothing fits, the error says what
/// the skeleton is nearest to and what it lacks.
#[derive(clap::Args)]
pub struct Arguments {
    /// The character (glTF)
    character: PathBuf,
    #[command(flatten)]
    joints: Joints,
    /// Take the clips of this character (glTF), of the same kind of body but any names, posture and proportions, in
    /// place of generated ones: limbs point where its limbs point, steps are as wide as the legs are long
    #[arg(long, value_name = "OTHER")]
    from: Option<PathBuf>,
    /// Poses per second of the clips
    #[arg(long, default_value_t = motion::RATE)]
    rate: f64,
    /// Where to write the character with its new clips (GLB)
    #[arg(short, long)]
    output: PathBuf,
}

/// Parts of a body that are told.
#[derive(clap::Args)]
pub struct Joints {
    /// Which joints are which parts of the body, where they are not read as they should be: a JSON file such as
    /// {"LeftArm": "bone.017", "LeftForeArm": "bone.018"}. Parts have the names of Mixamo's joints; an animal's legs
    /// are LeftBackUpLeg, LeftBackLeg, LeftBackFoot, LeftFrontUpLeg …
    #[arg(long, value_name = "MAP.json")]
    joints: Option<PathBuf>,
}

impl Joints {
    /// Notes the told parts in the character.
    pub fn tell(&self, character: &mut Character) -> Result<()> {
        let Some(path) = &self.joints else { return Ok(()) };
        tell(path, character).with_context(|| path.display().to_string())
    }
}

fn tell(path: &Path, character: &mut Character) -> Result<()> {
    let map: BTreeMap<String, String> = serde_json::from_slice(&read(path)?)
        .map_err(|error| anyhow!("wanted a JSON object of parts and names of joints: {error}"))?;
    for (part, name) in map {
        if !parts().contains(&part.as_str()) {
            bail!("{part}: wanted one of the parts {}", parts().join(", "));
        }
        let joint = character.joint(&name).ok_or_else(|| {
            let names: Vec<&str> = character.joints.iter().map(|joint| joint.name.as_str()).collect();
            anyhow!("{part}: wanted a joint of the character, found {name:?}; it has {}", names.join(", "))
        })?;
        character.parts.insert(part, joint);
    }
    Ok(())
}

/// Says which joints were taken for which parts, where a body was read.
pub fn say(path: &Path, character: &Character) {
    let (kind, reading) = Reading::nearest(character);
    if reading.missing().is_empty() {
        println!("{}: a body with {kind}: {reading}", super::file_name(path));
    }
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let mut character = gltf::read_character(&arguments.character, motion::RATE)?;
    arguments.joints.tell(&mut character)?;
    character.clips = match &arguments.from {
        None => motion::clips(&character, arguments.rate)?,
        Some(path) => taken(path, &character, arguments.rate)?,
    };
    say(&arguments.character, &character);
    gltf::write_character(&arguments.output, &character, &gltf::Appearance::default())?;
    super::list_clips(&arguments.output, &character);
    Ok(())
}

/// The clips of another character, for this one.
fn taken(path: &Path, character: &Character, rate: f64) -> Result<Vec<Clip>> {
    let other = gltf::read_character(path, rate)?;
    if other.clips.is_empty() {
        bail!("{} has no clip, wanted at least one", path.display());
    }
    say(path, &other);
    Ok(retarget(&other, character)?)
}
