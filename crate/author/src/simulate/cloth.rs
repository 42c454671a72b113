//! The garment as the solver sees it: membrane triangles, hinges and lumped masses of the rest mesh.
//! Refuses meshes that have no well-defined rest state.

use std::collections::BTreeMap;

use glam::DVec3;

use super::bending::{Hinge, angle};
use super::material::{GRAVITY, Material};
use super::membrane::{Membrane, Triangle};
use super::neighbourhood::Elements;
use crate::rig::Mesh;
use crate::{Error, Result};

/// Elastic model of a garment with `n` vertices.
#[derive(Clone, Debug)]
pub(super) struct Cloth {
    /// Mass per vertex, kg [n].
    pub masses: Vec<f64>,
    /// Membrane elements.
    pub triangles: Vec<Triangle>,
    /// Bending elements, one per inner edge.
    pub hinges: Vec<Hinge>,
    /// In-plane stiffness.
    pub membrane: Membrane,
    /// Coulomb coefficient against the body.
    pub friction: f64,
    /// Vertices, edges and triangles that must not pass through each other.
    pub elements: Elements,
    /// Distance below which cloth keeps cloth away, metres.
    pub gap: f64,
    /// Stiffness of that barrier, N/m.
    pub repulsion: f64,
}

/// Largest [`Cloth::gap`], metres, and its largest share of the mean edge: a fine mesh folds more tightly.
const GAP: f64 = 0.003;
const GAP_SHARE: f64 = 0.2;
/// [`Cloth::repulsion`] per mean vertex mass, 1/s². At 1e5 and 1e6 the folds of a raised arm, pressed by stretched cloth, came within
/// a thousandth of the gap, where steps become too short to go on.
const REPULSION: f64 = 1e7;

impl Cloth {
    /// `warp`: direction of the warp per triangle. `shape` in 0..1 is the share of the rest mesh's own dihedral angles kept as rest angles (0: flat cloth).
    pub fn new(mesh: &Mesh, warp: &[DVec3], material: &Material, shape: f64) -> Result<Self> {
        material.check()?;
        check(mesh)?;
        let rest = &mesh.positions;
        let mut masses = vec![0.0; rest.len()];
        let mut triangles = Vec::with_capacity(mesh.triangles.len());
        for (index, corners) in mesh.triangles.iter().enumerate() {
            let vertices = corners.map(|i| i as usize);
            let triangle = Triangle::new(vertices, vertices.map(|i| rest[i]), warp[index]).ok_or_else(|| {
                Error::Garment(format!("triangle {index} is degenerate at rest: wanted an area, found a sliver"))
            })?;
            vertices.iter().for_each(|&i| masses[i] += material.density * triangle.area / 3.0);
            triangles.push(triangle);
        }
        if let Some(loose) = masses.iter().position(|&mass| mass == 0.0) {
            return Err(Error::Garment(format!("vertex {loose} belongs to no triangle")));
        }
        let hinges = hinges(mesh, &triangles, material.bending, shape)?;
        let edges = mesh.triangles.iter().map(|[a, b, _]| rest[*a as usize].distance(rest[*b as usize]));
        let edge = edges.sum::<f64>() / triangles.len() as f64;
        let mass = masses.iter().sum::<f64>() / masses.len() as f64;
        Ok(Self {
            elements: Elements::new(&mesh.triangles, rest.len()),
            gap: GAP.min(GAP_SHARE * edge),
            repulsion: REPULSION * mass,
            masses,
            triangles,
            hinges,
            membrane: material.membrane(),
            friction: material.friction,
        })
    }

    /// Mean weight of a vertex in newtons: the unit residuals are measured in.
    pub fn mean_weight(&self) -> f64 {
        self.masses.iter().sum::<f64>() * GRAVITY / self.masses.len() as f64
    }

    /// Vertex groups that share an element: the cliques of the Hessian's pattern.
    pub fn cliques(&self) -> impl Iterator<Item = &[usize]> {
        let triangles = self.triangles.iter().map(|t| t.vertices.as_slice());
        triangles.chain(self.hinges.iter().map(|h| h.vertices.as_slice()))
    }
}

/// Rejects meshes without triangles, with indices out of range or with positions that are not finite.
fn check(mesh: &Mesh) -> Result<()> {
    if mesh.triangles.is_empty() {
        return Err(Error::Garment("wanted triangles, found none".into()));
    }
    if let Some(bad) = mesh.positions.iter().position(|p| !p.is_finite()) {
        return Err(Error::Garment(format!("vertex {bad}: wanted a finite position, found {}", mesh.positions[bad])));
    }
    let count = mesh.positions.len();
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        if let Some(vertex) = triangle.iter().find(|&&i| i as usize >= count) {
            let reason = format!("triangle {index}: wanted vertices below {count}, found {vertex}");
            return Err(Error::Garment(reason));
        }
        let [a, b, c] = *triangle;
        if a == b || b == c || c == a {
            return Err(Error::Garment(format!("triangle {index}: wanted three vertices, found {a}, {b}, {c}")));
        }
    }
    Ok(())
}

/// One hinge per edge with two triangles; an edge with more than two is an error.
fn hinges(mesh: &Mesh, triangles: &[Triangle], bending: f64, shape: f64) -> Result<Vec<Hinge>> {
    let mut edges: BTreeMap<(usize, usize), Vec<(usize, usize)>> = BTreeMap::new();
    for (index, triangle) in triangles.iter().enumerate() {
        for corner in 0..3 {
            let [a, b, opposite] = [0, 1, 2].map(|k| triangle.vertices[(corner + k) % 3]);
            edges.entry((a.min(b), a.max(b))).or_default().push((index, opposite));
        }
    }
    let mut hinges = Vec::new();
    for ((a, b), sides) in edges {
        let [(first, c), (second, d)] = match sides.as_slice() {
            [_] => continue,
            &[first, second] => [first, second],
            more => {
                let reason = format!("edge {a}-{b}: wanted at most two triangles, found {}", more.len());
                return Err(Error::Garment(reason));
            }
        };
        let [x, y, z] = triangles[first].vertices;
        let forward = [(x, y), (y, z), (z, x)].contains(&(a, b));
        let vertices = if forward { [a, b, c, d] } else { [a, b, d, c] };
        let area = triangles[first].area + triangles[second].area;
        let length: DVec3 = mesh.positions[b] - mesh.positions[a];
        let stiffness = bending * length.length_squared() / area;
        hinges.push(Hinge { vertices, stiffness, rest: shape * angle(&vertices, &mesh.positions) });
    }
    Ok(hinges)
}
