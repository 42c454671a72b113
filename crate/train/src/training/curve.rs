//! The learning curve: one row per epoch, as CSV beside the model. Columns: `epoch`, `NAME_loss` of each loss in its
//! unit, `validation_distance` (metres), `validation_normal` (degrees), `validation_bending` (a ratio; empty where
//! nothing bends), `learning_rate`, `seconds`.

use crate::{Error, Result};
use ctsn_rig::file;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// One epoch.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Epochs done, from 1.
    pub epoch: usize,
    /// Name and mean of each loss over the epoch.
    pub losses: Vec<(String, f32)>,
    /// E_dist on the validation slice, metres; the weighted sum of the losses in a training without truth.
    pub distance: f32,
    /// E_norm on the validation slice, degrees.
    pub normal: f32,
    /// How much predictions of the validation slice bend, over how much its truth does; `None` where that does not, and
    /// in curves of older versions.
    pub bending: Option<f32>,
    /// Adam's learning rate at the end of the epoch.
    pub rate: f32,
    /// Seconds of training so far.
    pub seconds: f64,
}

const BENDING: &str = "validation_bending";

/// How many times the least E_dist is as good as that.
const NEAR: f32 = 1.02;

/// Ends the name of a loss's column.
const LOSS: &str = "_loss";

impl Row {
    /// Whether there was a truth to compare with.
    pub fn is_judged(&self) -> bool {
        ["fine", "smooth"].iter().any(|name| self.loss(name).is_some())
    }

    /// Whether it is kept in place of `kept`, the best before; `least`: the least E_dist so far, its own among them.
    fn is_better(&self, kept: &Self, least: f32) -> bool {
        if self.normal == 0.0 {
            return self.distance < kept.distance;
        }
        let near = |row: &Self| row.distance <= NEAR * least;
        let error = |row: &Self| row.distance * row.normal;
        near(self) && (!near(kept) || error(self) < error(kept))
    }

    /// The mean of the loss of that name.
    pub fn loss(&self, name: &str) -> Option<f32> {
        self.losses.iter().find(|(known, _)| known == name).map(|(_, value)| *value)
    }
}

/// The best epoch: of those near the least E_dist so far that of the least E_dist times E_norm; of the least `distance`
/// where nothing was validated. E_dist soon stands still: by it alone the best is a matter of chance, and later epochs,
/// whose folds are nearer, are passed over. By the product alone an epoch may be kept that is hardly nearer than plain
/// skinning, as without a skeleton stream. docs/decisions/training.md
pub(super) fn best(rows: &[Row]) -> Option<&Row> {
    let mut least = f32::INFINITY;
    rows.iter().reduce(|kept, row| {
        least = least.min(kept.distance).min(row.distance);
        if row.is_better(kept, least) { row } else { kept }
    })
}

/// Writes the curve; rows of one training have the same losses.
pub(super) fn write(path: &Path, rows: &[Row]) -> Result<()> {
    let losses = rows.first().map_or(&[][..], |row| &row.losses);
    let names = losses.iter().map(|(name, _)| format!("{name}{LOSS}"));
    let after = ["validation_distance", "validation_normal", BENDING, "learning_rate", "seconds"].map(str::to_owned);
    let mut table = csv::Writer::from_writer(Vec::new());
    let mut line = |cells: Vec<String>| table.write_record(cells).map_err(|error| wrong(path, error.to_string()));
    line(["epoch".to_owned()].into_iter().chain(names).chain(after).collect())?;
    for Row { epoch, losses, distance, normal, bending, rate, seconds } in rows {
        let values = losses.iter().map(|(_, value)| value).chain([distance, normal]).map(f32::to_string);
        let bending = bending.map_or_else(String::new, |bending| bending.to_string());
        let after = [bending, rate.to_string(), format!("{seconds:.3}")];
        line([epoch.to_string()].into_iter().chain(values).chain(after).collect())?;
    }
    let bytes = table.into_inner().map_err(|error| wrong(path, error.to_string()))?;
    file::write(path, &bytes)
}

/// Reads a curve, whatever its losses.
pub fn read(path: &Path) -> Result<Vec<Row>> {
    let bytes = file::read(path)?;
    let mut table = csv::Reader::from_reader(bytes.as_slice());
    let heads = table.headers().map_err(|error| wrong(path, error.to_string()))?.clone();
    let place = |name: &str| {
        let missing =
            || wrong(path, format!("wanted a column {name}, found {}", heads.iter().collect::<Vec<_>>().join(", ")));
        heads.iter().position(|head| head == name).ok_or_else(missing)
    };
    let losses = heads.iter().enumerate().filter_map(|(i, head)| Some((i, head.strip_suffix(LOSS)?)));
    let losses: Vec<(usize, &str)> = losses.collect();
    let [epoch, seconds] = [place("epoch")?, place("seconds")?];
    let [distance, normal, rate] =
        [place("validation_distance")?, place("validation_normal")?, place("learning_rate")?];
    let bending = heads.iter().position(|head| head == BENDING);
    let row = |record: csv::Result<csv::StringRecord>| {
        let record = record.map_err(|error| wrong(path, error.to_string()))?;
        let float = |i: usize| number::<f32>(path, &record, i);
        let loss = |(i, name): &(usize, &str)| Ok(((*name).to_owned(), float(*i)?));
        Ok(Row {
            epoch: number(path, &record, epoch)?,
            losses: losses.iter().map(loss).collect::<Result<_>>()?,
            distance: float(distance)?,
            normal: float(normal)?,
            bending: bending.filter(|cell| !record[*cell].is_empty()).map(float).transpose()?,
            rate: float(rate)?,
            seconds: number(path, &record, seconds)?,
        })
    };
    table.records().map(row).collect()
}

fn number<T: std::str::FromStr>(path: &Path, record: &csv::StringRecord, cell: usize) -> Result<T> {
    let found = record.get(cell).unwrap_or_default();
    let line = record.position().map_or(0, csv::Position::line);
    found.parse().map_err(|_| wrong(path, format!("line {line}: wanted a number, found {found:?}")))
}

fn wrong(path: &Path, reason: String) -> Error {
    Error::File { path: path.to_owned(), reason }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_the_least_distance_normals_choose_the_epoch() {
        let row = |(i, [distance, normal]): (usize, [f32; 2])| Row { epoch: i + 1, distance, normal, ..Row::default() };
        let kept = |errors: &[[f32; 2]]| {
            let rows: Vec<Row> = errors.iter().copied().enumerate().map(row).collect();
            best(&rows).map(|best| best.epoch)
        };
        assert_eq!(kept(&[]), None);
        assert_eq!(kept(&[[0.034, 6.0], [0.020, 12.0], [0.0203, 11.0], [0.0206, 9.0]]), Some(3), "9° is too far off");
        assert_eq!(kept(&[[0.0203, 10.0], [0.020, 11.1], [0.0198, 11.5]]), Some(3), "the first is no longer near");
        assert_eq!(kept(&[[0.020, 11.0], [0.0203, 10.9]]), Some(1), "what normals gain is less than is lost");
        assert_eq!(kept(&[[0.9, 0.0], [0.899, 0.0], [0.8995, 0.0]]), Some(2), "without truth");
    }

    #[test]
    fn what_is_written_is_read_and_what_is_broken_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("curve.csv");
        let losses = vec![("bend, J".to_owned(), -1.5), ("fine".to_owned(), 0.015_678_9)];
        let first =
            Row { epoch: 1, losses, distance: 0.02, normal: 11.25, bending: Some(1.25), rate: 1e-3, seconds: 0.1 };
        let rows = [first.clone(), Row { epoch: 2, bending: None, seconds: 12.345, ..first }];
        write(&path, &rows).unwrap();
        assert_eq!(read(&path).unwrap(), rows);
        let text = std::fs::read_to_string(&path).unwrap();
        let refused = |text: String| {
            std::fs::write(&path, text).unwrap();
            read(&path).unwrap_err().to_string()
        };
        let message = refused(text.replace("11.25", "fox"));
        assert!(message.contains("curve.csv") && message.contains("line 2") && message.contains("fox"), "{message}");
        let message = refused(text.replace("seconds", "hours"));
        assert!(message.contains("wanted a column seconds") && message.contains("hours"), "{message}");
        let message = refused(text.replace("2,-1.5,", "2,"));
        assert!(message.contains("curve.csv") && message.contains("line: 3"), "{message}");
    }
}
