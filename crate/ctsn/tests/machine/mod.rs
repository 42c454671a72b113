//! What a dataset says of the machines that made it.

use super::made::{Folder, write_blanket, write_character};
use serde_json::Value;

#[test]
fn a_report_names_the_level_that_poses_were_computed_at() {
    let folder = Folder::new();
    write_character(&folder, |_| ());
    write_blanket(&folder);
    let shown = folder.accepts("simulate character.glb garment.glb -o data --poses 2");
    assert!(shown.contains("computed by") && shown.contains(": 2 poses"), "{shown}");
    let report = std::fs::read(folder.path("data/report.json")).expect("a report");
    let report: Value = serde_json::from_slice(&report).expect("JSON");
    let levels = report["levels"].as_object().expect("levels");
    assert!(levels.len() == 1 && levels.values().all(|poses| poses == 2), "{levels:?}");
    assert!(levels.keys().all(|level| level.starts_with(std::env::consts::ARCH)), "{levels:?}");
}
