//! The garment as the solver sees it: its elastic model, and the elements of it that must not pass through each other.

use glam::DVec3;

use super::elastic::Elastic;
use super::material::Material;
use super::neighbourhood::Elements;
use crate::Result;
use ctsn_rig::Mesh;

/// A garment of `n` vertices.
#[derive(Clone, Debug)]
pub(super) struct Cloth {
    /// Membrane, hinges and masses.
    pub elastic: Elastic,
    /// Coulomb coefficient against the body.
    pub friction: f64,
    /// Vertices, edges and triangles that must not pass through each other.
    pub elements: Elements,
    /// Distance below which cloth keeps cloth away, metres.
    pub gap: f64,
    /// Stiffness of that barrier, N/m.
    pub repulsion: f64,
    /// The face of the body each vertex is worn on, if it is near one [n].
    pub worn: Vec<Option<u32>>,
}

/// Largest [`Cloth::gap`], metres, and its largest share of the mean edge: a fine mesh folds more tightly.
const GAP: f64 = 0.003;
const GAP_SHARE: f64 = 0.2;
/// [`Cloth::repulsion`] per mean vertex mass, 1/s². At 1e5 and 1e6 the folds of a raised arm, pressed by stretched
/// cloth, came within a thousandth of the gap, where steps become too short to go on.
const REPULSION: f64 = 1e7;

/// Cloth of more vertices than this is fine: it travels coarse, and takes more steps with each factor. Smaller garments
/// answer as they did before there was such a thing.
pub const FINE: usize = 2500;

/// Whether cloth of so many vertices is fine.
pub fn is_fine(vertices: usize) -> bool {
    vertices > FINE
}

impl Cloth {
    /// `warp`: direction of the warp per triangle. `shape` in 0..1 is the share of the rest mesh's own dihedral angles
    /// kept as rest angles (0: flat cloth).
    pub fn new(mesh: &Mesh, warp: &[DVec3], material: &Material, shape: f64) -> Result<Self> {
        let elastic = Elastic::of_mesh(mesh, warp, material, shape)?;
        let (rest, masses) = (&mesh.positions, &elastic.masses);
        let edges = mesh.triangles.iter().map(|[a, b, _]| rest[*a as usize].distance(rest[*b as usize]));
        let edge = edges.sum::<f64>() / elastic.triangles.len() as f64;
        let mass = masses.iter().sum::<f64>() / masses.len() as f64;
        Ok(Self {
            elements: Elements::new(&mesh.triangles, rest.len()),
            gap: GAP.min(GAP_SHARE * edge),
            repulsion: REPULSION * mass,
            friction: material.friction,
            worn: vec![None; rest.len()],
            elastic,
        })
    }

    /// Whether it has so many vertices that it travels coarse.
    pub fn is_fine(&self) -> bool {
        is_fine(self.elastic.masses.len())
    }

    /// Vertex groups that share an element: the cliques of the Hessian's pattern.
    pub fn cliques(&self) -> impl Iterator<Item = &[usize]> {
        let triangles = self.elastic.triangles.iter().map(|t| t.vertices.as_slice());
        triangles.chain(self.elastic.hinges.iter().map(|h| h.vertices.as_slice()))
    }
}
