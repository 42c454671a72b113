//! Pictures of the frames with most penetration, before and after its repair.

use crate::pages::html::picture;
use crate::pictures::{View, comparison};
use ctsn_core::Streams;
use ctsn_core::model::HostModel;
use ctsn_rig::Result;
use ctsn_train::dataset::Sample;
use ctsn_train::judging::{FrameErrors, Judge, Report, predictions, without_repair};
use maud::{Markup, html};

/// Frames shown.
const FRAMES: usize = 10;

/// Caption, and two pictures per view: before and after.
pub(super) type Repaired = (String, Vec<Markup>);

/// Pictures of the frames of `report` with most vertices inside the body before the repair. `sample` finds the sample
/// of a frame. Empty where the model repairs nothing.
pub(super) fn pictures<'s>(
    model: &HostModel,
    judge: &Judge,
    report: &Report,
    triangles: &[[u32; 3]],
    views: &[View],
    sample: impl Fn(&FrameErrors) -> Option<&'s Sample>,
) -> Result<Vec<Repaired>> {
    let Some(bare) = without_repair(model) else { return Ok(Vec::new()) };
    let inside = |frame: &FrameErrors| frame.unrepaired.map_or(0.0, |frame| frame.penetrating);
    let mut frames: Vec<&FrameErrors> = report.frames.iter().collect();
    frames.sort_by(|a, b| inside(b).total_cmp(&inside(a)));
    let (frames, samples): (Vec<_>, Vec<_>) =
        frames.into_iter().take(FRAMES).filter_map(|frame| Some((frame, sample(frame)?))).unzip();
    let [before, after] = [&bare, model].map(|model| predictions(model, judge, &samples, Streams::Both));
    let mut repaired = Vec::new();
    for ((frame, sample), (before, after)) in frames.iter().zip(&samples).zip(before?.iter().zip(&after?)) {
        let (character, pose) = judge.figure(sample);
        let rows = comparison(character, &pose, triangles, &[(before, &[]), (after, &[])], views);
        let pictures = rows.iter().flat_map(|row| row.iter().zip(["before", "after"]));
        let pictures = pictures.map(|(image, what)| picture(image, what)).collect::<Result<_>>()?;
        repaired.push((caption(frame), pictures));
    }
    Ok(repaired)
}

fn caption(frame: &FrameErrors) -> String {
    let (before, after) = (frame.unrepaired.unwrap_or_default(), frame.network);
    format!(
        "{} {}: inside {:.1} → {:.2} %, deepest {:.1} → {:.1} mm, edges crossing {:.1} → {:.2} %",
        frame.clip,
        frame.frame,
        100.0 * before.penetrating,
        100.0 * after.penetrating,
        1e3 * before.depth,
        1e3 * after.depth,
        100.0 * before.crossing,
        100.0 * after.crossing
    )
}

/// The pictures with their captions.
pub(super) fn markup(repaired: &[Repaired]) -> Markup {
    html! {
        @if !repaired.is_empty() {
            h2 { "Repair of penetration" }
            p { "The frames with most vertices inside the body before the repair, worst first." }
        }
        @for (caption, pictures) in repaired {
            h3 { (caption) }
            div class="views two" {
                span { "before" } span { "after" }
                @for picture in pictures { (picture) }
            }
        }
    }
}
