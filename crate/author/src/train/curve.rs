//! The learning curve: one row per epoch, as CSV beside the model.

use crate::Result;
use crate::dataset::write;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// One epoch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Epochs done, from 1.
    pub epoch: usize,
    /// Mean training loss of the coarse prediction against the smoothed truth, metres.
    pub coarse: f32,
    /// Mean training loss of the whole prediction against the truth, metres.
    pub fine: f32,
    /// Mean of what predictions lack to the gap around the body, metres: see [`Loss`](super::Loss).
    pub penetration: f32,
    /// E_dist on the validation slice, metres.
    pub distance: f32,
    /// E_norm on the validation slice, degrees.
    pub normal: f32,
    /// Adam's learning rate at the end of the epoch.
    pub rate: f32,
    /// Seconds of training so far.
    pub seconds: f64,
}

/// Writes the curve: a line of names, then a line per row, metres, degrees and seconds.
pub fn write_curve(path: &Path, rows: &[Row]) -> Result<()> {
    let mut text =
        "epoch,coarse_loss,fine_loss,penetration_loss,validation_distance,validation_normal,learning_rate,seconds\n"
            .to_owned();
    for Row { epoch, coarse, fine, penetration, distance, normal, rate, seconds } in rows {
        text += &format!("{epoch},{coarse},{fine},{penetration},{distance},{normal},{rate},{seconds:.1}\n");
    }
    write(path, text.as_bytes())
}
