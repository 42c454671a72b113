//! A mesh to simulate, made from the one that an artist drew: one sheet, even, of chosen fineness. The artist's rides
//! on it. simulation.md §4.4.

mod binding;
mod layers;
mod sheet;
mod split;
#[cfg(test)]
mod test;

use super::check::{Outside, mistaken};
use super::mend::mend;
use super::quality;
use ctsn_rig::gltf::Source;
use ctsn_rig::mesh::Edges;
use ctsn_rig::statistics::Sorted;
use ctsn_rig::{Drawn, Garment, Mesh, Surface};
use layers::{Layer, layers};
use sheet::Sheet;
use split::Split;
use std::fmt;
use std::str::FromStr;

/// A human's extent, metres: lengths below are a human's, and grow and shrink with the body.
const HUMAN: f64 = 1.7;
/// Edges that nobody chose, metres: so many vertices, within these lengths.
const VERTICES: f64 = 4000.0;
const EDGES: [f64; 2] = [0.008, 0.015];
/// Drawn edges are at most so long, in edges of the cloth.
const DRAWN: f64 = 1.25;
/// Edges that may be asked for, metres.
const ASKED: [f64; 2] = [0.004, 0.05];
/// Meshes of more vertices take too long to simulate, whoever drew them.
const MOST: usize = 10_000;
/// A mesh is even where 5 and 95 of 100 edges are no shorter and no longer than this, in median edges.
const EVEN: [f64; 2] = [1.0 / 3.0, 2.0];
/// A mesh of so large angles, degrees, half of the triangles' least ones, was made even on purpose: it is as coarse as
/// its maker wants it. A grid's are 45 at most.
const ISOTROPIC: f64 = 47.0;

/// Whether a garment gets a mesh of its own to be simulated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Resample {
    /// Where its own is coarse, uneven, too fine, or of several layers.
    #[default]
    Auto,
    /// Never: its own mesh is simulated.
    Never,
    /// Always, with edges of this length, metres.
    Edge(f64),
}

impl FromStr for Resample {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let [least, most] = ASKED.map(|edge| 1e3 * edge);
        match text {
            "auto" => Ok(Self::Auto),
            "never" => Ok(Self::Never),
            other => match other.parse::<f64>() {
                Ok(edge) if (least..=most).contains(&edge) => Ok(Self::Edge(1e-3 * edge)),
                _ => Err(format!("wanted auto, never, or an edge of {least} to {most} mm, found {other}")),
            },
        }
    }
}

impl fmt::Display for Resample {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Never => f.write_str("never"),
            Self::Edge(edge) => write!(f, "{}", 1e3 * edge),
        }
    }
}

/// The garment to simulate, with what is drawn riding on it where the two differ; said is what was done, and why.
pub(super) fn resample(
    outside: &Outside,
    garment: Garment,
    source: Source,
    wanted: Resample,
    said: &mut Vec<String>,
) -> (Garment, Source) {
    let kept = wanted == Resample::Never || wanted == Resample::Auto && source.own;
    // What is somewhere else or of another scale is refused later.
    if kept || mistaken(outside, &garment).is_some() {
        return (garment, source);
    }
    let layers = layers(&garment.mesh, outside);
    let scale = outside.body / HUMAN;
    let Some(mut reason) = reason(&garment.mesh, &layers, scale, wanted) else { return (garment, source) };
    let whole = Garment { surface: surface(&garment), ..garment.clone() };
    let (sheet, numbers) = single(&whole, &source, &layers);
    let area = sheet.mesh.area();
    let edge = match wanted {
        Resample::Edge(edge) => edge,
        _ => (area / (0.866 * VERTICES)).sqrt().clamp(EDGES[0] * scale, EDGES[1] * scale),
    };
    let target = (area / (0.866 * edge * edge)).ceil() as usize;
    if target > MOST {
        reason += &format!("; edges of {:.0} mm would be {target} vertices, at most {MOST} are simulated", 1e3 * edge);
    }
    let (mut even, numbers) = Sheet::new(&sheet, &numbers).resample(target.min(MOST));
    let found = quality(&even.mesh);
    if !found.manifold || even.mesh.triangles.is_empty() {
        said.push(format!("simulated as its maker meshed it, although {reason}: no even mesh could be made of it"));
        return (garment, source);
    }
    let drawn = Split::new(&whole, DRAWN * found.edge);
    let riders = binding::bind(&drawn, &layers, &even.mesh);
    let farthest = riders.iter().map(|rider| rider.coordinates[3].abs()).fold(0.0, f64::max);
    said.push(format!(
        "simulated on an even mesh of its own, {} vertices, edges of {:.0} mm, because {reason}; {} drawn vertices ride \
         on it, {} of them the file's, up to {:.0} mm away (--resample never simulates the file's own)",
        even.mesh.positions.len(),
        1e3 * found.edge,
        riders.len(),
        whole.mesh.positions.len(),
        1e3 * farthest
    ));
    even.drawn = Some(Drawn { riders, surface: drawn.surface });
    (even, numbers)
}

/// Why a garment is not simulated as it is; none where it is.
fn reason(mesh: &Mesh, layers: &[Layer], scale: f64, wanted: Resample) -> Option<String> {
    if matches!(wanted, Resample::Edge(_)) {
        return Some("that was asked for".to_owned());
    }
    let share = |which: Layer| {
        let faces = mesh.corners().zip(layers).filter(|(_, layer)| **layer == which);
        let area: f64 = faces.map(|(corners, _)| ctsn_rig::mesh::triangle::area(corners)).sum();
        100.0 * area / mesh.area()
    };
    let [inner, trimmings] = [Layer::Inner, Layer::Trimming].map(share);
    if inner > 0.0 || trimmings > 0.0 {
        return Some(format!("of its area {inner:.0} % is lining and {trimmings:.0} % trimmings"));
    }
    let angles = Sorted::new(mesh.corners().map(ctsn_rig::mesh::triangle::least_angle));
    let count = mesh.positions.len();
    if count <= MOST && angles.median() > ISOTROPIC {
        return None;
    }
    let place = |v: u32| mesh.positions[v as usize];
    let edges = Edges::new(&mesh.triangles);
    let lengths = Sorted::new(edges.iter().map(|([a, b], _)| place(a).distance(place(b))));
    let [short, median, long] = [5, 50, 95].map(|percent| lengths.percentile(percent));
    let found = || format!("its edges are {:.0} to {:.0} mm long", 1e3 * short, 1e3 * long);
    let uneven = short < EVEN[0] * median || long > EVEN[1] * median;
    if median > EDGES[1] * scale || uneven {
        return Some(found());
    }
    (count > MOST).then(|| format!("it has {count} vertices"))
}

/// The faces of the sheet, mended where others were left out.
fn single(whole: &Garment, source: &Source, layers: &[Layer]) -> (Garment, Source) {
    let mut sheet = whole.clone();
    if layers.iter().all(|layer| *layer == Layer::Sheet) {
        return (sheet, source.clone());
    }
    for triangles in [&mut sheet.mesh.triangles, &mut sheet.surface.triangles] {
        let mut layers = layers.iter();
        triangles.retain(|_| layers.next() == Some(&Layer::Sheet));
    }
    let (sheet, source, _) = mend(sheet, source.clone());
    (sheet, source)
}

/// What draws a garment, with a triangle for each of the mesh in its order: without those that have no area.
fn surface(garment: &Garment) -> Surface {
    let Garment { mesh, surface, .. } = garment;
    let mut drawn = surface.triangles.iter();
    let vertex = |drawn: &[u32; 3]| drawn.map(|corner| surface.vertex[corner as usize]);
    let same: Option<Vec<[u32; 3]>> =
        mesh.triangles.iter().map(|corners| drawn.find(|drawn| vertex(drawn) == *corners).copied()).collect();
    match same {
        Some(triangles) => Surface { triangles, ..surface.clone() },
        // A mesh that nothing draws draws itself.
        None => Surface {
            vertex: (0..mesh.positions.len() as u32).collect(),
            triangles: mesh.triangles.clone(),
            ..Surface::default()
        },
    }
}
