//! The elastic model of a garment: membrane triangles, hinges over the inner edges, weight at the vertices, each with
//! energy and gradient. simulation.md §2.2. Positions are metres, y up; energies are potential, joules. Refuses meshes
//! that have no well-defined rest state. The simulator's solver and losses of a training use the same elements.

mod bending;
mod membrane;
mod wrinkling;

use glam::DVec3;

pub use self::bending::Hinge;
use self::bending::angle;
pub use self::membrane::{Membrane, Triangle};
pub use self::wrinkling::Wrinkling;
use super::grain::warp;
use super::material::{GRAVITY, Material};
use crate::{Error, Result};
use ctsn_rig::Garment;
use ctsn_rig::mesh::{self, Edges, Mesh};

/// The elements of a garment of `n` vertices.
#[derive(Clone, Debug)]
pub struct Elastic {
    /// Mass per vertex, kg [n]: a third of its triangles'.
    pub masses: Vec<f64>,
    /// Membrane elements.
    pub triangles: Vec<Triangle>,
    /// Bending elements, one per inner edge.
    pub hinges: Vec<Hinge>,
    /// In-plane stiffness.
    pub membrane: Membrane,
}

impl Elastic {
    /// `shape` in 0..1 is the share of the garment's own dihedral angles that it has at rest (0: flat cloth).
    pub fn new(garment: &Garment, material: &Material, shape: f64) -> Result<Self> {
        Self::of_mesh(&garment.mesh, &warp(garment), material, shape)
    }

    /// The same of a mesh with the direction of the warp per triangle [t].
    pub(super) fn of_mesh(mesh: &Mesh, warp: &[DVec3], material: &Material, shape: f64) -> Result<Self> {
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
        Ok(Self { masses, triangles, hinges, membrane: Membrane::new(material) })
    }

    /// Energy of stretch and shear at `x` [n], joules; its gradient, newtons, is added to `gradient` [n].
    pub fn stretch(&self, x: &[DVec3], gradient: &mut [DVec3]) -> f64 {
        let each = |triangle: &Triangle| {
            let corners = triangle.gradient(&self.membrane, x);
            triangle.vertices.iter().zip(corners).for_each(|(&i, corner)| gradient[i] += corner);
            triangle.energy(&self.membrane, x)
        };
        self.triangles.iter().map(each).sum()
    }

    /// Energy of bending at `x` [n], joules; its gradient, newtons, is added to `gradient` [n].
    pub fn bend(&self, x: &[DVec3], gradient: &mut [DVec3]) -> f64 {
        let each = |hinge: &Hinge| {
            let corners = hinge.gradient(x);
            hinge.vertices.iter().zip(corners).for_each(|(&i, corner)| gradient[i] += corner);
            hinge.energy(x)
        };
        self.hinges.iter().map(each).sum()
    }

    /// Energy of height at `x` [n] above y = 0, joules; its gradient, newtons, is added to `gradient` [n].
    pub fn weigh(&self, x: &[DVec3], gradient: &mut [DVec3]) -> f64 {
        gradient.iter_mut().zip(&self.masses).for_each(|(gradient, mass)| gradient.y += mass * GRAVITY);
        self.weight(x)
    }

    /// Energy of height at `x` [n] above y = 0, joules.
    pub(super) fn weight(&self, x: &[DVec3]) -> f64 {
        self.masses.iter().zip(x).map(|(mass, x)| mass * GRAVITY * x.y).sum()
    }

    /// Mean weight of a vertex in newtons: the unit residuals are measured in.
    pub fn mean_weight(&self) -> f64 {
        self.masses.iter().sum::<f64>() * GRAVITY / self.masses.len() as f64
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
    let edges = Edges::new(&mesh.triangles);
    if let Some(([a, b], sides)) = edges.iter().find(|(_, sides)| sides.len() > 2) {
        let reason = format!("edge {a}-{b}: wanted at most two triangles, found {}", sides.len());
        return Err(Error::Garment(reason));
    }
    let hinge = |found: mesh::Hinge| {
        let vertices = found.vertices.map(|i| i as usize);
        let [first, second] = found.triangles.map(|t| triangles[t].area);
        let length: DVec3 = mesh.positions[vertices[1]] - mesh.positions[vertices[0]];
        let stiffness = bending * length.length_squared() / (first + second);
        Hinge { vertices, stiffness, rest: shape * angle(&vertices, &mesh.positions) }
    };
    Ok(edges.hinges().map(hinge).collect())
}
