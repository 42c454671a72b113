//! The part of the body a garment can touch: its triangles, adjacency and skin, without a pose.
//! Far joints (hands below a T-shirt) are not touched at all: a thin part far away only pinches. Leaving single far
//! triangles untouched was tried and made holes in limbs that later met the cloth. Obstacles come from anywhere.

use std::collections::BTreeMap;

use glam::{DAffine3, DMat3, DVec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};

use super::posed::PosedBody;
use crate::wrap::bounds;
use crate::{Error, Result};
use ctsn_rig::mesh::{self, Edges, Mesh, triangle};
use ctsn_rig::{Character, SkinWeights, SkinnedMesh, strongest};

/// Canonical distance within which faces belong to one part, metres.
const SAME_PART: f64 = 0.12;

/// The body in the canonical pose.
#[derive(Clone)]
pub(super) struct Collider {
    /// The faces with an area, over the vertices they use, in the canonical pose.
    pub body: SkinnedMesh,
    /// Whether cloth touches a face at all; the others only close the surface.
    pub touched: Vec<bool>,
    /// Face across each edge (edge k from corner k to k + 1); the face itself at a border.
    pub neighbours: Vec<[u32; 3]>,
    /// Bounding volume tree over the canonical faces, refitted per pose.
    pub tree: Bvh,
}

impl Collider {
    /// `body`, bound to the character's joints. Cloth touches the triangles of every obstacle, and of every joint that
    /// moves a vertex within `reach` metres of the garment, canonical.
    pub fn new(character: &Character, body: &SkinnedMesh, garment: &Mesh, reach: f64) -> Result<Self> {
        check(character, body)?;
        let near = joints_near(character, body, garment, reach)?;
        let collider = Self::of_joints(body, &near);
        if !collider.touched.contains(&true) {
            return Err(Error::Garment(format!("wanted body triangles within {reach} m, found none")));
        }
        Ok(collider)
    }

    /// The body, touched where a joint marked in `near` moves a corner most.
    pub fn of_joints(body: &SkinnedMesh, near: &[bool]) -> Self {
        let SkinnedMesh { mesh, weights } = body;
        let mut used = BTreeMap::new();
        let (mut faces, mut touched) = (Vec::new(), Vec::new());
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
            if triangle::cross([a, b, c]).length() > 1e-8 * (b - a).length_squared().max((c - a).length_squared()) {
                faces.push(triangle.map(|i| {
                    let next = used.len() as u32;
                    *used.entry(i as usize).or_insert(next)
                }));
                touched.push(triangle.iter().any(|&i| near[strongest(&weights[i as usize])]));
            }
        }
        let mut kept = vec![DVec3::ZERO; used.len()];
        let mut rows = vec![Vec::new(); used.len()];
        for (vertex, place) in used {
            kept[place as usize] = mesh.positions[vertex];
            rows[place as usize] = weights[vertex].clone();
        }
        let neighbours = neighbours(&faces);
        let mesh = Mesh { positions: kept, triangles: faces };
        let boxes: Vec<Aabb> = mesh.corners().map(bounds).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        Self { body: SkinnedMesh { mesh, weights: rows }, touched, neighbours, tree }
    }

    /// The body posed by linear blend skinning with `skinning` (`N·A_j` per joint).
    pub fn pose(&self, skinning: &[DAffine3]) -> PosedBody<'_> {
        PosedBody::new(self, self.body.pose(skinning))
    }

    /// The body posed, every vertex raised along its normal by a share of its height, metres; lowered where that is
    /// below zero.
    pub fn raised(&self, skinning: &[DAffine3], heights: &[f64], share: f64) -> PosedBody<'_> {
        let posed = self.pose(skinning);
        match heights.iter().any(|height| *height != 0.0) {
            true => PosedBody::new(self, posed.offset(heights, share)),
            false => posed,
        }
    }

    /// The body itself in the canonical pose, every vertex raised so.
    pub fn reshaped(self, heights: &[f64]) -> SkinnedMesh {
        let positions = PosedBody::new(&self, self.body.mesh.positions.clone()).offset(heights, 1.0);
        let SkinnedMesh { mesh, weights } = self.body;
        SkinnedMesh { mesh: Mesh { positions, ..mesh }, weights }
    }

    /// Corners of a face.
    pub fn face(&self, face: u32) -> [u32; 3] {
        self.body.mesh.triangles[face as usize]
    }

    /// Whether two faces are near each other in the canonical pose: of one part.
    pub fn near(&self, a: u32, b: u32) -> bool {
        let place = |face: u32| self.body.mesh.positions[self.face(face)[0] as usize];
        place(a).distance(place(b)) < SAME_PART
    }

    /// Skin weights at a point of a face, given by its barycentric coordinates.
    pub fn skin(&self, face: u32, barycentric: [f64; 3]) -> SkinWeights {
        let mut sum: BTreeMap<usize, f64> = BTreeMap::new();
        for (&vertex, share) in self.face(face).iter().zip(barycentric) {
            for &(joint, weight) in &self.body.weights[vertex as usize] {
                *sum.entry(joint).or_default() += weight * share;
            }
        }
        sum.into_iter().collect()
    }
}

/// Whether each joint's part of the body is felt by the garment: all obstacles are, and what has a vertex within
/// `reach` metres of it, both canonical.
pub(super) fn joints_near(character: &Character, body: &SkinnedMesh, garment: &Mesh, reach: f64) -> Result<Vec<bool>> {
    let places = &body.mesh.positions;
    let points: Vec<[f64; 3]> = garment.positions.iter().map(|p| p.to_array()).collect();
    let tree: ImmutableKdTree<f64, 3> = ImmutableKdTree::new_from_slice(&points)
        .map_err(|error| Error::Garment(format!("nearest-vertex search: {error:?}")))?;
    let distance: Vec<f64> = places
        .iter()
        .map(|p| tree.query(&p.to_array()).nearest_one::<SquaredEuclidean<f64>>().execute().distance.sqrt())
        .collect();
    near_enough(places, &distance)?;
    let mut near: Vec<bool> = (0..character.joints.len()).map(|joint| character.is_obstacle(joint)).collect();
    for (weights, distance) in body.weights.iter().zip(&distance) {
        near[strongest(weights)] |= *distance < reach;
    }
    Ok(near)
}

/// `Σ_j w_j M_j`.
pub(super) fn blend(weights: &[(usize, f64)], transforms: &[DAffine3]) -> DAffine3 {
    let zero = DAffine3 { matrix3: DMat3::ZERO, translation: DVec3::ZERO };
    weights.iter().fold(zero, |sum, &(joint, weight)| DAffine3 {
        matrix3: sum.matrix3 + transforms[joint].matrix3 * weight,
        translation: sum.translation + transforms[joint].translation * weight,
    })
}

/// The skinned body must be usable: finite, indices in range, weights on known joints.
pub(super) fn check(character: &Character, body: &SkinnedMesh) -> Result<()> {
    let SkinnedMesh { mesh, weights } = body;
    let (count, joints) = (mesh.positions.len(), character.joints.len());
    let fail = |reason: String| Err(Error::Simulation(format!("body: {reason}")));
    if weights.len() != count {
        return fail(format!("wanted skin weights for {count} vertices, found {}", weights.len()));
    }
    if character.root >= joints {
        return fail(format!("wanted a root below {joints} joints, found {}", character.root));
    }
    if let Some(bad) = mesh.positions.iter().position(|p| !p.is_finite()) {
        return fail(format!("vertex {bad}: wanted a finite position"));
    }
    if let Some(bad) = mesh.triangles.iter().flatten().find(|&&i| i as usize >= count) {
        return fail(format!("wanted vertices below {count}, found {bad}"));
    }
    let sound = |weights: &SkinWeights| {
        let sum: f64 = weights.iter().map(|&(_, weight)| weight).sum();
        weights.iter().all(|&(joint, _)| joint < joints) && (sum - 1.0).abs() < 1e-3
    };
    match weights.iter().position(|weights| !sound(weights)) {
        Some(bad) => fail(format!("vertex {bad}: wanted weights of sum 1 on joints below {joints}")),
        None => Ok(()),
    }
}

/// A garment further from the body than half the body's size is a mistake (other units, other character).
fn near_enough(body: &[DVec3], distance: &[f64]) -> Result<()> {
    let [low, high] = mesh::bounds(body.iter().copied());
    let limit = 0.5 * (high - low).length();
    let nearest = distance.iter().copied().fold(f64::INFINITY, f64::min);
    if nearest.is_finite() && nearest <= limit {
        return Ok(());
    }
    let reason = format!("wanted within {limit:.3} m of the body in the canonical pose, found {nearest:.3} m away");
    Err(Error::Garment(reason))
}

/// Face across each edge (edge k from corner k to k + 1); the face itself at a border.
fn neighbours(faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut neighbours: Vec<[u32; 3]> = (0..faces.len() as u32).map(|face| [face; 3]).collect();
    for (_, sides) in Edges::new(faces).iter() {
        for pair in sides.windows(2) {
            neighbours[pair[1].triangle][pair[1].corner] = pair[0].triangle as u32;
            neighbours[pair[0].triangle][pair[0].corner] = pair[1].triangle as u32;
        }
    }
    neighbours
}
