//! The report as one page for a browser: figures, curves, and pictures with the worst frames first.

use super::pictures::Gallery;
use crate::pages::html::chart::{Chart, Series};
use crate::pages::html::{Cell, page, table};
use ctsn_rig::Result;
use ctsn_rig::statistics::Sorted;
use ctsn_train::judging::{Errors, FrameErrors, PoseErrors, Report, Statistic};
use maud::{Markup, html};

/// What each figure of the page means.
const MEANINGS: [(&str, &str); 14] = [
    (
        "E_dist",
        "Distance between predicted and simulated position, mean over the vertices. Given as mean ± standard deviation \
      over the frames, and as the value that 95 % of the frames do not exceed.",
    ),
    (
        "E_norm",
        "Angle between predicted and simulated vertex normal, mean over the vertices; over the frames as E_dist. It \
      sees folds that E_dist hardly notices.",
    ),
    (
        "inside, depth",
        "Share of the vertices inside the body, mean over the frames; greatest depth of any vertex in any frame. A \
      vertex more than 50 mm behind a face is taken to lie beyond the far side of a limb, and is not counted.",
    ),
    ("crossing", "Share of the cloth's edges that pass through a face of the body, mean over the frames."),
    (
        "limbs out",
        "Share of the frames in which a limb has come out through the cloth, as an arm beside its sleeve: a line from \
      joint to joint leaves the cloth through itself.",
    ),
    (
        "stretch",
        "Difference between predicted and simulated edge length, as a share of the length at rest; mean over edges and \
      frames.",
    ),
    (
        "acceleration",
        "Mean acceleration of the vertices seen from the hip, over all groups of three consecutive frames. The \
      simulation has that of the motion; what a prediction has beyond it is trembling.",
    ),
    (
        "slow",
        "The same acceleration in slow motion: from one unseen pose to the next of its clip at a quarter of the speed, \
      30 frames a second, with all joints turning evenly. The repair of penetration must not make cloth tremble.",
    ),
    (
        "bending, curvature, fine",
        "Mean angle between neighbouring triangles, less that of the garment as it was cut; root mean square of the way \
      along the normal from a vertex to the mean of its neighbours; the same of what ten steps of smoothing take \
      away. All over the simulation's. Correlation: of the last with the simulation's, vertex by vertex.",
    ),
    (
        "strain, stretch, shear, energy",
        "Edges beside their lengths in the garment as it was cut; threads of warp and weft beside theirs, and the \
      cosine between them; elastic energy, and what hanging higher than the simulation is worth, over the \
      simulation's elastic energy.",
    ),
    (
        "coarse, middle, fine",
        "E_dist of what 40 steps of smoothing leave of both, of what 10 leave beyond it, and of what 10 take away.",
    ),
    (
        "mm per metre",
        "E_dist per metre of the greatest extent of the figure in its canonical pose (its height, if it stands). It \
      compares characters of different size.",
    ),
    (
        "unseen",
        "Frames that the network learned from none of: the last tenth of the clips or, with fewer than ten clips, the \
      last tenth of each.",
    ),
    ("plain skinning", "The garment at rest, moved by the skin weights of the nearest body vertices."),
];

/// The page of a report, with `training` charts (may be empty), pictures of some frames, facts on the model, and what
/// stands before and after all that.
pub fn report(
    report: &Report,
    training: &[Chart],
    gallery: &Gallery,
    facts: &[(&str, String)],
    [before, after]: &[Markup; 2],
) -> Result<String> {
    let title = format!("{} on {}", report.garment, report.character);
    let curves: Vec<Markup> = training.iter().map(Chart::draw).collect::<Result<_>>()?;
    let body = html! {
        h1 { (title) }
        p class="soft" {
            "Predicted cloth against the simulation, on " (report.frames.len())
            (if report.whole { " frames of " } else { " unseen frames of " }) (report.clips.len()) " clips."
        }
        (tiles(report))
        (before)
        h2 { "Ways to predict" }
        div class="first" { (ways(report)) }
        h2 { "Folds" }
        p class="soft" { "Ratios to the simulation: 1 is as folded as it; less is smooth, more is noise." }
        (folds(report))
        @if !curves.is_empty() {
            h2 { "Training" }
            div class="charts" { @for chart in &curves { div { (chart) } } }
        }
        h2 { "Over the frames" }
        div class="charts" {
            div { (frames(report, "E_dist, mm", |frame| 1e3 * frame.distance)?) }
            div { (frames(report, "E_norm, degrees", |frame| frame.normal)?) }
        }
        (gallery.markup())
        h2 { "By clip" }
        (by_clip(report))
        h2 { "By joint" }
        p class="soft" { "Vertices belong to the joint that moves them most in plain skinning." }
        (by_joint(report))
        h2 { "The model" }
        dl { @for (name, fact) in facts { dt { (name) } dd { (fact) } } }
        (after)
        h2 { "What the figures mean" }
        dl { @for (name, meaning) in MEANINGS { dt { (name) } dd { (meaning) } } }
    };
    Ok(page(&title, body))
}

fn tiles(report: &Report) -> Markup {
    let Report { network, skinning, .. } = report;
    let share = 100.0 * report.ratio;
    html! {
        div class="tiles" {
            div { b { (format!("{:.1} mm", 1e3 * network.distance.mean)) }
                span { "E_dist; plain skinning " (format!("{:.1} mm", 1e3 * skinning.distance.mean)) } }
            div { b { (format!("{:.1}°", network.normal.mean)) }
                span { "E_norm; plain skinning " (format!("{:.1}°", skinning.normal.mean)) } }
            div { b { (format!("{share:.0} %")) } span { "of plain skinning's E_dist" } }
            div { b { (format!("{:.1}", network.scaled)) }
                span { "mm per metre of the figure (" (format!("{:.2} m", report.size)) ")" } }
            div { b { (format!("{:.2} %", 100.0 * network.penetrating)) } span { "of the vertices inside the body" } }
        }
    }
}

fn ways(report: &Report) -> Markup {
    let heads = [
        "",
        "E_dist, mm",
        "95 %",
        "E_norm, °",
        "95 %",
        "inside, %",
        "depth, mm",
        "crossing, %",
        "limbs out, %",
        "stretch, %",
        "accel., m/s²",
        "slow",
    ];
    let acceleration = |jitter: Option<f64>| jitter.map_or("–".to_owned(), |jitter| format!("{jitter:.2}"));
    let row = |(name, errors): (&str, &Errors)| {
        let pair = |s: Statistic, unit: f64| format!("{:.2} ± {:.2}", s.mean * unit, s.std * unit);
        let cells = [
            pair(errors.distance, 1e3),
            format!("{:.2}", 1e3 * errors.distance.p95),
            pair(errors.normal, 1.0),
            format!("{:.2}", errors.normal.p95),
            format!("{:.3}", 100.0 * errors.penetrating),
            format!("{:.1}", 1e3 * errors.depth),
            format!("{:.3}", 100.0 * errors.crossing),
            format!("{:.1}", 100.0 * errors.out),
            format!("{:.2}", 100.0 * errors.stretch),
            acceleration(errors.jitter),
            acceleration(errors.slow_jitter),
        ];
        (name.to_owned(), cells.map(Cell::Text).into())
    };
    table(&heads, &report.ways().map(row).collect::<Vec<_>>())
}

fn folds(report: &Report) -> Markup {
    let heads = [
        "",
        "bending",
        "curvature",
        "fine",
        "correlation",
        "strain, %",
        "stretch, %",
        "shear, %",
        "energy",
        "E_dist coarse, mm",
        "middle",
        "fine",
    ];
    let row = |(name, errors): (&str, &Errors)| {
        let folds = errors.folds;
        let ratios = [folds.bending, folds.curvature, folds.fine, folds.correlation].map(|ratio| format!("{ratio:.3}"));
        let shares = [folds.strain, folds.stretch, folds.shear].map(|share| format!("{:.2}", 100.0 * share));
        let bands = folds.bands.map(|band| format!("{:.2}", 1e3 * band));
        let cells = ratios.into_iter().chain(shares).chain([format!("{:.2}", folds.energy)]).chain(bands);
        (name.to_owned(), cells.map(Cell::Text).collect())
    };
    table(&heads, &report.ways().map(row).collect::<Vec<_>>())
}

/// Chart of the share of frames at or below an error, for the network and for plain skinning.
fn frames(report: &Report, what: &str, part: fn(&PoseErrors) -> f64) -> Result<Markup> {
    let share = |name: &str, of: fn(&FrameErrors) -> &PoseErrors| {
        let sorted = Sorted::new(report.frames.iter().map(|frame| part(of(frame))));
        let (values, count) = (sorted.values(), report.frames.len() as f64);
        let mut points: Vec<_> = values.first().map(|least| (*least, 0.0)).into_iter().collect();
        points.extend(values.iter().enumerate().map(|(i, value)| (*value, 100.0 * (i + 1) as f64 / count)));
        Series { name: name.to_owned(), points, line: true }
    };
    let series = vec![share("network", |frame| &frame.network), share("plain skinning", |frame| &frame.skinning)];
    Chart { x: what, y: "% of frames at or below", logarithmic: [false; 2], series }.draw()
}

/// `value` with a bar, the greatest of `all` filling it.
fn bar(value: f64, unit: f64, all: impl Iterator<Item = f64>) -> Cell {
    Cell::Bar(format!("{:.1}", value * unit), value / all.fold(f64::MIN_POSITIVE, f64::max))
}

fn by_clip(report: &Report) -> Markup {
    let clips = &report.clips;
    let rows: Vec<_> = clips
        .iter()
        .map(|clip| {
            let cells = vec![
                bar(clip.network.distance.mean, 1e3, clips.iter().map(|clip| clip.network.distance.mean)),
                bar(clip.network.normal.mean, 1.0, clips.iter().map(|clip| clip.network.normal.mean)),
                Cell::Text(format!("{:.2}", 100.0 * clip.network.penetrating)),
                Cell::Text(format!("{:.1}", 1e3 * clip.skinning.distance.mean)),
                Cell::Text(clip.frames.to_string()),
            ];
            (clip.clip.clone(), cells)
        })
        .collect();
    table(&["", "E_dist, mm", "E_norm, °", "inside, %", "skinning, mm", "frames"], &rows)
}

fn by_joint(report: &Report) -> Markup {
    let joints = &report.joints;
    let rows: Vec<_> = joints
        .iter()
        .map(|joint| {
            let cells = vec![
                bar(joint.distance, 1e3, joints.iter().map(|joint| joint.distance)),
                bar(joint.normal, 1.0, joints.iter().map(|joint| joint.normal)),
                Cell::Text(format!("{:.1}", 1e3 * joint.skinning)),
                Cell::Text(joint.vertices.to_string()),
            ];
            (joint.joint.clone(), cells)
        })
        .collect();
    table(&["", "E_dist, mm", "E_norm, °", "skinning, mm", "vertices"], &rows)
}
