//! What a bake made, as one page: the garment and what was mended of it, the poses and why some were left out, the
//! errors, what would be better, and how it comes on a page.

use super::html::{Cell, picture, table};
use crate::pictures::{Poses, sheet};
use ctsn_rig::{Character, Result};
use ctsn_train::dataset::Dataset;
use ctsn_train::report::Report;
use maud::{Markup, html};
use std::path::Path;

/// A page, as the README has it; MODEL: the file.
const PAGE: &str = "import { loadModel } from 'ctsn';
import { Cloth } from 'ctsn/three';

const model = await loadModel('MODEL');
// The character that GLTFLoader gave you; material: DoubleSide.
const cloth = new Cloth(model, gltf.scene, material);
scene.add(cloth);

renderer.setAnimationLoop(() => {
  mixer.update(timer.update().getDelta()); // three's Timer
  cloth.update();
  renderer.render(scene, camera);
});";

/// Share of the poses that a bake should keep.
const KEPT: f64 = 0.9;
/// Shares and figures beyond which something is worth saying: of the unseen frames' distance to plain skinning's.
const RATIO: f64 = 0.4;
/// Fewest poses that teach well.
const POSES: usize = 400;

/// Before the errors: the garment (see [`super::check::faults`]), and the poses it was simulated in.
pub fn before(
    garment: Markup,
    folder: &Path,
    dataset: &Dataset,
    character: &Character,
    report: &Report,
) -> Result<Markup> {
    let rows = report.reasons.iter().map(|(reason, count)| (reason.clone(), vec![Cell::Text(count.to_string())]));
    let rows: Vec<(String, Vec<Cell>)> = rows.collect();
    Ok(html! {
        (garment)
        h2 { "The poses it was simulated in" }
        p { (report.kept) " frames and " (report.mixed) " mixed poses were kept, " (report.left_out.len()) " left out." }
        @if report.coarse > 0 {
            p { (report.coarse) " more were simulated coarsely, for the smooth part of the cloth." }
        }
        (picture(&sheet(folder, dataset, character, Poses::Kept)?, "poses that were kept")?)
        @if !rows.is_empty() {
            h3 { "Left out" }
            (table(&["because", "frames"], &rows))
            (picture(&sheet(folder, dataset, character, Poses::LeftOut)?, "poses that were left out")?)
        }
    })
}

/// After the errors: what would be better, and how to use it. `ratio`: of E_dist to that of plain skinning.
pub fn after(report: &Report, ratio: f64, model: &str) -> Markup {
    let advice = advice(report, ratio);
    let code = PAGE.replace("MODEL", model);
    html! {
        h2 { "What would be better" }
        ul { @for advice in &advice { li { (advice) } } }
        h2 { "On your page" }
        p { "Put " (model) " beside the page, and the character without this garment:" }
        pre { code { (code) } }
    }
}

/// What to do better next time.
fn advice(report: &Report, ratio: f64) -> Vec<String> {
    let mut advice = Vec::new();
    let tried = report.kept + report.left_out.len();
    if (report.kept as f64) < KEPT * tried as f64 {
        let share = 100.0 * report.kept as f64 / tried.max(1) as f64;
        advice.push(format!(
            "{share:.0} % of the frames were kept; the pictures above show where cloth is caught. Clips without such poses, \
             or a looser garment, keep more"
        ));
    }
    if report.kept + report.mixed < POSES {
        advice.push(format!(
            "{} poses are few: a longer --time-budget simulates more, and each is learned from",
            report.kept + report.mixed
        ));
    }
    if ratio > RATIO {
        advice.push(format!(
            "its distance is {:.0} % of plain skinning's: motion that is more like that of your page, as clips in the \
             character's file, brings it down",
            100.0 * ratio
        ));
    }
    if advice.is_empty() {
        advice.push("nothing that these figures tell".to_owned());
    }
    advice
}
