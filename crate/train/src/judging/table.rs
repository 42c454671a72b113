//! The report on a terminal: one row per way to predict.

use super::{Errors, Report, Statistic};

/// Heads of the columns after the first, and their widths.
const HEADS: [(&str, usize); 11] = [
    ("E_dist mm", 16),
    ("95 %", 8),
    ("E_norm deg", 16),
    ("95 %", 8),
    ("inside %", 10),
    ("depth mm", 10),
    ("cross %", 9),
    ("out %", 8),
    ("stretch %", 11),
    ("m/s²", 8),
    ("slow", 8),
];

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (frames, clips) = (self.frames.len(), self.clips.len());
        let left_out = format!("{} poses were left out by the simulation", self.rejected);
        let which = if self.whole { "" } else { "unseen " };
        writeln!(f, "{} on {}: {frames} {which}frames of {clips} clips; {left_out}", self.garment, self.character)?;
        write!(f, "{:<16}", "")?;
        HEADS.iter().try_for_each(|(head, width)| write!(f, "{head:>width$}"))?;
        writeln!(f)?;
        for (name, errors) in self.ways() {
            let pair =
                |statistic: Statistic, unit: f64| format!("{:.2} ± {:.2}", statistic.mean * unit, statistic.std * unit);
            let (distance, normal) = (pair(errors.distance, 1e3), pair(errors.normal, 1.0));
            let tails = (errors.distance.p95 * 1e3, errors.normal.p95);
            let (inside, depth, stretch) = (errors.penetrating * 100.0, errors.depth * 1e3, errors.stretch * 100.0);
            let [jitter, slow] = [errors.jitter, errors.slow_jitter]
                .map(|jitter| jitter.map_or("-".to_owned(), |jitter| format!("{jitter:.2}")));
            write!(f, "{name:<16}{distance:>16}{:>8.2}{normal:>16}{:>8.2}", tails.0, tails.1)?;
            let (crossing, out) = (errors.crossing * 100.0, errors.out * 100.0);
            writeln!(f, "{inside:>10.3}{depth:>10.1}{crossing:>9.3}{out:>8.1}{stretch:>11.2}{jitter:>8}{slow:>8}")?;
        }
        self.folds(f)?;
        let (share, size, scaled) = (self.ratio * 100.0, self.size, self.network.scaled);
        write!(
            f,
            "network: {share:.1} % of plain skinning's E_dist; {scaled:.2} mm per metre of the figure ({size:.2} m)"
        )
    }
}

impl Report {
    /// Whether folds are kept: the simulation's ratios are 1.
    fn folds(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let heads = ["bending", "curvature", "fine", "correl.", "strain %", "stretch %", "shear %", "energy"];
        write!(f, "{:<16}", "folds")?;
        heads.iter().try_for_each(|head| write!(f, "{head:>11}"))?;
        writeln!(f, "{:>26}", "coarse, middle, fine mm")?;
        for (name, Errors { folds, .. }) in self.ways() {
            let ratios = [folds.bending, folds.curvature, folds.fine, folds.correlation];
            write!(f, "{name:<16}")?;
            ratios.iter().try_for_each(|ratio| write!(f, "{ratio:>11.3}"))?;
            let shares = [folds.strain, folds.stretch, folds.shear].map(|share| 100.0 * share);
            shares.iter().try_for_each(|share| write!(f, "{share:>11.2}"))?;
            let [coarse, middle, fine] = folds.bands.map(|band| 1e3 * band);
            writeln!(f, "{:>11.2}{coarse:>12.2}{middle:>7.2}{fine:>7.2}", folds.energy)?;
        }
        Ok(())
    }
}
