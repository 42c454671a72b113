//! A mesh to simulate, made from the one that an artist drew: one sheet, even, of chosen fineness. The artist's rides on
//! it. simulation.md §4.4.

mod binding;
mod layers;
mod sheet;
#[cfg(test)]
mod test;

use super::check::{Outside, mistaken};
use super::mend::mend;
use super::quality;
use ctsn_rig::gltf::Source;
use ctsn_rig::mesh::Edges;
use ctsn_rig::statistics::Sorted;
use ctsn_rig::{Drawn, Garment, Mesh};
use layers::{Layer, layers};
use sheet::Sheet;
use std::fmt;
use std::str::FromStr;

/// A human's extent, metres: lengths below are a human's, and grow and shrink with the body.
const HUMAN: f64 = 1.7;
/// Edges that nobody chose, metres: so many vertices, within these lengths.
const VERTICES: f64 = 4000.0;
const EDGES: [f64; 2] = [0.008, 0.015];
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
    // What is somewhere else or of another scale is refused later.
    if wanted == Resample::Never || mistaken(outside, &garment).is_some() {
        return (garment, source);
    }
    let layers = layers(&garment.mesh, outside);
    let scale = outside.body / HUMAN;
    let Some(reason) = reason(&garment.mesh, &source, &layers, scale, wanted) else { return (garment, source) };
    let (sheet, numbers) = single(&garment, &source, &layers);
    let area = sheet.mesh.area();
    let edge = match wanted {
        Resample::Edge(edge) => edge,
        _ => (area / (0.866 * VERTICES)).sqrt().clamp(EDGES[0] * scale, EDGES[1] * scale),
    };
    let target = (area / (0.866 * edge * edge)).ceil() as usize;
    let (mut even, source) = Sheet::new(&sheet, &numbers).resample(target);
    let found = quality(&even.mesh);
    if !found.manifold || even.mesh.triangles.is_empty() {
        said.push(format!("simulated as its maker meshed it, although {reason}: no even mesh could be made of it"));
        return (garment, Source { numbers: source.numbers, ..source });
    }
    let riders = binding::bind(&garment.mesh, &layers, &even.mesh);
    let farthest = riders.iter().map(|rider| rider.coordinates[3].abs()).fold(0.0, f64::max);
    said.push(format!(
        "simulated on an even mesh of its own, {} vertices, edges of {:.0} mm, because {reason}; {} drawn vertices ride \
         on it, up to {:.0} mm away (--resample never simulates the file's own)",
        even.mesh.positions.len(),
        1e3 * found.edge,
        riders.len(),
        1e3 * farthest
    ));
    even.drawn = Some(Drawn { riders, surface: surface(garment) });
    (even, source)
}

/// Why a garment is not simulated as it is; none where it is.
fn reason(mesh: &Mesh, source: &Source, layers: &[Layer], scale: f64, wanted: Resample) -> Option<String> {
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
    if source.own || count <= MOST && angles.median() > ISOTROPIC {
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
fn single(garment: &Garment, source: &Source, layers: &[Layer]) -> (Garment, Source) {
    if layers.iter().all(|layer| *layer == Layer::Sheet) {
        return (Garment { surface: surface(garment.clone()), ..garment.clone() }, source.clone());
    }
    let mut sheet = Garment { surface: surface(garment.clone()), ..garment.clone() };
    let mut kept = layers.iter().map(|layer| *layer == Layer::Sheet);
    let mut drawn = kept.clone();
    sheet.mesh.triangles.retain(|_| kept.next() == Some(true));
    sheet.surface.triangles.retain(|_| drawn.next() == Some(true));
    let (sheet, source, _) = mend(sheet, source.clone());
    (sheet, source)
}

/// What draws a garment, with a triangle for each of the mesh in its order: without those that have no area.
fn surface(garment: Garment) -> ctsn_rig::Surface {
    let Garment { mesh, mut surface, .. } = garment;
    let mut triangles = mesh.triangles.iter().peekable();
    let vertex = &surface.vertex;
    surface.triangles.retain(|drawn| {
        let same = triangles.peek().is_some_and(|corners| drawn.map(|v| vertex[v as usize]) == **corners);
        if same {
            triangles.next();
        }
        same
    });
    if surface.triangles.len() != mesh.triangles.len() {
        // A mesh without anything to draw it draws itself.
        let vertex = (0..mesh.positions.len() as u32).collect();
        return ctsn_rig::Surface { vertex, triangles: mesh.triangles, ..Default::default() };
    }
    surface
}
