//! The tables and the page of `ctsn study`.

mod page;
mod table;
#[cfg(test)]
mod tests;

pub use page::study as page;
pub use table::Grid;
