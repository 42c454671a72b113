//! A garment at one fineness, ready to be simulated.

use std::sync::Arc;

use ctsn_core::topology::Graph;
use ctsn_rig::{Mesh, SkinWeights};
use glam::{DAffine3, DVec3};

use super::cloth::Cloth;
use super::collider::{Collider, blend};
use super::contact::Pin;
use super::material::Material;
use super::newton::{Layout, Solver};
use super::posed::PosedBody;
use super::settings::Settings;
use crate::Result;

/// How far from the body a vertex may be that is worn on it, metres.
const WORN: f64 = 0.12;

/// A garment of `n` vertices.
pub(super) struct Level {
    pub cloth: Cloth,
    pub layout: Arc<Layout>,
    /// Neighbours of each vertex.
    pub rings: Graph<Vec<u32>>,
    /// Skin of each attached vertex: that of the closest body point.
    attached: Vec<(usize, SkinWeights)>,
    /// Stiffness of the spring at each of them, N/m.
    attachment: f64,
}

impl Level {
    /// Of a garment at rest, where it is worn in the canonical pose; `attached` of its vertices are sprung to the body.
    pub fn new(
        mesh: &Mesh,
        warp: &[DVec3],
        material: &Material,
        settings: &Settings,
        collider: &Collider,
        attached: &[u32],
    ) -> Result<Self> {
        let mut cloth = Cloth::new(mesh, warp, material, settings.shape)?;
        let body = PosedBody::new(collider, collider.body.mesh.positions.clone());
        cloth.worn = worn(&body, &mesh.positions);
        // Fewer springs that hold as much in all.
        let attachment = settings.attachment * (settings.attached.len() as f64 / attached.len().max(1) as f64);
        Ok(Self {
            layout: Arc::new(Layout::new(&cloth, &[])?),
            rings: mesh.rings(),
            attached: attach(&body, &mesh.positions, attached),
            attachment,
            cloth,
        })
    }

    /// The garment at `positions`, at rest.
    pub fn solver<'a>(&'a self, settings: &'a Settings, positions: Vec<DVec3>) -> Solver<'a> {
        Solver::new(&self.cloth, &self.layout, settings, positions)
    }

    /// Springs of the attached vertices: their template positions, skinned.
    pub fn pin(&self, solver: &mut Solver, template: &[DVec3], skinning: &[DAffine3]) {
        let pin = |(vertex, skin): &(usize, SkinWeights)| {
            let target = blend(skin, skinning).transform_point3(template[*vertex]);
            Pin { vertex: *vertex, target, stiffness: self.attachment }
        };
        solver.pins = self.attached.iter().map(pin).collect();
    }
}

/// The face of the canonical body that each vertex is worn on, if it is near one.
fn worn(body: &PosedBody, rest: &[DVec3]) -> Vec<Option<u32>> {
    rest.iter().map(|x| Some(body.closest(*x, None, WORN)?.face)).collect()
}

/// Attached vertices with the skin of the canonical body's point closest to them.
fn attach(body: &PosedBody, rest: &[DVec3], attached: &[u32]) -> Vec<(usize, SkinWeights)> {
    let skin = |&vertex: &u32| {
        let hit = body.closest(rest[vertex as usize], None, f64::MAX.sqrt())?;
        Some((vertex as usize, body.collider.skin(hit.face, hit.barycentric)))
    };
    attached.iter().filter_map(skin).collect()
}
