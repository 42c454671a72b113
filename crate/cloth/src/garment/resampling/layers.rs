//! One sheet out of an artist's mesh. Cloth modelled with thickness has two layers back to back, of which the outer one
//! is kept; pockets, buttons and belts that lie on a larger piece are left out. simulation.md §4.4.

use crate::garment::check::Outside;
use crate::wrap::Faces;
use ctsn_rig::Mesh;
use ctsn_rig::mesh::triangle::{closest_point, cross};
use ctsn_rig::mesh::{Components, Edges};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Layers are at most so far apart, in body extents: 10 mm of a human.
const THICK: f64 = 0.006;
/// Cosine between the normals of faces that lie on one another; and of the way between them with the normals, where
/// there is a way.
const ALIKE: [f64; 2] = [0.7, 0.7];
/// With less than this share of the area on an inner layer there is none.
const LAYERED: f64 = 0.05;
/// A piece of which more than this share lies on a larger one is a trimming; or with less than this share of the
/// largest one's area, where it is near.
const TRIMMING: [f64; 2] = [0.6, 0.01];
/// Rounds in which a face follows the faces beside it: no patch of two faces is a layer.
const ROUNDS: usize = 2;

/// What a face is of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Layer {
    /// The sheet to simulate.
    Sheet,
    /// The lining of cloth with thickness, or the rim between it and the sheet.
    Inner,
    /// A piece that lies on the sheet.
    Trimming,
}

/// The layer of every face.
pub(super) fn layers(mesh: &Mesh, outside: &Outside) -> Vec<Layer> {
    let near = Near::new(mesh, THICK * outside.body);
    let mut layers = vec![Layer::Sheet; mesh.triangles.len()];
    let backs: Vec<bool> = (0..layers.len()).into_par_iter().map(|face| near.has_back(face)).collect();
    let places = outside.places(&near.centres);
    let inner = (0..layers.len()).map(|face| backs[face] && near.normals[face].dot(places[face].normal) < 0.0);
    let inner = settle(mesh, inner.collect());
    let area =
        |which: &dyn Fn(usize) -> bool| (0..layers.len()).filter(|f| which(*f)).map(|f| near.areas[f]).sum::<f64>();
    if area(&|face| inner[face]) > LAYERED * area(&|_| true) {
        let mut touched = vec![false; mesh.positions.len()];
        let lining = mesh.triangles.iter().zip(&inner).filter(|(_, inner)| **inner);
        lining.for_each(|(face, _)| face.iter().for_each(|&v| touched[v as usize] = true));
        for (face, layer) in layers.iter_mut().enumerate() {
            // What has no back and reaches the lining is the rim between the layers.
            let rim = !backs[face] && mesh.triangles[face].iter().any(|&v| touched[v as usize]);
            if inner[face] || rim {
                *layer = Layer::Inner;
            }
        }
    }
    trimmings(&near, &mut layers);
    if !layers.contains(&Layer::Sheet) {
        layers.fill(Layer::Sheet);
    }
    layers
}

/// Has faces follow most of those beside them.
fn settle(mesh: &Mesh, mut inner: Vec<bool>) -> Vec<bool> {
    let edges = Edges::new(&mesh.triangles);
    for _ in 0..ROUNDS {
        let mut votes = vec![0_i32; inner.len()];
        for (_, sides) in edges.iter() {
            let [one, two] = sides else { continue };
            for (from, to) in [(one, two), (two, one)] {
                votes[to.triangle] += if inner[from.triangle] { 1 } else { -1 };
            }
        }
        inner.iter_mut().zip(votes).filter(|(_, votes)| votes.abs() >= 2).for_each(|(inner, votes)| *inner = votes > 0);
    }
    inner
}

/// Pieces of the sheet that lie on a larger one.
fn trimmings(near: &Near, layers: &mut [Layer]) {
    let mut pieces = Components::new(near.mesh.positions.len());
    let sheet = |layers: &[Layer]| -> Vec<usize> { (0..layers.len()).filter(|f| layers[*f] == Layer::Sheet).collect() };
    let faces = sheet(layers);
    faces.iter().for_each(|&face| pieces.join(near.mesh.triangles[face].map(|v| v as usize)));
    let of = |face: usize| pieces.of(near.mesh.triangles[face][0] as usize);
    let mut areas: BTreeMap<usize, f64> = BTreeMap::new();
    faces.iter().for_each(|&face| *areas.entry(of(face)).or_default() += near.areas[face]);
    let largest = areas.values().fold(0.0, |most: f64, area| most.max(*area));
    let mut lying: BTreeMap<usize, f64> = BTreeMap::new();
    for &face in &faces {
        let larger = |other: usize| layers[other] == Layer::Sheet && areas[&of(other)] > 1.5 * areas[&of(face)];
        if near.lies_on(face, &larger) {
            *lying.entry(of(face)).or_default() += near.areas[face];
        }
    }
    let trimming = |piece: usize| {
        let (area, lying) = (areas[&piece], lying.get(&piece).copied().unwrap_or_default());
        lying > TRIMMING[0] * area || lying > 0.0 && area < TRIMMING[1] * largest
    };
    faces.iter().filter(|face| trimming(of(**face))).for_each(|&face| layers[face] = Layer::Trimming);
}

/// What is near to every face.
struct Near<'a> {
    mesh: &'a Mesh,
    faces: Faces<'a>,
    centres: Vec<DVec3>,
    normals: Vec<DVec3>,
    areas: Vec<f64>,
    reach: f64,
}

impl<'a> Near<'a> {
    fn new(mesh: &'a Mesh, reach: f64) -> Self {
        let crosses: Vec<DVec3> = mesh.corners().map(cross).collect();
        Self {
            faces: Faces::new(mesh),
            centres: mesh.corners().map(|corners| corners.iter().sum::<DVec3>() / 3.0).collect(),
            normals: crosses.iter().map(|cross| cross.normalize_or_zero()).collect(),
            areas: crosses.iter().map(|cross| 0.5 * cross.length()).collect(),
            mesh,
            reach,
        }
    }

    /// The way from the middle of a face to each other one that is near and shares no vertex with it.
    fn others(&self, face: usize) -> impl Iterator<Item = (usize, DVec3)> {
        let (own, centre) = (self.mesh.triangles[face], self.centres[face]);
        let near = self.faces.within(centre, self.reach).into_iter().map(|other| other as usize);
        let apart = near.filter(move |other| !self.mesh.triangles[*other].iter().any(|v| own.contains(v)));
        apart.filter_map(move |other| {
            let corners = self.mesh.triangles[other].map(|v| self.mesh.positions[v as usize]);
            let way = closest_point(centre, corners) - centre;
            (way.length() <= self.reach).then_some((other, way))
        })
    }

    /// Whether a face has another behind it that looks the other way.
    fn has_back(&self, face: usize) -> bool {
        let normal = self.normals[face];
        self.others(face).any(|(other, way)| {
            let along = way.dot(normal) <= -ALIKE[1] * way.length();
            along && self.normals[other].dot(normal) < -ALIKE[0]
        })
    }

    /// Whether a face is near to one of those that `larger` names, above, below or beside it.
    fn lies_on(&self, face: usize, larger: &impl Fn(usize) -> bool) -> bool {
        self.others(face).any(|(other, _)| larger(other))
    }
}
