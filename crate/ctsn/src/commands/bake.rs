//! `ctsn bake`: simulate, train and evaluate in one go.

mod steps;

use super::{evaluate, file_name, garment, motion, simulate, train};
use crate::pages;
use anyhow::{Context, Result, bail, ensure};
use ctsn_cast::motion::clips;
use ctsn_cloth::garment::Cut;
use ctsn_rig::Character;
use ctsn_rig::file::{read, write};
use ctsn_rig::mixed::has_limbs;
use ctsn_train::dataset::Dataset;
use ctsn_train::ground_truth::adopt;
use ctsn_train::report::Report;
use ctsn_train::training::POSES;
use std::path::{Path, PathBuf};
use std::time::Instant;
use steps::{BUDGET, FEWEST, Plan, Steps};

/// Character and garment in, model out: simulate → train → simulate from its predictions → train → evaluate
///
/// First a few poses are simulated along a path each, and a first model is trained on them: it is usable from then on.
/// All others are relaxed from what it predicts, which is faster and chooses folds that a network can learn; on all of
/// them the final model is trained. To the character's own clips, motion is generated where its skeleton has a known
/// form, and two poses are mixed for every frame; of a garment of more than 2,500 vertices one for every other frame,
/// and ten more are simulated coarsely. The unseen tenth is the end of the list of clips: generated ones, where there
/// are any.
///
/// The whole takes an hour (--time-budget), or as long as it takes with --epochs: then the result does not depend on
/// the machine's speed. Intermediate results are kept in a folder beside the model (MODEL.work), from which an
/// interrupted bake continues.
#[derive(clap::Args)]
pub struct Arguments {
    /// Rigged character (glTF)
    character: PathBuf,
    /// Garment, worn in the character's canonical pose (glTF). Without one, a garment is made as `ctsn garment` does
    #[arg(conflicts_with = "Cut")]
    garment: Option<PathBuf>,
    /// Model file to write (safetensors)
    #[arg(short, long)]
    output: PathBuf,
    #[command(flatten)]
    joints: motion::Joints,
    /// Learn from the character's own clips alone, not from generated motion too
    #[arg(long)]
    own_motion: bool,
    #[command(flatten, next_help_heading = "Garment, where none is given")]
    cut: Cut,
    #[command(flatten, next_help_heading = "Simulation")]
    options: simulate::Options,
    #[command(flatten, next_help_heading = "Training")]
    training: train::Training,
}

/// Of how many poses to simulate one goes along its path, and is learned from by the first model.
const FIRST: usize = 5;
/// Mixed poses for each frame. Of a stranger's T-shirt 180 poses were simulated, and another's dances judged: with a
/// third of them mixed E_dist was 17.5 mm, with two thirds, turned further, 12.6 mm (docs/decisions/poses.md).
const MIXED: usize = 2;
/// Frames for each mixed pose of a garment that is fine: there half of them are left out, and one that is kept takes
/// four times as long as a frame (a dress of 2,996 vertices: 20 and 5 s of a core).
const FRAMES_A_MIXED: usize = 2;
/// Coarse poses for each frame of such a garment, a second of a core each: ten take about as long as the mixed pose for
/// every other frame, and teach more of motion that no clip has (docs/decisions/poses.md).
const COARSE: usize = 10;

pub fn run(arguments: &Arguments) -> Result<()> {
    let Arguments { output, cut, options, training, .. } = arguments;
    let work = output.with_extension("work");
    let garment = match &arguments.garment {
        Some(garment) => garment.clone(),
        None => generated(&arguments.character, cut, &work)?,
    };
    let character = moving(arguments)?;
    let asked = training.settings;
    let budget = asked.budget.or(asked.epochs.is_none().then_some(BUDGET));
    let frames: usize = character.clips.iter().map(|clip| clip.poses.len()).sum();
    let frames = options.poses.unwrap_or(frames).min(frames);
    ensure!(frames >= POSES, "wanted at least {POSES} poses to learn from, found {frames} in the clips and --poses");
    let steps = Steps { character: &character, arguments, garment: &garment, frames, budget, begun: Instant::now() };
    let (shown, fine) = steps.check()?;
    let plan = plan(frames, options, &character, fine);
    let few = frames.div_ceil(FIRST).max(FEWEST).min(frames);
    let few = simulate::Options { poses: Some(few), mixed: None, coarse: None, noise_floor: 0, ..options.clone() };
    let (along, first) = (work.join("first"), work.join("first.safetensors"));
    if !first.exists() {
        steps.estimate(&few, &along, &plan)?;
    }
    println!("step 1 of 5: poses along their paths");
    steps.simulate(0, &few, &along, None)?;
    if !first.exists() {
        println!("step 2 of 5: a first model");
        steps.train(1, &along, &first)?;
    }
    if !output.exists() {
        write(output, &read(&first)?)?;
        println!("{}: a first model; a better one follows", file_name(output));
    }
    println!("step 3 of 5: poses from what it predicts");
    // To relax them anew would teach less than as many others.
    adopt(&along, &work)?;
    let [mixed, coarse] = [plan.mixed, plan.coarse].map(Some);
    let many = simulate::Options { poses: Some(frames), mixed, coarse, ..options.clone() };
    steps.simulate(2, &many, &work, Some(&first))?;
    println!("step 4 of 5: the model");
    steps.train(3, &work, output)?;
    println!("step 5 of 5: its errors");
    let [json, page] = ["report.json", "html"].map(|extension| output.with_extension(extension));
    let judged = evaluate::Arguments {
        all: false,
        model: output.clone(),
        dataset: work.clone(),
        json: Some(json),
        html: Some(page.clone()),
    };
    evaluate::judge(&judged, |errors| {
        let (report, dataset) = (Report::new(&work)?, Dataset::read(&work)?);
        let before = pages::bake::before(shown, &work, &dataset, &character, &report)?;
        Ok([before, pages::bake::after(&report, errors.ratio, &file_name(output))])
    })?;
    println!("{}: pictures, what was mended, what to do better, and how to put it on a page", page.display());
    Ok(())
}

/// How many mixed and coarse poses are simulated beside so many frames, where nothing else is asked for.
fn plan(frames: usize, options: &simulate::Options, character: &Character, fine: bool) -> Plan {
    let mixed = if fine { frames / FRAMES_A_MIXED } else { frames * MIXED };
    let mixed = options.mixed.unwrap_or(if has_limbs(character) { mixed } else { 0 });
    let coarse = options.coarse.unwrap_or(if fine { frames * COARSE } else { 0 });
    Plan { frames, mixed, coarse, fine }
}

/// The character with its own clips, or those asked for, and behind them the generated ones.
fn moving(arguments: &Arguments) -> Result<Character> {
    let Arguments { character: path, options, .. } = arguments;
    let mut character = simulate::character(path, options)?;
    if arguments.own_motion {
        return Ok(character);
    }
    arguments.joints.tell(&mut character)?;
    match clips(&character, options.rate) {
        Ok(clips) => {
            motion::say(path, &character);
            let known: Vec<String> = character.clips.iter().map(|clip| clip.name.clone()).collect();
            character.clips.extend(clips.into_iter().filter(|clip| !known.contains(&clip.name)));
            println!(
                "{}: {} clips, {} of them generated",
                file_name(path),
                character.clips.len(),
                character.clips.len() - known.len()
            );
        }
        Err(reason) if character.clips.is_empty() => {
            bail!("{} has no clip, wanted at least one; and none can be generated: {reason}", path.display());
        }
        Err(reason) => println!("{}: no motion is generated: {reason}", file_name(path)),
    }
    Ok(character)
}

/// The garment that `ctsn garment` makes. It is made once and kept beside the dataset, with a note of how it was cut.
fn generated(character: &Path, cut: &Cut, dataset: &Path) -> Result<PathBuf> {
    let [path, note] = ["garment.glb", "garment.txt"].map(|name| dataset.join(name));
    let wanted = format!("{} {}", file_name(character), serde_json::to_string(cut)?);
    if !path.exists() {
        std::fs::create_dir_all(dataset).with_context(|| dataset.display().to_string())?;
        write(&note, wanted.as_bytes())?;
        garment::make(character, cut, &path)?;
    }
    // An older version left no note.
    if note.exists() {
        let found = String::from_utf8_lossy(&read(&note)?).into_owned();
        let what = "holds poses of another garment; name another --output, or delete this folder";
        ensure!(found == wanted, "{}: {what}: wanted {wanted}, found {found}", dataset.display());
    }
    Ok(path)
}
