//! Dresses any rigged character: an offset shell of its body, cut at neck, sleeves and hem, evenly remeshed, with
//! texture coordinates. f = |x - body| - looseness, smoothed; garment = {f = 0} between the openings. simulation.md
//! §4.2.

mod check;
mod curve;
mod draft;
mod drape;
mod fall;
mod figure;
mod hang;
mod hold;
mod kind;
mod mend;
mod opening;
mod pattern;
mod quality;
mod resampling;
mod sheet;
mod unwrap;

use crate::wrap::{self, Piece, Region, Solid};
use crate::{Error, Result};
use ctsn_rig::{Character, Garment, Mesh, SkinnedMesh, Surface};
use draft::Pattern;
use figure::Figure;
use glam::DVec3;
use hang::Hang;
use kind::Preset;
use opening::{Bare, Opening};
use pattern::pattern;

#[cfg(test)]
mod kind_test;
#[cfg(test)]
mod obstacle_test;
#[cfg(test)]
mod test;

pub use check::{Fault, Findings, Fitted, check, fit, load, rehearse, sketch};
pub use drape::{Rest, drape};
pub use kind::Kind;
pub use quality::{Quality, quality};
pub use resampling::Resample;

/// How a garment is cut; what is `None` follows from the kind. Fractions run along a limb from where it leaves the
/// trunk (0) to its tip (1).
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, clap::Args)]
pub struct Cut {
    /// What to make. Default: a T-shirt for what walks upright, a coat for an animal, a vest for what has no limbs, a
    /// sheet for a rail before an obstacle
    #[arg(long)]
    pub kind: Option<Kind>,
    /// Vertices, about: 500 to 10000. Default: 3000
    #[arg(long)]
    pub vertices: Option<usize>,
    /// Distance from the body, metres. Default by kind; a T-shirt's on a human: 12 mm
    #[arg(long)]
    pub looseness: Option<f64>,
    /// Sleeves and leg holes: covered fraction of arms, or of an animal's legs
    #[arg(long)]
    pub sleeve: Option<f64>,
    /// Hem: covered fraction of the legs of what walks upright
    #[arg(long)]
    pub hem: Option<f64>,
    /// Collar: covered fraction of neck and tail
    #[arg(long)]
    pub collar: Option<f64>,
    /// How much a skirt widens on every side, metres per metre of fall, 0 to 1
    #[arg(long)]
    pub flare: Option<f64>,
}

/// The kind of garment a character gets when nobody says which.
pub fn default_kind(character: &Character) -> Result<Kind> {
    check_body(character)?;
    let figure = figure_of(character);
    let (_, _, extent) = bounds(&figure)?;
    Ok(Figure::new(&figure, extent).build().kinds()[0])
}

/// A garment for the character in its canonical pose: one connected manifold, open only where its kind has openings.
///
/// The body may be open, of several shells and self-intersecting; its obstacles are not dressed.
pub fn shell(character: &Character, cut: &Cut) -> Result<Garment> {
    check_body(character)?;
    let character = &figure_of(character);
    let (low, high, extent) = bounds(character)?;
    let figure = Figure::new(character, extent);
    let kind = kind_for(&figure, cut.kind)?;
    let (preset, vertices) = settle(cut, kind)?;
    if kind == Kind::Sheet {
        return sheet::sheet(character, vertices);
    }
    let cell = wrap::cell(low, high);
    let looseness = cut.looseness.unwrap_or((preset.looseness * extent).max(cell));
    if !(looseness >= cell && looseness <= 0.1 * extent) {
        let (least, most) = (cell, 0.1 * extent);
        return Err(Error::Garment(format!("looseness: wanted {least:.4} to {most:.4} m, found {looseness}")));
    }
    // The shell runs on past each opening, so that its end does not bend the cut.
    let past = 3.0 * looseness + 0.01 * extent;
    let pattern = pattern(&figure, kind, &preset, looseness, past);
    let (triangles, covered) = split_body(&character.body.mesh, &pattern.bare, extent / 60.0, past);
    if !covered.contains(&true) {
        return Err(Error::Garment("no triangle of the body lies on the covered joints".into()));
    }
    let falling = falling(&figure, &pattern, extent / 60.0, past);
    let (smoothing, room) = (extent / 130.0, pattern.room(past));
    let solid = Solid { triangles: &triangles, covered: &covered, room, looseness, smoothing };
    let field = fall::field(&solid, falling.as_deref(), &pattern, cell);
    let regions: Vec<Region> = pattern.openings.iter().map(|opening| opening.region.clone()).collect();
    let piece = wrap::cut(wrap::extract(&field), &regions);
    if piece.mesh.triangles.is_empty() {
        return Err(Error::Garment("nothing is left of the shell between the openings".into()));
    }
    let piece = wrap::remesh(piece, &field, &regions, vertices);
    let quality = quality(&piece.mesh);
    let loops = regions.len();
    if !quality.manifold || (quality.loops, quality.euler) != (loops, 2 - loops as i64) {
        let (name, found) = (kind.name(), format!("{} loops, Euler characteristic {}", quality.loops, quality.euler));
        return Err(Error::Garment(format!(
            "{name}: wanted one sheet with {loops} openings, found {found}: cloth grows together where limbs are close; a \
             smaller --looseness or --flare, or another --sleeve or --hem, may help"
        )));
    }
    let pins = pins(&piece, &pattern.openings, quality.edge);
    Ok(Garment { surface: unwrap::unwrap(&piece.mesh), mesh: piece.mesh, pins, drawn: None })
}

/// The character without its obstacles.
fn figure_of(character: &Character) -> Character {
    let body = character.body.part(|joint| !character.is_obstacle(joint));
    Character { body, surface: Surface::default(), ..character.clone() }
}

/// The kind to make on a figure, or why it cannot be.
fn kind_for(figure: &Figure, wanted: Option<Kind>) -> Result<Kind> {
    let build = figure.build();
    let kind = wanted.unwrap_or(build.kinds()[0]);
    if build.kinds().contains(&kind) {
        return Ok(kind);
    }
    let names: Vec<&str> = build.kinds().iter().map(|kind| kind.name()).collect();
    let (words, names) = (build.words(), names.join(", "));
    Err(Error::Garment(format!("{}: this is {words}, which can wear: {names}", kind.name())))
}

/// The preset of a kind with the cut's own numbers, and the number of vertices.
fn settle(cut: &Cut, kind: Kind) -> Result<(Preset, usize)> {
    let mut preset = kind.preset();
    let vertices = cut.vertices.unwrap_or(3000);
    if !(500..=10_000).contains(&vertices) {
        return Err(Error::Garment(format!("vertex count: wanted 500 to 10000, found {vertices}")));
    }
    let own = [
        ("sleeve", cut.sleeve, &mut preset.sleeve, 0.95),
        ("hem", cut.hem, &mut preset.hem, 0.95),
        ("collar", cut.collar, &mut preset.collar, 0.95),
        ("flare", cut.flare, &mut preset.flare, 1.0),
    ];
    for (name, wanted, place, most) in own {
        let value = wanted.unwrap_or(*place);
        if !(0.0..=most).contains(&value) {
            return Err(Error::Garment(format!("{name}: wanted 0 to {most}, found {value}")));
        }
        *place = value;
    }
    Ok((preset, vertices))
}

/// Rim vertices on the plane where their opening is pinned, to within half an edge (metres).
fn pins(piece: &Piece, openings: &[Opening], edge: f64) -> Vec<u32> {
    let pinned = |v: &u32| {
        let opening = piece.rim[*v as usize].map(|index| &openings[index]);
        let plane = opening.and_then(|opening| opening.pinned);
        plane.is_some_and(|plane| plane.past(piece.mesh.positions[*v as usize]).abs() < 0.5 * edge)
    };
    (0..piece.rim.len() as u32).filter(pinned).collect()
}

/// Which triangles of the split body fall with the trunk, where a hang would drag the arms along.
fn falling(figure: &Figure, pattern: &Pattern, longest: f64, past: f64) -> Option<Vec<bool>> {
    let limbs = 0..figure.anatomy.limbs.len();
    let apart = limbs.filter(|limb| figure.legs.is_none_or(|legs| !legs.contains(limb)));
    let apart: Vec<Bare> = apart.map(|limb| Bare { share: figure.share(limb), plane: None }).collect();
    let low = |share: &[f64], hang: &Hang| {
        let skin = figure.character.body.mesh.positions.iter().zip(share);
        skin.filter(|(_, share)| **share > 0.5).any(|(p, _)| (*p - hang.start).dot(hang.fall) > 0.0)
    };
    let drags = || pattern.hangs.iter().any(|hang| apart.iter().any(|bare| low(&bare.share, hang)));
    if figure.legs.is_none() || pattern.sleeves.is_empty() && !drags() {
        return None;
    }
    let bare: Vec<Bare> = pattern.bare.iter().cloned().chain(apart).collect();
    Some(split_body(&figure.character.body.mesh, &bare, longest, past).1)
}

/// Corners and extent of the bounding box of a sound body, metres.
fn bounds(character: &Character) -> Result<(DVec3, DVec3, f64)> {
    check_body(character)?;
    let [low, high] = character.body.mesh.bounds();
    Ok((low, high, (high - low).max_element()))
}

/// Rejects what cannot be dressed.
fn check_body(character: &Character) -> Result<()> {
    let fail = |message: String| Err(Error::Garment(message));
    let SkinnedMesh { mesh: body, weights } = &character.body;
    if body.triangles.is_empty() || character.joints.is_empty() {
        let (triangles, joints) = (body.triangles.len(), character.joints.len());
        return fail(format!("wanted a body with triangles and joints, found {triangles} and {joints}"));
    }
    if let Some(index) = body.positions.iter().position(|p| !p.is_finite()) {
        return fail(format!("body vertex {index}: wanted finite coordinates, found {}", body.positions[index]));
    }
    if body.positions.len() != weights.len() {
        return fail(format!("wanted {} skin weights, found {}", body.positions.len(), weights.len()));
    }
    Ok(())
}

/// The body's triangles, split until no edge is longer than `longest`, and which of them the garment, run on by `past`
/// metres, covers.
fn split_body(body: &Mesh, bare: &[Bare], longest: f64, past: f64) -> (Vec<[DVec3; 3]>, Vec<bool>) {
    wrap::split(body, longest, |triangle, centre, point| {
        let is_bare = |bare: &Bare| {
            let [p, q, r] = triangle.map(|v| bare.share[v as usize]);
            DVec3::new(p, q, r).dot(centre) > 0.5 && bare.plane.is_none_or(|plane| plane.past(point) > past)
        };
        !bare.iter().any(is_bare)
    })
}
