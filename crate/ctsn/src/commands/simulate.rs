//! `ctsn simulate`: the truth to learn from.

use super::{bar, file_name, model, remaining};
use anyhow::{Result, bail, ensure};
use ctsn_cloth::garment::{self, Fitted, Resample};
use ctsn_cloth::simulate::{FINE, Material, Settings, is_fine};
use ctsn_rig::gltf;
use ctsn_rig::{Character, Garment, SkinWeights, SkinnedMesh};
use ctsn_train::dataset::Dataset;
use ctsn_train::ground_truth::{self, Kind, Request, Run, Shard};
use ctsn_train::report::Report;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Simulate a garment on every frame of a character's clips
///
/// Every pose is simulated on its own: the garment is draped on the canonical pose, carried to the pose along a fixed
/// path, and relaxed to rest. Poses already in the folder are kept, so an interrupted run continues where it stopped.
/// At the end a report is written into the folder (report.json) and shown; `ctsn inspect FOLDER` shows it again.
///
/// All cores are used; RAYON_NUM_THREADS=2 in the environment keeps it to two. The result does not depend on it.
///
/// Many machines can share the work: give each its part with --shard 0/8, 1/8 … 7/8 (in an array job,
/// $SLURM_ARRAY_TASK_ID/8 or $JOB_COMPLETION_INDEX/8). They may write into one shared folder, or each into its own, to
/// be copied together: `cp -r shard-*/. data`. The outcome is the same as that of a single run: byte for byte where all
/// machines run the same program with the same C library and have the same level of SIMD, which the report names
/// (x86_64 AVX-512, x86_64 AVX2, aarch64 …); elsewhere up to rounding.
#[derive(clap::Args)]
pub struct Arguments {
    /// Rigged character (glTF)
    pub character: PathBuf,
    /// Garment, worn in the character's canonical pose (glTF)
    pub garment: PathBuf,
    /// Dataset folder
    #[arg(short, long)]
    pub output: PathBuf,
    /// Relax every pose from what this model of the same garment predicts, not along a path from the canonical drape:
    /// faster, and of all the ways in which cloth may fold, one that a network can learn
    #[arg(long, value_name = "MODEL")]
    pub from: Option<PathBuf>,
    /// Simulate only part i of N, i from 0 to N - 1
    #[arg(long, value_name = "i/N", default_value_t = Shard::WHOLE)]
    pub shard: Shard,
    #[command(flatten)]
    pub options: Options,
}

/// Poses per second of the clips, where nothing else is asked for.
const RATE: f64 = 10.0;

/// How far the joints of another file's body may be from the character's, in its extents.
const APART: f64 = 0.03;

/// Share of the vertices that may lie where the body passes into itself.
pub const PINCHED: f64 = 0.1;

/// Which poses, of what cloth.
#[derive(clap::Args, Clone)]
pub struct Options {
    /// Poses per second sampled from every clip
    #[arg(long, default_value_t = RATE)]
    pub rate: f64,
    /// Simulate only this many of the frames, evenly spread over the clips; a greater number adds to them. Default: all
    #[arg(long, value_name = "N")]
    pub poses: Option<usize>,
    /// Simulate this many mixed poses as well: limbs of some training frames on the trunk of another, every joint
    /// turned further by up to 30°. Variety teaches more than further frames of the same motion. A greater number adds
    /// to them. Default: none; `ctsn bake`: two for each frame, of a fine garment one for two
    #[arg(long, value_name = "N")]
    pub mixed: Option<usize>,
    /// Simulate this many poses coarsely as well, mixed ones where there are limbs to mix, else frames: a garment of
    /// more than 2,500 vertices thinned to 700, and itself laid on that, in a fraction of the time. The skeleton
    /// stream learns from them. `ctsn simulate` wants --from for it. Default: none; `ctsn bake`: ten for each frame
    #[arg(long, value_name = "N")]
    pub coarse: Option<usize>,
    /// Clip to use, by name; may be given several times. Default: all
    #[arg(long = "clip")]
    pub clips: Vec<String>,
    /// Simulate on an even mesh made from the garment's, which then rides on it to be drawn: auto (where its own is
    /// coarser than 15 mm, uneven, or of several layers), never, or the length of an edge in mm
    #[arg(long, value_name = "WHEN", default_value_t = Resample::Auto)]
    pub resample: Resample,
    #[arg(long, default_value = "cotton", help = format!("Material of the cloth: {}", Material::names()))]
    pub material: String,
    /// Simulate this many poses a second time, every joint turned by half a degree, to measure the noise of the truth
    #[arg(long, value_name = "K", default_value_t = 0)]
    pub noise_floor: usize,
    /// Keep poses with at most this share of the vertices inside the body where it passes into itself (an upper arm
    /// into the chest, say): no place is outside there. With 0, few poses are kept of wide motion on slim limbs
    #[arg(long, value_name = "SHARE", default_value_t = PINCHED)]
    pub pinched: f64,
    /// Take the body of this file (glTF), bound to joints of the same names, where the character's own skin is missing
    #[arg(long, value_name = "OTHER")]
    pub body: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    some(&along(&character(&arguments.character, &arguments.options)?, arguments, None)?)
}

/// Refuses a dataset of which poses were simulated, and none was kept.
pub fn some(report: &Report) -> Result<()> {
    ensure!(report.kept > 0 || report.missing == report.frames, "no pose converged; the reasons stand above");
    Ok(())
}

/// Simulates the clips of this form of the character, beginning no pose after `until`; what is in the dataset then.
pub fn along(character: &Character, arguments: &Arguments, until: Option<Instant>) -> Result<Report> {
    let Arguments { options, output, shard, from, .. } = arguments;
    let material = Material::named(&options.material)?;
    let mut character = character.clone();
    let garment = fitted(&arguments.garment, &mut character, options.resample)?;
    fine(options, &garment)?;
    let character = &character;
    let teacher = from.as_deref().map(model).transpose()?;
    let names = [file_name(&arguments.character), file_name(&arguments.garment)];
    println!("{} on {}: {} vertices", names[1], names[0], garment.mesh.positions.len());
    let request = Request {
        character,
        garment: &garment,
        names: names.each_ref().map(String::as_str),
        material: (&options.material, material),
        settings: Settings { attached: garment.pins.clone(), pinched: options.pinched, ..Settings::default() },
        teacher: teacher.as_ref(),
        shard: *shard,
        poses: options.poses,
        mixed: options.mixed.unwrap_or(0),
        coarse: options.coarse.unwrap_or(0),
        twins: options.noise_floor,
    };
    let work = Run::new(request, output)?;
    println!("{} poses to simulate, {} found done", work.left(), work.found);
    follow(&work, character, until)?;
    let report = Report::new(output)?;
    report.write(output)?;
    println!("{report}");
    Ok(report)
}

/// Reads a garment, completes the body under it, and says what was mended and what may be wrong.
fn fitted(path: &Path, character: &mut Character, resample: Resample) -> Result<Garment> {
    let Fitted { garment, mended, warnings } = garment::load(path, character, resample)?;
    mended.iter().for_each(|mend| eprintln!("  {}: mended: {mend}", path.display()));
    warnings.iter().for_each(|warning| eprintln!("  {}: {warning}", path.display()));
    Ok(garment)
}

/// Whether the garment is one of which poses may be simulated coarsely.
pub fn fine(options: &Options, garment: &Garment) -> Result<bool> {
    let (vertices, coarse) = (garment.mesh.positions.len(), options.coarse.unwrap_or(0));
    let fine = is_fine(vertices);
    ensure!(fine || coarse == 0, "--coarse {coarse}: wanted a garment of more than {FINE} vertices, found {vertices}");
    Ok(fine)
}

/// The frames of a character's clips in a garment of cotton, for a training without simulated poses.
pub fn unsimulated(character: &Path, garment: &Path) -> Result<Dataset> {
    let names = [file_name(character), file_name(garment)];
    let mut character = gltf::read_character(character, RATE)?;
    let cloth = fitted(garment, &mut character, Resample::Auto)?;
    println!("{} on {}: {} vertices; draping it", names[1], names[0], cloth.mesh.positions.len());
    let request = Request {
        character: &character,
        garment: &cloth,
        names: names.each_ref().map(String::as_str),
        material: ("cotton", Material::named("cotton")?),
        settings: Settings { attached: cloth.pins.clone(), pinched: PINCHED, ..Settings::default() },
        teacher: None,
        shard: Shard::WHOLE,
        poses: None,
        mixed: 0,
        coarse: 0,
        twins: 0,
    };
    Ok(ground_truth::unsimulated(&request)?)
}

/// Reads a character with the chosen clips.
pub fn character(path: &Path, options: &Options) -> Result<Character> {
    if !(options.rate > 0.0 && options.rate <= 1000.0) {
        bail!("--rate: wanted more than 0 and at most 1000 poses per second, found {}", options.rate);
    }
    let mut character = gltf::read_character(path, options.rate)?;
    if let Some(name) = options.clips.iter().find(|name| character.clips.iter().all(|clip| clip.name != **name)) {
        let known: Vec<_> = character.clips.iter().map(|clip| clip.name.as_str()).collect();
        bail!("{}: no clip {name}; it has: {}", path.display(), known.join(", "));
    }
    character.clips.retain(|clip| options.clips.is_empty() || options.clips.contains(&clip.name));
    options.body.as_deref().map_or(Ok(()), |other| add_body(&mut character, other))?;
    Ok(character)
}

/// Adds the body of another file, bound to joints of the same names in the same places.
pub fn add_body(character: &mut Character, path: &Path) -> Result<()> {
    let other = gltf::read_character(path, 1.0)?;
    let extent = other.body.mesh.extent();
    let (ours, theirs) = (character.canonical_pose(), other.canonical_pose());
    let joint = |index: usize| -> Result<usize> {
        let name = &other.joints[index].name;
        let Some(own) = character.joint(name) else {
            bail!("{}: its skin follows {name}; wanted a joint of the character", path.display());
        };
        let apart = ours[own].translation.distance(theirs[index].translation);
        if apart > APART * extent {
            bail!("{}: its {name} is {apart:.2} m from the character's; wanted the same pose and size", path.display());
        }
        Ok(own)
    };
    let row = |row: &SkinWeights| row.iter().map(|(at, weight)| Ok((joint(*at)?, *weight))).collect::<Result<_>>();
    let weights = other.body.weights.iter().map(row).collect::<Result<Vec<SkinWeights>>>()?;
    character.body.extend(SkinnedMesh { mesh: other.body.mesh, weights });
    Ok(())
}

/// Simulates with a progress bar; in a log file, with a line now and then.
fn follow(work: &Run, character: &Character, until: Option<Instant>) -> Result<()> {
    let (bar, all) = (bar(work.left(), "simulate"), work.left() as u64);
    let every = if until.is_some() { 10 } else { (all / 20).max(1) };
    // Of many poses only so many are simulated as the time allows.
    let expected = |done: u64, taken: Duration| match until {
        Some(until) => {
            let whole = taken + until.saturating_duration_since(Instant::now());
            all.min((done as f64 * whole.as_secs_f64() / taken.as_secs_f64()).ceil() as u64)
        }
        None => all,
    };
    work.simulate(until, |record, kind| {
        bar.inc(1);
        bar.set_length(expected(bar.position(), bar.elapsed()));
        if let Some(reason) = &record.rejected {
            let frame = record.frame;
            let pose = match kind {
                Kind::Frame => format!("{} frame {frame}", character.clips[record.clip].name),
                Kind::Twin => format!("{} frame {frame} (twin)", character.clips[record.clip].name),
                Kind::Mixed => format!("mixed pose {frame}"),
                Kind::Coarse => format!("coarse pose {frame}"),
            };
            // `println` of a bar that is not drawn (in a log file, say) prints nothing.
            bar.suspend(|| eprintln!("  left out: {pose}: {reason}"));
        }
        if bar.is_hidden() && bar.position().is_multiple_of(every) {
            let (done, all) = (bar.position(), bar.length().unwrap_or(all));
            let (about, left) = (if until.is_some() { "about " } else { "" }, remaining(bar.elapsed(), done, all));
            eprintln!("  {done} of {about}{all} poses, {left} left");
        }
    })?;
    bar.finish_and_clear();
    Ok(())
}
