//! Self-contained pages to read in any browser: one style sheet, charts as SVG, pictures as data; no script, nothing
//! fetched.

pub mod chart;

use crate::pictures::png;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use ctsn_rig::Result;
use image::RgbImage;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// A whole page.
pub fn page(title: &str, body: Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(include_str!("style.css"))) }
            }
            body { main { (body) } }
        }
    };
    page.into_string()
}

/// A cell of a table.
pub enum Cell {
    /// Text, aligned as numbers are.
    Text(String),
    /// A number, and behind it a bar over that share of the column.
    Bar(String, f64),
}

/// A table: heads, then rows of a name and its cells. A wide one scrolls within the page.
pub fn table(heads: &[&str], rows: &[(String, Vec<Cell>)]) -> Markup {
    html! {
        div class="scroll" {
            table {
                thead { tr { @for head in heads { th scope="col" { (head) } } } }
                tbody {
                    @for (name, cells) in rows {
                        tr {
                            th scope="row" { (name) }
                            @for cell in cells {
                                @match cell {
                                    Cell::Text(text) => td { (text) },
                                    Cell::Bar(text, share) => td {
                                        span class="bar" style=(format!("--share:{:.1}%", 100.0 * share.clamp(0.0, 1.0))) {}
                                        span class="number" { (text) }
                                    },
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// A picture inside the page.
pub fn picture(image: &RgbImage, what: &str) -> Result<Markup> {
    let source = format!("data:image/png;base64,{}", STANDARD.encode(png(image)?));
    Ok(html! { img src=(source) alt=(what) width=(image.width()) height=(image.height()) loading="lazy"; })
}
