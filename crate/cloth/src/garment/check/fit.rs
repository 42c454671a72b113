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

/// Depth out of which the simulator cannot be trusted to lift cloth, in body extents.
const DEEP: f64 = 0.012;

/// Half of the vertices may be farther than this from the body before the garment is somewhere else, in body extents:
/// half of the pinned ones where it has any, for what is held may hang anywhere.
const FAR: f64 = 0.2;

/// Share of the area that looks inwards at which a garment is inside out.
const INWARDS: f64 = 0.6;

/// Distance to the body, metres, negative inside, and the unit direction away from it.
type Place = (f64, DVec3);

/// Checks the fit on the canonical pose.
pub(super) fn check(character: &Character, garment: &Garment, source: &Source, findings: &mut Findings) -> Result<()> {
    let Garment { mesh, pins, .. } = garment;
    let (body, found) = (character.body.mesh.extent(), mesh.extent());
    if !(SIZES[0]..=SIZES[1]).contains(&(found / body)) {
        let factor = 10_f64.powi((0.5 * body / found).log10().round() as i32);
        let by = if factor > 1.0 {
            format!("{factor} times too small")
        } else {
            format!("{} times too large", 1.0 / factor)
        };
        let [least, most] = SIZES.map(|size| size * body);
        findings.errors.push(format!(
            "scale: found a garment {found:.3} m large on a body of {body:.2} m, wanted {least:.2} to {most:.2} m: {by}?"
        ));
        return Ok(());
    }
    let places = places(character, mesh)?;
    let held = |v: &usize| pins.is_empty() || pins.binary_search(&(*v as u32)).is_ok();
    let median = Sorted::new((0..places.len()).filter(held).map(|v| places[v].0.abs())).median();
    if median > FAR * body {
        findings.errors.push(format!(
            "place: half of its vertices are more than {median:.2} m from the body, wanted a garment worn in the canonical pose"
        ));
        return Ok(());
    }
    inside(&places, body, source, findings);
    orientation(mesh, &places, source, findings);
    Ok(())
}

/// Where every vertex is, by the body's outer skin.
fn places(character: &Character, mesh: &Mesh) -> Result<Vec<Place>> {
    let (skin, gap) = outer_skin(&character.body.mesh, SKIN)?;
    let normals = skin.normals(&skin.positions);
    let faces = Faces::new(&skin);
    let place = |p: &DVec3| {
        let Some((face, foot)) = faces.nearest(*p) else { return (f64::INFINITY, DVec3::Y) };
        let normal = skin.triangles[face].iter().map(|&v| normals[v as usize]).sum::<DVec3>().normalize_or(DVec3::Y);
        let side = if (*p - foot).dot(normal) < 0.0 { -1.0 } else { 1.0 };
        (side * foot.distance(*p) + gap, normal)
    };
    Ok(mesh.positions.par_iter().map(place).collect())
}

/// Cloth inside the body, deepest first.
fn inside(places: &[Place], body: f64, source: &Source, findings: &mut Findings) {
    let mut buried: Vec<usize> = (0..places.len()).filter(|&v| places[v].0 < -0.002 * body).collect();
    buried.sort_by(|&a, &b| places[a].0.total_cmp(&places[b].0));
    let Some(&worst) = buried.first() else { return };
    let deep = buried.iter().filter(|&&v| places[v].0 < -DEEP * body).count();
    let share = |count: usize| 100.0 * count as f64 / places.len() as f64;
    let vertices = list(buried.iter().map(|&v| source.numbers[v].to_string()));
    let (all, depth) = (share(buried.len()), -1e3 * places[worst].0);
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

/// Which way the faces look, weighed by area.
fn orientation(mesh: &Mesh, places: &[Place], source: &Source, findings: &mut Findings) {
    let (mut inwards, mut total, mut first) = (0.0, 0.0, None);
    for t in &mesh.triangles {
        let normal = triangle::cross(t.map(|v| mesh.positions[v as usize]));
        let outwards: DVec3 = t.iter().map(|&v| places[v as usize].1).sum();
        total += normal.length();
        if normal.dot(outwards) < 0.0 {
            inwards += normal.length();
            first.get_or_insert(t.map(|v| source.numbers[v as usize]));
        }
    }
    if let (true, Some([a, b, c])) = (inwards > INWARDS * total, first) {
        let share = 100.0 * inwards / total;
        findings.errors.push(format!(
            "inside out: {share:.0} % of its area looks at the body (face {a}-{b}-{c}, say); flip its normals"
        ));
    }
}
