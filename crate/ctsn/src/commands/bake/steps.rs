//! The steps of a bake, and how its time is shared among them.

use super::Arguments;
use crate::commands::{file_name, simulate, train};
use crate::pages;
use anyhow::{Context, Result};
use ctsn_cloth::garment::{load, rehearse, sketch};
use ctsn_rig::Character;
use ctsn_rig::file::{read, write};
use ctsn_train::ground_truth::Shard;
use ctsn_train::report::Report;
use indicatif::HumanDuration;
use maud::Markup;
use std::path::Path;
use std::time::{Duration, Instant};

/// The whole of it, where neither a time nor a number of epochs is asked for.
pub const BUDGET: Duration = Duration::from_secs(3600);
/// Shares of the time budget that the steps take: poses along their paths, the first model, relaxed poses, the model.
/// What is left is for the evaluation.
const SHARES: [f64; 4] = [0.17, 0.05, 0.53, 0.22];
/// How many poses are simulated at least.
pub const FEWEST: usize = 60;
/// Poses by which the time of one is measured.
const TIMED: usize = 6;
/// The file in a dataset that tells that its step was not interrupted, and in how many seconds' bake.
const DONE: &str = "simulated";

/// Poses of which a dataset is to be made, for the forecast.
pub struct Plan {
    /// Frames of clips.
    pub frames: usize,
    /// Limbs of several frames.
    pub mixed: usize,
    /// Simulated thinned.
    pub coarse: usize,
    /// Whether the garment is fine.
    pub fine: bool,
}

impl Plan {
    /// How long all of it takes, in poses along their path. Of a fine garment a mixed pose takes as long as four
    /// frames, and a coarse one a fifth of one (a skirt of 3,985 vertices).
    fn cost(&self) -> f64 {
        let mixed = if self.fine { 4.0 } else { 1.0 };
        self.frames as f64 + mixed * self.mixed as f64 + 0.2 * self.coarse as f64
    }
}

/// What all steps share.
pub struct Steps<'a> {
    pub character: &'a Character,
    pub arguments: &'a Arguments,
    pub garment: &'a Path,
    /// Frames that may be simulated.
    pub frames: usize,
    /// None where a number of epochs was asked for.
    pub budget: Option<Duration>,
    pub begun: Instant,
}

impl Steps<'_> {
    /// Simulates into a dataset, along paths or from what the model `from` predicts.
    fn along(
        &self,
        options: &simulate::Options,
        dataset: &Path,
        from: Option<&Path>,
        until: Option<Instant>,
    ) -> Result<Report> {
        let arguments = simulate::Arguments {
            character: self.arguments.character.clone(),
            garment: self.garment.to_owned(),
            output: dataset.to_owned(),
            from: from.map(Path::to_owned),
            shard: Shard::WHOLE,
            options: options.clone(),
        };
        simulate::along(self.character, &arguments, until)
    }

    /// Says what is wrong with the garment and what of it was mended, before anything is begun; the same to be shown,
    /// and whether the garment is fine.
    pub fn check(&self) -> Result<(Markup, bool)> {
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

    /// Says how long it will take to simulate what is planned, from a few poses.
    pub fn estimate(&self, options: &simulate::Options, dataset: &Path, plan: &Plan) -> Result<()> {
        let few = simulate::Options { poses: options.poses.map(|all| all.min(TIMED)), ..options.clone() };
        let pose = self.along(&few, dataset, None, None)?.seconds.median / rayon::current_num_threads() as f64;
        let (poses, all) = (plan.frames + plan.mixed, plan.cost() * pose);
        let coarse = if plan.coarse > 0 { ", and coarse ones beside them" } else { "" };
        match self.budget {
            Some(budget) => {
                let share = SHARES[0] + SHARES[2];
                let least = Duration::from_secs_f64(FEWEST.min(poses) as f64 * pose / share);
                if least > budget {
                    println!("{FEWEST} poses are the fewest, so this takes longer than was asked for");
                }
                let budget = budget.max(least);
                let possible = (poses as f64 * budget.as_secs_f64() * share / all.max(1e-3)) as usize;
                println!(
                    "this takes {}: a pose takes {pose:.1} s, so about {} of {poses} poses are simulated{coarse}; a first \
                     model is there after {}",
                    HumanDuration(budget),
                    possible.clamp(FEWEST.min(poses), poses),
                    HumanDuration(budget.mul_f64(SHARES[0] + SHARES[1]))
                );
            }
            None => println!(
                "a pose takes {pose:.1} s: {poses}{coarse} take about {}, and as many epochs as were asked for come behind",
                HumanDuration(Duration::from_secs_f64(all))
            ),
        }
        Ok(())
    }

    /// Simulates into a dataset for the share of the time that is this step's, less what the steps before took too
    /// long; longer where a training wants more poses, up to all frames. What was interrupted has that time again.
    /// A dataset that was finished in time is kept: with more poses it would be another, and all that follows had to be
    /// done again. Where a longer time is asked for, poses are added for what it is longer, but not to those of the
    /// first model.
    ///
    /// # Errors
    /// A dataset of another character, garment, cloth or motion; no pose that was kept.
    pub fn simulate(
        &self,
        step: usize,
        options: &simulate::Options,
        dataset: &Path,
        from: Option<&Path>,
    ) -> Result<()> {
        let Some(budget) = self.budget else {
            return simulate::some(&self.along(options, dataset, from, None)?);
        };
        let done = dataset.join(DONE);
        let had = done.exists().then(|| read(&done)).transpose()?.map(|seconds| given(&seconds));
        if had.is_some_and(|had| step == 0 || budget <= had) {
            println!("{}: has been simulated already", dataset.display());
            return self.along(options, dataset, from, Some(self.begun)).map(drop);
        }
        if had.is_some() {
            // A training on fewer poses that was cut off cannot go on.
            std::fs::remove_file(self.arguments.output.with_extension("checkpoint")).ok();
        }
        let more = budget - had.unwrap_or_default();
        let until = Instant::now() + more.mul_f64(SHARES[step]);
        let until = until.min(self.begun + more.mul_f64(SHARES[..=step].iter().sum()));
        let mut poses = FEWEST.min(self.frames);
        loop {
            let enough = simulate::Options { poses: Some(poses), mixed: None, coarse: None, ..options.clone() };
            let kept = self.along(&enough, dataset, from, None)?.kept;
            if kept >= FEWEST || poses == self.frames {
                break;
            }
            // As many are left out of the next ones.
            poses = (poses + (FEWEST - kept) * poses / kept.max(1)).min(self.frames);
        }
        simulate::some(&self.along(options, dataset, from, Some(until))?)?;
        Ok(write(&done, budget.as_secs_f64().to_string().as_bytes())?)
    }

    /// Trains on a dataset, for the share of the time that is this step's.
    pub fn train(&self, step: usize, dataset: &Path, output: &Path) -> Result<()> {
        let mut training = self.arguments.training.clone();
        training.settings.budget = self.budget.map(|budget| budget.mul_f64(SHARES[step]));
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

/// The time of the bake in which a dataset was finished. An older version did not tell: its datasets are kept.
fn given(seconds: &[u8]) -> Duration {
    let seconds = str::from_utf8(seconds).ok().and_then(|text| text.parse().ok());
    seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()).unwrap_or(Duration::MAX)
}
