//! What a training needs of a dataset: poses to learn from, and poses to steer it by. Unseen clips do neither.

use crate::dataset::{Dataset, Sample, Split};
use crate::{Error, Result};

/// Fewest poses that are worth training on.
pub const POSES: usize = 50;

/// The poses of a training.
#[derive(Clone, Debug)]
pub struct Slices<'a> {
    /// What is learned from, mixed poses last, behind them [`mirrored`](super::mirrored) ones, if they are added.
    pub train: Vec<&'a Sample>,
    /// What the skeleton stream alone learns from: poses whose cloth was simulated coarsely, with their images.
    pub coarse: Vec<&'a Sample>,
    /// How many of `train` are mixed poses.
    pub mixed: usize,
    /// How many of `train` are images of the others, and how many of `coarse`.
    pub images: [usize; 2],
    /// What is predicted after every epoch.
    pub validation: Vec<&'a Sample>,
}

impl<'a> Slices<'a> {
    /// Adds images of the poses to learn from.
    pub fn add(&mut self, images: &'a [Sample], coarse: &'a [Sample]) {
        self.images = [images.len(), coarse.len()];
        self.train.extend(images);
        self.coarse.extend(coarse);
    }

    /// Numbers of simulated poses in `train` and in `coarse`: without images.
    pub fn simulated(&self) -> [usize; 2] {
        [self.train.len() - self.images[0], self.coarse.len() - self.images[1]]
    }

    /// Every pose that something is learned from.
    pub fn learned(&self) -> Vec<&'a Sample> {
        [&self.train[..], &self.coarse].concat()
    }
}

/// The poses of `dataset` to train with; checks that there is enough of everything.
pub fn slices(dataset: &Dataset) -> Result<Slices<'_>> {
    let (poses, clips) = (dataset.samples.len(), dataset.setup.description.clips.len());
    if poses < POSES {
        let rejected = dataset.rejected.len();
        return Err(Error::Dataset(format!(
            "wanted at least {POSES} poses, found {poses} ({rejected} were left out by the simulation)"
        )));
    }
    let (mut train, mut validation) = (dataset.split(Split::Train), dataset.split(Split::Validation));
    // With ten to fourteen clips one is watched, and the simulation may have left it out whole. No reason to refuse an
    // hour of simulated poses. The last tenth of the others, not every tenth: neighbours are nearly the same pose. (It
    // flatters a little: mixed poses may have limbs of them.)
    if validation.is_empty() {
        validation = train.split_off(train.len() - train.len().div_ceil(10));
    }
    train.extend(&dataset.mixed);
    for (name, split) in [("training", &train), ("validation", &validation)] {
        if split.is_empty() {
            return Err(Error::Dataset(format!("the {name} split is empty: {poses} poses of {clips} clips in all")));
        }
    }
    let coarse = dataset.coarse.iter().collect();
    Ok(Slices { train, coarse, mixed: dataset.mixed.len(), images: [0; 2], validation })
}
