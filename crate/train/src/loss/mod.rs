//! What training minimises: a weighted sum of losses, one file each. The learning curve, the checkpoint's key and the
//! watch for divergence follow from [`LOSSES`]; docs/extending.md says how to add one. Positions are metres in the body
//! frame, y up. network.md §6.

mod coarse;
mod contact;
mod curvature;
mod distance;
mod energy;
mod fine;
mod penetration;
mod smooth;
mod start;
#[cfg(test)]
mod tests;

use crate::Result;
use crate::dataset::Setup;
use crate::training::Variant;
use ctsn_core::model::HostModel;
use ctsn_core::pose::BodyFrame;

/// Every loss of a training on simulated poses.
pub const LOSSES: &[Term] =
    &[coarse::COARSE, start::START, fine::FINE, CURVATURE, penetration::PENETRATION, energy::TENSION];

pub(crate) use curvature::{CURVATURE, emphasis};

/// Every loss of a training without truth: the sum is what a simulation minimises.
pub const SELF_SUPERVISED: &[Term] = &[energy::ENERGY, contact::CONTACT];

/// Every loss of a teacher, from whose predictions truth is relaxed: the simulated poses say where the cloth is, its
/// own energy how it folds.
pub const TEACHER: &[Term] = &[smooth::SMOOTH, energy::ENERGY, contact::CONTACT];

/// One term of the sum: what the list tells of a loss.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    /// Its column in the learning curve is `NAME_loss`.
    pub name: &'static str,
    /// What the legend of a chart calls it.
    pub title: &'static str,
    /// Unit of its value: `m`, `J`.
    pub unit: &'static str,
    /// What one unit counts in the sum.
    pub weight: f32,
    /// Other constants of it that decide what is learned. With name and weight they are part of the checkpoint's key.
    pub constants: &'static [f32],
    /// What it reads of a simulated pose, coarse before whole; its value is that of the last.
    pub simulated: &'static [Prediction],
    /// What it reads of a pose that nobody simulated, in the same order.
    pub unsimulated: &'static [Prediction],
    /// Makes it, one for each thread.
    pub new: fn(&Scene) -> Made,
}

/// A loss that was made; `None` where the training has nothing for it to do.
pub type Made = Result<Option<Box<dyn Loss>>>;

/// What is known of a pose's cloth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Known {
    /// The simulated cloth.
    Truth,
    /// Where it lies without its fine folds: a thinned garment was simulated.
    Coarse,
    /// Nothing.
    Nothing,
}

/// A prediction of the network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prediction {
    /// By the skeleton stream alone. The whole one where an ablation leaves one stream.
    Coarse,
    /// By all that the training runs, before it is polished. The whole one where nothing is.
    Start,
    /// By all that the training runs.
    Whole,
}

impl Prediction {
    /// From the first that is made to the last.
    pub(crate) const ALL: [Self; 3] = [Self::Coarse, Self::Start, Self::Whole];
}

/// What a loss is made for.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// The model before its first step.
    pub model: &'a HostModel,
    /// Cloth, body, joints, fabric.
    pub setup: &'a Setup,
    /// The parts of the network that learn.
    pub variant: Variant,
}

/// A loss: a number of a prediction, and its gradient.
pub trait Loss: Send {
    /// What it wants to keep of a pose's truth [n, 3]; made once, before training.
    fn target(&self, _truth: &[f32]) -> Vec<f32> {
        Vec::new()
    }

    /// Looks at a pose, before the predictions of it.
    fn pose(&mut self, _body_frame: &BodyFrame) {}

    /// The value of `predicted` [n, 3]; its gradient times `scale` is added to `gradient` [n, 3]. `target` is what
    /// [`Self::target`] made, empty where nobody simulated the pose.
    fn value(&mut self, predicted: &[f32], target: &[f32], scale: f32, gradient: &mut [f32]) -> f32;
}

impl Term {
    /// Whether it reads that prediction of a pose. Of coarsely simulated cloth only the skeleton stream learns.
    pub(crate) fn reads(&self, known: Known, prediction: Prediction) -> bool {
        match known {
            Known::Truth => self.simulated.contains(&prediction),
            Known::Coarse => prediction == Prediction::Coarse && self.simulated.contains(&prediction),
            Known::Nothing => self.unsimulated.contains(&prediction),
        }
    }

    /// Whether it reads anything of a pose.
    pub(crate) fn reads_any(&self, known: Known) -> bool {
        Prediction::ALL.iter().any(|prediction| self.reads(known, *prediction))
    }
}

/// What of `terms` decides what is learned: part of the key of a checkpoint, and of what a study's outcome is made of.
pub(crate) fn key(terms: &[Term]) -> String {
    let one = |term: &Term| format!("{} {} {:?}", term.name, term.weight, term.constants);
    terms.iter().map(one).collect::<Vec<_>>().join(" ")
}

/// The losses of one training, in the list's order; one for each thread.
pub(crate) struct Losses(Vec<(Term, Box<dyn Loss>)>);

impl Losses {
    /// Those of `terms` that have something to do.
    pub fn new(terms: &[Term], scene: &Scene) -> Result<Self> {
        let made = terms.iter().map(|term| Ok((term.new)(scene)?.map(|loss| (*term, loss))));
        Ok(Self(made.filter_map(Result::transpose).collect::<Result<_>>()?))
    }

    /// What the list tells of them.
    pub fn terms(&self) -> Vec<Term> {
        self.0.iter().map(|(term, _)| *term).collect()
    }

    /// What each keeps of a truth [n, 3]; nothing where it reads none.
    pub fn targets(&self, truth: &[f32], known: Known) -> Vec<Vec<f32>> {
        let target = |(term, loss): &(Term, Box<dyn Loss>)| {
            if term.reads_any(known) { loss.target(truth) } else { Vec::new() }
        };
        self.0.iter().map(target).collect()
    }

    /// Shows them a pose.
    pub fn pose(&mut self, body_frame: &BodyFrame) {
        self.0.iter_mut().for_each(|(_, loss)| loss.pose(body_frame));
    }

    /// Makes the loss of that name, if it is among them, count so much.
    pub fn weigh(&mut self, name: &str, weight: f32) {
        self.0.iter_mut().filter(|(term, _)| term.name == name).for_each(|(term, _)| term.weight = weight);
    }

    /// Each with its number and what the list tells of it.
    pub fn each(&mut self) -> impl Iterator<Item = (usize, &Term, &mut Box<dyn Loss>)> {
        self.0.iter_mut().enumerate().map(|(i, (term, loss))| (i, &*term, loss))
    }
}

/// The weighted sum of the values' magnitudes: what must not explode. An energy may be negative.
pub(crate) fn magnitude(terms: &[Term], values: &[f32]) -> f32 {
    terms.iter().zip(values).map(|(term, value)| term.weight * value.abs()).sum()
}

/// The weighted sum of the values.
pub(crate) fn sum(terms: &[Term], values: &[f32]) -> f32 {
    terms.iter().zip(values).map(|(term, value)| term.weight * value).sum()
}

/// Names and values, for messages.
pub(crate) fn told(terms: &[Term], values: &[f32]) -> String {
    let each = terms.iter().zip(values).map(|(term, value)| format!("{} {value} {}", term.name, term.unit));
    each.collect::<Vec<_>>().join(", ")
}
