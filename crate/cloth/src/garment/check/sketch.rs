//! What is wrong with a garment as its file has it, vertex by vertex: to be shown.

use super::{Outside, SLIVER};
use crate::Result;
use crate::simulate::Elements;
use ctsn_rig::gltf::read_garment;
use ctsn_rig::mesh::Edges;
use ctsn_rig::mesh::triangle::least_angle;
use ctsn_rig::{Character, Mesh};
use std::path::Path;

/// Depth inside the body from which cloth is shown to be, in body extents.
const DEEP: f64 = 0.002;

/// A fault at a vertex, the first of these that it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Inside the body.
    Inside,
    /// At a face that passes through another.
    Crossing,
    /// At an edge in more than two faces, or whose faces look opposite ways.
    Edge,
    /// At a face too thin to have a shape.
    Sliver,
}

/// The garment of a file as it is, canonical, and the faults of its vertices [n].
pub fn sketch(path: &Path, character: &Character) -> Result<(Mesh, Vec<Option<Fault>>)> {
    let (garment, _) = read_garment(path, character.metres_per_unit)?;
    let mesh = garment.mesh;
    let mut faults = vec![None; mesh.positions.len()];
    let mut mark = |vertex: u32, fault: Fault| {
        faults[vertex as usize].get_or_insert(fault);
    };
    if let Ok(outside) = Outside::new(character) {
        let places = (0u32..).zip(outside.places(&mesh.positions));
        let inside = places.filter(|(_, place)| place.distance < -DEEP * outside.body);
        inside.for_each(|(vertex, _)| mark(vertex, Fault::Inside));
    }
    let crossing = Elements::new(&mesh.triangles, mesh.positions.len()).crossings(&mesh.positions);
    let corners = |face: &u32| mesh.triangles[*face as usize];
    crossing.iter().flatten().flat_map(corners).for_each(|vertex| mark(vertex, Fault::Crossing));
    for (edge, sides) in Edges::new(&mesh.triangles).iter() {
        if sides.len() > 2 || sides.len() == 2 && sides[0].forward == sides[1].forward {
            edge.into_iter().for_each(|vertex| mark(vertex, Fault::Edge));
        }
    }
    let thin = |face: &&[u32; 3]| least_angle(face.map(|vertex| mesh.positions[vertex as usize])) < SLIVER;
    mesh.triangles.iter().filter(thin).flatten().for_each(|vertex| mark(*vertex, Fault::Sliver));
    Ok((mesh, faults))
}
