//! `ctsn bake`: simulate, train and evaluate in one go.

use super::{evaluate, file_name, garment, motion, simulate, train};
use crate::pages;
use anyhow::{Context, Result, bail, ensure};
use ctsn_cast::motion::clips;
use ctsn_cloth::garment::{Cut, load, rehearse, sketch};
use ctsn_rig::Character;
use ctsn_rig::file::{read, write};
use ctsn_rig::mixed::has_limbs;
use ctsn_train::dataset::Dataset;
use ctsn_train::ground_truth::{Shard, adopt};
use ctsn_train::report::Report;
use ctsn_train::training::{POSES, Settings};
use indicatif::HumanDuration;
use maud::Markup;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Character and garment in, model out: simulate → train → simulate from its predictions → train → evaluate
///
/// First a few poses are simulated along a path each, and a first model is trained on them: it is usable from then on.
/// All others are relaxed from what it predicts, which is faster and chooses folds that a network can learn; on all of
/// them the final model is trained. To the character's own clips, motion is generated where its skeleton has a known
/// form, and two poses are mixed for every frame. The unseen tenth is the end of the list of clips: generated ones,
/// where there are any.
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

/// The whole of it, where neither a time nor a number of epochs is asked for.
const BUDGET: Duration = Duration::from_secs(3600);
/// Shares of the time budget that the steps take: poses along their paths, the first model, relaxed poses, the model.
/// What is left is for the evaluation.
const SHARES: [f64; 4] = [0.17, 0.05, 0.53, 0.22];
/// Of how many poses to simulate one goes along its path, and is learned from by the first model; and how many such
/// poses there are at least.
const FIRST: usize = 5;
const FEWEST: usize = 60;
/// Mixed poses for each frame. Of a stranger's T-shirt 180 poses were simulated, and another's dances judged: with a
/// third of them mixed E_dist was 17.5 mm, with two thirds, turned further, 12.6 mm (docs/decisions/poses.md).
const MIXED: usize = 2;
/// Frames for each mixed pose of a garment that is fine: there half of them are left out, and one that is kept takes
/// four times as long as a frame (a dress of 2,996 vertices: 20 and 5 s of a core).
const FRAMES_A_MIXED: usize = 2;
/// Coarse poses for each frame of such a garment, a second of a core each: ten take about as long as the mixed pose for
/// every other frame, and teach more of motion that no clip has (docs/decisions/poses.md).
const COARSE: usize = 10;
/// Poses by which the time of one is measured.
const TIMED: usize = 6;

pub fn run(arguments: &Arguments) -> Result<()> {
    let Arguments { output, cut, options, training, .. } = arguments;
    let work = output.with_extension("work");
    let garment = match &arguments.garment {
        Some(garment) => garment.clone(),
        None => generated(&arguments.character, cut, &work)?,
    };
    let character = moving(arguments)?;
    let asked = training.settings;
    let counted = asked.epochs != Settings::default().epochs;
    let budget = asked.budget.or((!counted).then_some(BUDGET));
    let frames: usize = character.clips.iter().map(|clip| clip.poses.len()).sum();
    let frames = options.poses.unwrap_or(frames).min(frames);
    ensure!(frames >= POSES, "wanted at least {POSES} poses to learn from, found {frames} in the clips and --poses");
    let steps = Steps { character: &character, arguments, garment: &garment, budget, begun: Instant::now() };
    let first = work.join("first.safetensors");
    let (shown, fine) = steps.check()?;
    let [mixed, coarse] = beside(frames, options, &character, fine);
    if !first.exists() {
        let few = frames.div_ceil(FIRST).max(FEWEST).min(frames);
        let along = simulate::Options { poses: Some(few), mixed: 0, coarse: 0, noise_floor: 0, ..options.clone() };
        steps.estimate(&along, &work.join("first"), frames + mixed)?;
        println!("step 1 of 5: poses along their paths");
        steps.simulate(&along, &work.join("first"), 0)?;
        println!("step 2 of 5: a first model");
        steps.train(&work.join("first"), &first, SHARES[1])?;
    }
    if !output.exists() {
        write(output, &read(&first)?)?;
        println!("{}: a first model; a better one follows", file_name(output));
    }
    let many = simulate::Options { poses: Some(frames), mixed, coarse, from: Some(first), ..options.clone() };
    println!("step 3 of 5: poses from what it predicts");
    // To relax them anew would teach less than as many others.
    adopt(&work.join("first"), &work)?;
    steps.simulate(&many, &work, 2)?;
    println!("step 4 of 5: the model");
    steps.train(&work, output, SHARES[3])?;
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
fn beside(frames: usize, options: &simulate::Options, character: &Character, fine: bool) -> [usize; 2] {
    let mixed = match (options.mixed == 0 && has_limbs(character), fine) {
        (true, true) => frames / FRAMES_A_MIXED,
        (true, false) => frames * MIXED,
        (false, _) => options.mixed,
    };
    [mixed, if options.coarse == 0 && fine { frames * COARSE } else { options.coarse }]
}

/// What all steps share.
struct Steps<'a> {
    character: &'a Character,
    arguments: &'a Arguments,
    garment: &'a Path,
    budget: Option<Duration>,
    begun: Instant,
}

impl Steps<'_> {
    fn simulation(&self, options: &simulate::Options, dataset: &Path) -> simulate::Arguments {
        simulate::Arguments {
            character: self.arguments.character.clone(),
            garment: self.garment.to_owned(),
            output: dataset.to_owned(),
            shard: Shard::WHOLE,
            options: options.clone(),
        }
    }

    /// Says what is wrong with the garment and what of it was mended, before anything is begun; the same to be shown,
    /// and whether the garment is fine.
    fn check(&self) -> Result<(Markup, bool)> {
        let found = sketch(self.garment, self.character)?;
        let mut complete = Character { clips: Vec::new(), ..self.character.clone() };
        let hung = load(self.garment, &mut complete, self.arguments.options.resample).and_then(|fitted| {
            let moved = rehearse(&complete, &fitted.garment, self.arguments.options.pinched)?;
            Ok((fitted, moved))
        });
        let path = self.arguments.output.with_extension("html");
        if hung.is_err() {
            let names = [self.garment, &self.arguments.character].map(file_name);
            write(&path, pages::check::page(names, self.character, &complete, &found, &hung)?.as_bytes())?;
        }
        let shown = pages::check::faults(self.character, &complete, &found, &hung)?;
        let (fitted, _) =
            hung.with_context(|| format!("{} (pictures in {})", self.garment.display(), path.display()))?;
        Ok((shown, simulate::fine(&self.arguments.options, &fitted.garment)?))
    }

    /// Says how long it will take, from a few poses.
    fn estimate(&self, options: &simulate::Options, dataset: &Path, poses: usize) -> Result<()> {
        let few = simulate::Options { poses: options.poses.map(|all| all.min(TIMED)), ..options.clone() };
        simulate::along(self.character, &self.simulation(&few, dataset), None)?;
        let cores = std::thread::available_parallelism().map_or(1, usize::from) as f64;
        let pose = Report::new(dataset)?.seconds.median / cores;
        match self.budget {
            Some(budget) => {
                let share = SHARES[0] + SHARES[2];
                let least = Duration::from_secs_f64(FEWEST.min(poses) as f64 * pose / share);
                if least > budget {
                    println!("{FEWEST} poses are the fewest, so this takes longer than was asked for");
                }
                let budget = budget.max(least);
                let possible = (budget.as_secs_f64() * share / pose.max(1e-3)) as usize;
                println!(
                    "this takes {}: a pose takes {pose:.1} s, so about {} of {poses} poses are simulated; a first model is \
                     there after {}",
                    HumanDuration(budget),
                    possible.min(poses),
                    HumanDuration(budget.mul_f64(SHARES[0] + SHARES[1]))
                );
            }
            None => println!(
                "a pose takes {pose:.1} s: {poses} take about {}, and as many epochs as were asked for come behind",
                HumanDuration(Duration::from_secs_f64(pose * poses as f64))
            ),
        }
        Ok(())
    }

    /// Simulates into a dataset for the share of the time that is this step's, less what the steps before took too
    /// long; longer where a training wants more poses. A dataset that was finished in time is kept: with more poses it
    /// would be another, and all that follows had to be done again.
    fn simulate(&self, options: &simulate::Options, dataset: &Path, step: usize) -> Result<()> {
        let Some(budget) = self.budget else {
            return simulate::along(self.character, &self.simulation(options, dataset), None);
        };
        if dataset.join("report.json").exists() && Report::new(dataset)?.kept >= FEWEST {
            println!("{}: has been simulated already", dataset.display());
            return Ok(());
        }
        let until = Instant::now() + budget.mul_f64(SHARES[step]);
        let until = until.min(self.begun + budget.mul_f64(SHARES[..=step].iter().sum()));
        let all = options.poses.unwrap_or(usize::MAX);
        let mut poses = FEWEST.min(all);
        loop {
            let enough = simulate::Options { poses: Some(poses), mixed: 0, coarse: 0, ..options.clone() };
            simulate::along(self.character, &self.simulation(&enough, dataset), None)?;
            let kept = Report::new(dataset)?.kept;
            if kept >= FEWEST || poses == all {
                break;
            }
            // As many are left out of the next ones.
            poses = (poses + (FEWEST - kept) * poses / kept.max(1)).min(all);
        }
        simulate::along(self.character, &self.simulation(options, dataset), Some(until))
    }

    fn train(&self, dataset: &Path, output: &Path, share: f64) -> Result<()> {
        let mut training = self.arguments.training.clone();
        training.settings.budget = self.budget.map(|budget| budget.mul_f64(share));
        let (dataset, output) = (dataset.to_owned(), output.to_owned());
        train::run(&train::Arguments {
            dataset,
            garment: None,
            self_supervised: false,
            teacher: false,
            output,
            training,
        })
    }
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
