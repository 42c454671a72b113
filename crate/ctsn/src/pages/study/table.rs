//! The tables of a study, as text in Markdown or on its page.

use crate::pages::html::{self, Cell};
use ctsn_train::judging::Errors;
use ctsn_train::methods::{Entry, Outcome, Study, Table, front, recommended};
use maud::Markup;

/// A table with its title and a note.
pub struct Grid {
    /// Title.
    pub title: &'static str,
    /// Below the title.
    pub note: String,
    heads: Vec<&'static str>,
    /// Each a name and its cells.
    rows: Vec<(String, Vec<String>)>,
}

/// Columns of the errors.
const ERRORS: [&str; 5] = ["E_dist, mm", "95 %", "E_norm, °", "95 %", "inside, %"];

fn errors(errors: &Errors) -> Vec<String> {
    let (distance, normal) = (errors.distance, errors.normal);
    vec![
        format!("{:.2} ± {:.2}", 1e3 * distance.mean, 1e3 * distance.std),
        format!("{:.2}", 1e3 * distance.p95),
        format!("{:.2} ± {:.2}", normal.mean, normal.std),
        format!("{:.2}", normal.p95),
        format!("{:.2}", 100.0 * errors.penetrating),
    ]
}

/// MB and Mflop.
fn costs(outcome: &Outcome) -> [String; 2] {
    [outcome.bytes, outcome.flops].map(|count| format!("{:.2}", count as f64 / 1e6))
}

/// (operations, validation error) of each outcome.
pub fn points(outcomes: &[Outcome]) -> Vec<(f64, f64)> {
    outcomes.iter().map(|outcome| (outcome.flops as f64, outcome.validation)).collect()
}

impl Grid {
    /// The grid of `table`, from its entries and their outcomes.
    pub fn new(table: Table, study: &Study, entries: &[Entry], outcomes: &[Outcome]) -> Self {
        let [train, validation, unseen] = study.poses();
        let poses = format!(
            "Trained on {train} poses, epoch chosen by {validation}, errors on {unseen} unseen; without repair of \
            penetration."
        );
        let pairs = || entries.iter().zip(outcomes);
        let plain = |(entry, outcome): (&Entry, &Outcome)| {
            (entry.title.clone(), errors(&outcome.errors).into_iter().chain(costs(outcome)).collect())
        };
        let heads: Vec<&str> = std::iter::once("").chain(ERRORS).chain(["MB", "Mflop"]).collect();
        match table {
            Table::Comparison => Self {
                title: "Comparison",
                note: format!(
                    "{poses} The older methods have the networks of their papers, but the same truth and optimiser."
                ),
                heads,
                rows: pairs().map(plain).collect(),
            },
            Table::Ablation => {
                let truth = ("(a) simulation".to_owned(), errors(&study.truth()));
                let blank = |(name, mut cells): (String, Vec<String>)| {
                    cells.resize(ERRORS.len() + 2, "–".to_owned());
                    (name, cells)
                };
                let rows = std::iter::once(blank(truth)).chain(pairs().map(plain)).collect();
                Self { title: "Ablation", note: format!("The letters are the paper's. {poses}"), heads, rows }
            }
            Table::Sizes => Self {
                title: "Sizes of the residual streams",
                note: "MB: the model file, learned numbers in F16.".to_owned(),
                heads,
                rows: pairs().map(plain).collect(),
            },
            Table::Front => Self::front(entries, outcomes, validation),
        }
    }

    fn front(entries: &[Entry], outcomes: &[Outcome], validation: usize) -> Self {
        let points = points(outcomes);
        let (front, chosen) = (front(&points), recommended(&points));
        let row = |(i, (entry, outcome)): (usize, (&Entry, &Outcome))| {
            let mark = match (chosen == Some(i), front.contains(&i)) {
                (true, _) => "recommended",
                (false, true) => "on it",
                (false, false) => "",
            };
            let [megabytes, megaflops] = costs(outcome);
            let validation = format!("{:.2}", 1e3 * outcome.validation);
            let unseen = format!("{:.2}", 1e3 * outcome.errors.distance.mean);
            (entry.title.clone(), vec![megaflops, megabytes, validation, unseen, mark.to_owned()])
        };
        let mut rows: Vec<_> = entries.iter().zip(outcomes).enumerate().map(row).collect();
        rows.sort_by(|a, b| a.1[0].parse::<f64>().unwrap_or(0.0).total_cmp(&b.1[0].parse().unwrap_or(0.0)));
        let cheapest = "the cheapest within 2 % of the smallest error";
        let told = chosen.map(|i| format!("Recommended: {}: {cheapest}.", entries[i].title));
        Self {
            title: "Error against arithmetic",
            note: format!("The front by the error on the {validation} validation poses. {}", told.unwrap_or_default()),
            heads: vec!["", "Mflop", "MB", "E_dist, validation, mm", "E_dist, unseen, mm", "front"],
            rows,
        }
    }

    /// For the page.
    pub(super) fn markup(&self) -> Markup {
        let cells =
            |(name, cells): &(String, Vec<String>)| (name.clone(), cells.iter().cloned().map(Cell::Text).collect());
        html::table(&self.heads, &self.rows.iter().map(cells).collect::<Vec<_>>())
    }
}

impl std::fmt::Display for Grid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let rows: Vec<Vec<&str>> =
            std::iter::once(self.heads.clone())
                .chain(self.rows.iter().map(|(name, cells)| {
                    std::iter::once(name.as_str()).chain(cells.iter().map(String::as_str)).collect()
                }))
                .collect();
        let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0).max(2);
        let widths: Vec<usize> = (0..self.heads.len()).map(width).collect();
        writeln!(f, "## {}\n\n{}\n", self.title, self.note)?;
        for (i, row) in rows.iter().enumerate() {
            let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, width))| {
                if column == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
            });
            writeln!(f, "| {} |", cells.collect::<Vec<_>>().join(" | "))?;
            if i == 0 {
                let rules = widths.iter().enumerate().map(|(column, width)| {
                    if column == 0 { "-".repeat(*width) } else { format!("{}:", "-".repeat(width - 1)) }
                });
                writeln!(f, "| {} |", rules.collect::<Vec<_>>().join(" | "))?;
            }
        }
        Ok(())
    }
}
