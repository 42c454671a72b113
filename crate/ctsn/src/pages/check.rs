//! What a check found, as a page: the garment on the body with its faults in colour, what was mended, what cannot be.

use super::html::{page as whole, picture};
use crate::pictures::painted;
use ctsn_cloth::Result;
use ctsn_cloth::garment::{Fault, Fitted};
use ctsn_rig::{Character, Mesh};
use maud::{Markup, html};

/// Sound cloth, linear RGB.
const CLOTH: [f32; 3] = [0.10, 0.28, 0.55];
/// Cloth that is held, and that a made body is shown through.
const HELD: [f32; 3] = [0.02, 0.45, 0.12];
/// Each fault with its colour, linear RGB, and its name.
const FAULTS: [(Fault, [f32; 3], &str); 4] = [
    (Fault::Inside, [0.75, 0.02, 0.02], "inside the body"),
    (Fault::Crossing, [0.65, 0.02, 0.55], "through itself"),
    (Fault::Edge, [0.85, 0.55, 0.02], "edges whose faces disagree"),
    (Fault::Sliver, [0.9, 0.25, 0.02], "slivers"),
];

/// The page. `bare`: the character as its file has it; `complete`: with what was added to its body; `found`: the
/// garment as its file has it with the faults of its vertices; `hung`: what it became and how far it moves until it
/// hangs.
pub fn page(
    [garment, character]: [String; 2],
    bare: &Character,
    complete: &Character,
    found: &(Mesh, Vec<Option<Fault>>),
    hung: &Result<(Fitted, f64)>,
) -> ctsn_rig::Result<String> {
    let title = format!("{garment} on {character}");
    let body = html! {
        h1 { (title) }
        @match hung {
            Ok((_, moved)) => p { "Fit to be simulated; hung, it moves by up to " (format!("{:.0} mm", 1e3 * moved)) "." },
            Err(_) => p { b { "It cannot be simulated as it is." } },
        }
        (faults(bare, complete, found, hung)?)
    };
    Ok(whole(&title, body))
}

/// Pictures and lists, for this page and that of a bake.
pub fn faults(
    bare: &Character,
    complete: &Character,
    (mesh, faults): &(Mesh, Vec<Option<Fault>>),
    hung: &Result<(Fitted, f64)>,
) -> ctsn_rig::Result<Markup> {
    let colour = |fault: &Option<Fault>| {
        let known = FAULTS.iter().find(|(known, ..)| Some(*known) == *fault);
        known.map_or(CLOTH, |(_, colour, _)| *colour)
    };
    let colours: Vec<[f32; 3]> = faults.iter().map(colour).collect();
    let count = |fault: Fault| faults.iter().filter(|found| **found == Some(fault)).count();
    let made = complete.body.mesh.positions.len() - bare.body.mesh.positions.len();
    Ok(html! {
        h2 { "As its file has it" }
        (picture(&painted(bare, mesh, &colours), "the garment on the body")?)
        ul {
            @for (fault, rgb, name) in FAULTS {
                @if count(fault) > 0 {
                    li { span style=(format!("color:{}", css(rgb))) { "■ " } (count(fault)) " vertices " (name) }
                }
            }
        }
        @if made > 0 {
            h2 { "The body under it" }
            p { (made) " vertices were added where no skin was." }
            (picture(&painted(bare, &added(complete, bare), &[HELD]), "the body that was made")?)
        }
        @match hung {
            Err(error) => { h2 { "What cannot be mended" } (lines(&error.to_string())) },
            Ok((fitted, _)) => {
                @if !fitted.mended.is_empty() {
                    h2 { "What was mended" }
                    ul { @for mend in &fitted.mended { li { (mend) } } }
                }
                h2 { "As it is simulated" }
                p class="soft" { "Green: held by springs." }
                (picture(&painted(bare, &fitted.garment.mesh, &held(fitted)), "the garment, mended")?)
                @if !fitted.warnings.is_empty() {
                    h2 { "What may be wrong" }
                    ul { @for warning in &fitted.warnings { li { (warning) } } }
                }
            },
        }
    })
}

/// A list of the lines of a message.
fn lines(message: &str) -> Markup {
    html! { ul { @for line in message.lines() { li { (line) } } } }
}

/// Colours of the simulated cloth.
fn held(fitted: &Fitted) -> Vec<[f32; 3]> {
    let colour = |vertex: u32| if fitted.garment.pins.binary_search(&vertex).is_ok() { HELD } else { CLOTH };
    (0..fitted.garment.mesh.positions.len() as u32).map(colour).collect()
}

/// What `complete` has beyond `bare`.
fn added(complete: &Character, bare: &Character) -> Mesh {
    let (mesh, first) = (&complete.body.mesh, bare.body.mesh.positions.len() as u32);
    let triangles = mesh.triangles.iter().filter(|face| face[0] >= first).map(|face| face.map(|v| v - first));
    Mesh { positions: mesh.positions[first as usize..].to_vec(), triangles: triangles.collect() }
}

/// Linear RGB as a colour of a style sheet.
fn css(rgb: [f32; 3]) -> String {
    let channel = |value: f32| (255.0 * value.powf(1.0 / 2.2)) as u8;
    format!("#{:02x}{:02x}{:02x}", channel(rgb[0]), channel(rgb[1]), channel(rgb[2]))
}
