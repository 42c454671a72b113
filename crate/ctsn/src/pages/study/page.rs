//! A study as one page: its tables, and a chart of the front (the sizes that no cheaper one beats).

use super::Grid;
use super::table::points;
use crate::pages::html::chart::{Chart, Series};
use crate::pages::html::page;
use ctsn_rig::Result;
use ctsn_train::methods::{Entry, Outcome, front};
use maud::{Markup, html};

/// The page of `grids`; `sizes` are the entries of the front, if it was wanted.
pub fn study(title: &str, grids: &[Grid], sizes: &[(Entry, Outcome)]) -> Result<String> {
    let chart = chart(sizes)?;
    let body = html! {
        h1 { (title) }
        p class="soft" {
            "Ways to predict cloth, trained on the same poses by the same optimiser, compared on poses none has seen."
        }
        @for grid in grids {
            h2 { (grid.title) }
            p { (grid.note) }
            (grid.markup())
        }
        (chart)
    };
    Ok(page(title, body))
}

fn chart(sizes: &[(Entry, Outcome)]) -> Result<Markup> {
    let outcomes: Vec<Outcome> = sizes.iter().map(|(_, outcome)| outcome.clone()).collect();
    let points: Vec<(f64, f64)> = points(&outcomes).iter().map(|(flops, error)| (flops / 1e6, 1e3 * error)).collect();
    let front = front(&points).into_iter().map(|i| points[i]).collect();
    let series = vec![
        Series { name: "sizes of the network".to_owned(), points, line: false },
        Series { name: "front".to_owned(), points: front, line: true },
    ];
    let chart =
        Chart { x: "Mflop a prediction", y: "E_dist, validation, mm", logarithmic: [true, false], series }.draw()?;
    Ok(html! { div class="charts" { (chart) } })
}
