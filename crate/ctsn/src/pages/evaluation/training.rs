//! The learning curves of a training, from the file that it leaves beside the model (`ctsn train`, MODEL.curve.csv).

use crate::pages::html::chart::{Chart, Series};
use ctsn_rig::Result;
use ctsn_train::loss::{LOSSES, TEACHER};
use ctsn_train::training::curve::{Row, read};
use std::path::Path;

/// Charts of the curve at `path`, one for each unit of its losses; none where no training left one.
pub fn curves(path: &Path) -> Result<Vec<Chart<'static>>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let rows = read(path)?;
    let series = |name: &str, value: &dyn Fn(&Row) -> f32, scale: f32| {
        let point = |row: &Row| (row.epoch as f64, f64::from(value(row) * scale));
        Series { name: name.to_owned(), points: rows.iter().map(point).collect(), line: true }
    };
    let chart = |y, logarithmic, series| Chart { x: "epoch", y, logarithmic: [false, logarithmic], series };
    let validation = series("E_dist, validation poses", &|row| row.distance, 1e3);
    let mut charts = vec![
        chart("mm", true, vec![validation]),
        chart("degrees", false, vec![series("E_norm, validation poses", &|row| row.normal, 1.0)]),
    ];
    if rows.first().is_some_and(|row| !row.is_judged()) {
        charts.clear();
    }
    for (i, (name, _)) in rows.first().map_or(&[][..], |row| &row.losses).iter().enumerate() {
        let term = LOSSES.iter().chain(TEACHER).find(|term| term.name == name);
        let unit = term.map_or("", |term| term.unit);
        let (unit, scale) = if unit == "m" { ("mm", 1e3) } else { (unit, 1.0) };
        let loss = series(term.map_or(name, |term| term.title), &|row| row.losses[i].1, scale);
        match charts.iter_mut().find(|chart| chart.y == unit) {
            Some(chart) => chart.series.push(loss),
            None => charts.push(chart(unit, false, vec![loss])),
        }
    }
    Ok(charts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pages::html::chart::COLOURS;

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
        let points = |name: &str| &charts[0].series.iter().find(|series| series.name == name).expect("a line").points;
        assert_eq!(*points("E_dist, validation poses"), [(1.0, 40.0), (2.0, 30.0)], "millimetres");
        assert_eq!(*points("E_dist, poses learned from"), [(1.0, 30.0), (2.0, 20.0)], "millimetres");
        assert_eq!(charts[0].series.len(), 4, "every loss in metres");
        assert_eq!(charts[1].series[0].points, [(1.0, 12.5), (2.0, 11.5)]);
        write("1,0.02,0.03,0.001,fox,12.5,0.001,3.0");
        let message = curves(&path).err().expect("an error").to_string();
        assert!(
            message.contains("model.curve.csv") && message.contains("line 2") && message.contains("fox"),
            "{message}"
        );
    }

    #[test]
    fn every_line_of_a_chart_has_a_colour_of_its_own() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("model.curve.csv");
        let (heads, row): (String, String) =
            LOSSES.iter().map(|term| (format!("{}_loss,", term.name), "0.01,")).unzip();
        let rest = "validation_distance,validation_normal,learning_rate,seconds";
        std::fs::write(&path, format!("epoch,{heads}{rest}\n1,{row}0.04,12.5,0.001,3.0\n")).expect("a file");
        for chart in curves(&path).expect("charts") {
            assert!(chart.series.len() <= COLOURS.len(), "{}: {} lines", chart.y, chart.series.len());
        }
    }
}
