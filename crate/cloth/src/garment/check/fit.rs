//! Faults of a garment on its character: scale, place, cloth inside the body, inside out.

use super::{Findings, list};
use crate::Result;
use crate::wrap::{Faces, SKIN, outer_skin};
use ctsn_rig::gltf::Source;
use ctsn_rig::mesh::triangle;
use ctsn_rig::statistics::Sorted;
use ctsn_rig::{Character, Garment, Mesh};
use glam::DVec3;
use rayon::prelude::*;

/// Extents of a garment in body extents: a glove, and a cloak with a train.
const SIZES: [f64; 2] = [0.06, 2.5];

/// A garment is refused when more of its vertices than this share lie deeper than [`DEEP`].
const INSIDE: f64 = 0.05;

/// Depth out of which cloth cannot be lifted with its form kept, in body extents.
const DEEP: f64 = 0.03;

/// Half of the vertices may be farther than this from the body before the garment is somewhere else, in body extents:
/// half of the pinned ones where it has any, for what is held may hang anywhere.
const FAR: f64 = 0.2;

/// Share of the area that looks inwards at which a garment is inside out.
pub const INWARDS: f64 = 0.6;

/// Where a vertex is beside the body.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// To the body, metres, negative inside.
    pub distance: f64,
    /// Of the body, unit.
    pub normal: DVec3,
    /// The nearest way out, unit.
    pub out: DVec3,
}

impl Place {
    const NOWHERE: Place = Place { distance: f64::INFINITY, normal: DVec3::Y, out: DVec3::Y };
}

/// Checks the fit on the canonical pose.
pub(super) fn check(outside: &Outside, garment: &Garment, source: &Source, findings: &mut Findings) {
    if let Some(error) = mistaken(outside, garment) {
        findings.errors.push(error);
        return;
    }
    let places = outside.places(&garment.mesh.positions);
    inside(&places, outside.body, source, findings);
    orientation(&garment.mesh, &places, source, findings);
}

/// Why a garment cannot be meant for the body: its scale, its place.
pub fn mistaken(outside: &Outside, garment: &Garment) -> Option<String> {
    let Garment { mesh, pins, .. } = garment;
    let (body, found) = (outside.body, mesh.extent());
    if !(SIZES[0]..=SIZES[1]).contains(&(found / body)) {
        let factor = 10_f64.powi((0.5 * body / found).log10().round() as i32);
        let by = if factor > 1.0 {
            format!("{factor} times too small")
        } else {
            format!("{} times too large", 1.0 / factor)
        };
        let [least, most] = SIZES.map(|size| size * body);
        return Some(format!(
            "scale: found a garment {found:.3} m large on a body of {body:.2} m, wanted {least:.2} to {most:.2} m: {by}?"
        ));
    }
    let places = outside.places(&mesh.positions);
    let held = |v: &usize| pins.is_empty() || pins.binary_search(&(*v as u32)).is_ok();
    let median = Sorted::new((0..places.len()).filter(held).map(|v| places[v].distance.abs())).median();
    (median > FAR * body).then(|| {
        format!(
            "place: half of its vertices are more than {median:.2} m from the body, wanted a garment worn in the canonical pose"
        )
    })
}

/// A body seen from the cloth: its outer skin.
pub struct Outside {
    skin: Mesh,
    normals: Vec<DVec3>,
    gap: f64,
    /// Its extent, metres.
    pub body: f64,
}

impl Outside {
    pub fn new(character: &Character) -> Result<Outside> {
        let (skin, gap) = outer_skin(&character.body.mesh, SKIN)?;
        Ok(Outside { normals: skin.normals(&skin.positions), skin, gap, body: character.body.mesh.extent() })
    }

    /// Where every vertex is.
    pub fn places(&self, positions: &[DVec3]) -> Vec<Place> {
        let faces = Faces::new(&self.skin);
        let place = |p: &DVec3| {
            let Some((face, foot)) = faces.nearest(*p) else { return Place::NOWHERE };
            let corners = self.skin.triangles[face].iter();
            let normal = corners.map(|&v| self.normals[v as usize]).sum::<DVec3>().normalize_or(DVec3::Y);
            let side = if (*p - foot).dot(normal) < 0.0 { -1.0 } else { 1.0 };
            let out = (side * (*p - foot)).normalize_or(normal);
            Place { distance: side * foot.distance(*p) + self.gap, normal, out }
        };
        positions.par_iter().map(place).collect()
    }
}

/// Cloth inside the body, deepest first.
pub fn inside(places: &[Place], body: f64, source: &Source, findings: &mut Findings) {
    let mut buried: Vec<usize> = (0..places.len()).filter(|&v| places[v].distance < -0.002 * body).collect();
    buried.sort_by(|&a, &b| places[a].distance.total_cmp(&places[b].distance));
    let Some(&worst) = buried.first() else { return };
    let deep = buried.iter().filter(|&&v| places[v].distance < -DEEP * body).count();
    let share = |count: usize| 100.0 * count as f64 / places.len() as f64;
    let vertices = list(buried.iter().map(|&v| source.numbers[v].to_string()));
    let (all, depth) = (share(buried.len()), -1e3 * places[worst].distance);
    let reason =
        format!("fit: {all:.1} % of the vertices lie inside the body, up to {depth:.0} mm, deepest first: {vertices}");
    if deep as f64 > INSIDE * places.len() as f64 {
        let (deep, limit) = (share(deep), 1e3 * DEEP * body);
        findings
            .errors
            .push(format!("{reason}; {deep:.1} % deeper than {limit:.0} mm, wanted at most {} %", 100.0 * INSIDE));
    } else {
        findings.warnings.push(reason);
    }
}

/// Share of the area that looks at the body, and a face that does.
pub fn inwards(mesh: &Mesh, places: &[Place]) -> (f64, Option<[u32; 3]>) {
    let (mut inwards, mut total, mut first) = (0.0, 0.0, None);
    for t in &mesh.triangles {
        let normal = triangle::cross(t.map(|v| mesh.positions[v as usize]));
        let outwards: DVec3 = t.iter().map(|&v| places[v as usize].normal).sum();
        total += normal.length();
        if normal.dot(outwards) < 0.0 {
            inwards += normal.length();
            first.get_or_insert(*t);
        }
    }
    (inwards / total, first)
}

/// Which way the faces look, weighed by area.
fn orientation(mesh: &Mesh, places: &[Place], source: &Source, findings: &mut Findings) {
    if let (share, Some(face)) = inwards(mesh, places)
        && share > INWARDS
    {
        let ([a, b, c], share) = (face.map(|v| source.numbers[v as usize]), 100.0 * share);
        findings.errors.push(format!(
            "inside out: {share:.0} % of its area looks at the body (face {a}-{b}-{c}, say); flip its normals"
        ));
    }
}
