//! The report on a terminal: one row per way to predict.

use super::{Report, Statistic};

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (frames, clips) = (self.frames.len(), self.clips.len());
        let left_out = format!("{} poses were left out by the simulation", self.rejected);
        writeln!(f, "{} on {}: {frames} unseen frames of {clips} clips; {left_out}", self.garment, self.character)?;
        let heads =
            ["E_dist mm", "95 %", "E_norm deg", "95 %", "inside %", "depth mm", "cross %", "stretch %", "m/s²", "slow"];
        writeln!(
            f,
            "{:<16}{:>16}{:>8}{:>16}{:>8}{:>10}{:>10}{:>9}{:>11}{:>8}{:>8}",
            "", heads[0], heads[1], heads[2], heads[3], heads[4], heads[5], heads[6], heads[7], heads[8], heads[9]
        )?;
        let rows = [
            ("network", Some(&self.network)),
            ("not repaired", self.unrepaired.as_ref()),
            ("skeleton stream", Some(&self.skeleton)),
            ("plain skinning", Some(&self.skinning)),
            ("simulation", Some(&self.truth)),
        ];
        for (name, errors) in rows.into_iter().filter_map(|(name, errors)| Some((name, errors?))) {
            let pair =
                |statistic: Statistic, unit: f64| format!("{:.2} ± {:.2}", statistic.mean * unit, statistic.std * unit);
            let (distance, normal) = (pair(errors.distance, 1e3), pair(errors.normal, 1.0));
            let tails = (errors.distance.p95 * 1e3, errors.normal.p95);
            let (inside, depth, stretch) = (errors.penetrating * 100.0, errors.depth * 1e3, errors.stretch * 100.0);
            let [jitter, slow] = [errors.jitter, errors.slow_jitter]
                .map(|jitter| jitter.map_or("-".to_owned(), |jitter| format!("{jitter:.2}")));
            write!(f, "{name:<16}{distance:>16}{:>8.2}{normal:>16}{:>8.2}", tails.0, tails.1)?;
            let crossing = errors.crossing * 100.0;
            writeln!(f, "{inside:>10.3}{depth:>10.1}{crossing:>9.3}{stretch:>11.2}{jitter:>8}{slow:>8}")?;
        }
        let (share, size, scaled) = (self.ratio * 100.0, self.size, self.network.scaled);
        write!(
            f,
            "network: {share:.1} % of plain skinning's E_dist; {scaled:.2} mm per metre of the figure ({size:.2} m)"
        )
    }
}
