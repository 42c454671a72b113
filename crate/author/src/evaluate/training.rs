//! The learning curves of a training, from the file that it leaves beside the model (`ctsn train`, MODEL.curve.csv).

use crate::html::chart::{Chart, Series};
use crate::{Error, Result};
use std::path::Path;

/// Name of a column and what it is called in a legend; errors in metres.
const DISTANCES: [(&str, &str); 3] = [
    ("fine_loss", "E_dist, poses learned from"),
    ("validation_distance", "E_dist, validation poses"),
    ("coarse_loss", "skeleton stream against the smoothed truth"),
];

/// A column of the curve by epoch.
fn column(path: &Path, text: &str, name: &str, unit: f64) -> Result<Vec<(f64, f64)>> {
    let wrong = |reason: String| Error::File { path: path.to_owned(), reason };
    let mut lines = text.lines();
    let heads: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let place = |name: &str| {
        let found = heads.iter().position(|head| *head == name);
        found.ok_or_else(|| wrong(format!("wanted a column {name}, found {}", heads.join(", "))))
    };
    let (epoch, value) = (place("epoch")?, place(name)?);
    let number = |line: usize, text: Option<&&str>| {
        let found = text.copied().unwrap_or_default();
        found.parse::<f64>().map_err(|_| wrong(format!("line {}: wanted a number, found {found:?}", line + 2)))
    };
    let point = |(i, line): (usize, &str)| {
        let cells: Vec<&str> = line.split(',').collect();
        Ok((number(i, cells.get(epoch))?, number(i, cells.get(value))? * unit))
    };
    lines.enumerate().map(point).collect()
}

/// Charts of the curve at `path`; none where no training left one.
pub fn curves(path: &Path) -> Result<Vec<Chart<'static>>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let bytes = crate::dataset::read(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let line = |(name, legend): (&str, &str), unit: f64| {
        Ok(Series { name: legend.to_owned(), points: column(path, &text, name, unit)?, line: true })
    };
    let distances = DISTANCES.into_iter().map(|column| line(column, 1e3)).collect::<Result<_>>()?;
    let normals = vec![line(("validation_normal", "E_norm, validation poses"), 1.0)?];
    let chart = |y, logarithmic, series| Chart { x: "epoch", y, logarithmic: [false, logarithmic], series };
    Ok(vec![chart("mm", true, distances), chart("degrees", false, normals)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_becomes_two_charts_and_a_broken_one_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("model.curve.csv");
        assert!(curves(&path).expect("no charts").is_empty());
        let heads =
            "epoch,coarse_loss,fine_loss,penetration_loss,validation_distance,validation_normal,learning_rate,seconds";
        let write = |rows: &str| std::fs::write(&path, format!("{heads}\n{rows}\n")).expect("a file");
        write("1,0.02,0.03,0.001,0.04,12.5,0.001,3.0\n2,0.01,0.02,0.001,0.03,11.5,0.001,6.0");
        let charts = curves(&path).expect("charts");
        assert_eq!(charts[0].series[1].points, [(1.0, 40.0), (2.0, 30.0)], "millimetres");
        assert_eq!(charts[1].series[0].points, [(1.0, 12.5), (2.0, 11.5)]);
        write("1,0.02,0.03,0.001,fox,12.5,0.001,3.0");
        let message = curves(&path).err().expect("an error").to_string();
        assert!(
            message.contains("model.curve.csv") && message.contains("line 2") && message.contains("fox"),
            "{message}"
        );
    }
}
