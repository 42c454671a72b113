//! The part of the body a garment can touch: its triangles, adjacency and skin, without a pose.
//! Far joints (hands below a T-shirt) are not touched at all: a thin part far away only pinches. Leaving single far
//! triangles untouched was tried and made holes in limbs that later met the cloth. Obstacles come from anywhere.

use std::collections::BTreeMap;

use glam::{DAffine3, DMat3, DVec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};

use super::posed::PosedBody;
use crate::rig::{Character, Mesh, SkinWeights, strongest};
use crate::{Error, Result};

/// Canonical distance within which faces belong to one part, metres.
const SAME_PART: f64 = 0.12;

/// The body in the canonical pose.
#[derive(Clone)]
pub(super) struct Collider {
    /// Canonical positions of the vertices used, metres.
    pub rest: Vec<DVec3>,
    /// Skin weights of the vertices used.
    pub weights: Vec<SkinWeights>,
    /// Faces over the vertices used.
    pub faces: Vec<[u32; 3]>,
    /// Whether cloth touches a face at all; the others only close the surface.
    pub touched: Vec<bool>,
    /// Face across each edge (edge k from corner k to k + 1); the face itself at a border.
    pub neighbours: Vec<[u32; 3]>,
    /// Bounding volume tree over the canonical faces, refitted per pose.
    pub tree: Bvh,
}

impl Collider {
    /// Keeps the triangles of every obstacle, and of every joint that moves a body vertex within `reach` metres of the garment,
    /// canonical.
    pub fn new(character: &Character, garment: &Mesh, reach: f64) -> Result<Self> {
        check(character)?;
        let near = joints_near(character, garment, reach)?;
        let collider = Self::of_joints(character, &near);
        if !collider.touched.contains(&true) {
            return Err(Error::Garment(format!("wanted body triangles within {reach} m, found none")));
        }
        Ok(collider)
    }

    /// The body, touched where a joint marked in `near` moves a corner most.
    pub fn of_joints(character: &Character, near: &[bool]) -> Self {
        let body = &character.body.positions;
        let mut used = BTreeMap::new();
        let (mut faces, mut touched) = (Vec::new(), Vec::new());
        for triangle in &character.body.triangles {
            let [a, b, c] = triangle.map(|i| body[i as usize]);
            let area = (b - a).cross(c - a).length();
            if area > 1e-8 * (b - a).length_squared().max((c - a).length_squared()) {
                faces.push(triangle.map(|i| {
                    let next = used.len() as u32;
                    *used.entry(i as usize).or_insert(next)
                }));
                touched.push(triangle.iter().any(|&i| near[strongest(&character.weights[i as usize])]));
            }
        }
        let mut rest = vec![DVec3::ZERO; used.len()];
        let mut weights = vec![Vec::new(); used.len()];
        for (vertex, place) in used {
            rest[place as usize] = body[vertex];
            weights[place as usize] = character.weights[vertex].clone();
        }
        let neighbours = neighbours(&faces);
        let boxes: Vec<Aabb> = faces.iter().map(|face| bounds(face.map(|i| rest[i as usize]))).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        Self { rest, weights, faces, touched, neighbours, tree }
    }

    /// The body posed by linear blend skinning with `skinning` (`N·A_j` per joint).
    pub fn pose(&self, skinning: &[DAffine3]) -> PosedBody<'_> {
        let blend = |(rest, weights): (&DVec3, &SkinWeights)| {
            weights.iter().map(|&(joint, weight)| skinning[joint].transform_point3(*rest) * weight).sum()
        };
        PosedBody::new(self, self.rest.iter().zip(&self.weights).map(blend).collect())
    }

    /// The body posed, every vertex raised along its normal by a share of its height, metres.
    pub fn raised(&self, skinning: &[DAffine3], heights: &[f64], share: f64) -> PosedBody<'_> {
        let posed = self.pose(skinning);
        match heights.iter().any(|height| *height > 0.0) {
            true => PosedBody::new(self, posed.offset(heights, share)),
            false => posed,
        }
    }

    /// Whether two faces are near each other in the canonical pose: of one part.
    pub fn near(&self, a: u32, b: u32) -> bool {
        let place = |face: u32| self.rest[self.faces[face as usize][0] as usize];
        place(a).distance(place(b)) < SAME_PART
    }

    /// Skin weights at a point of a face, given by its barycentric coordinates.
    pub fn skin(&self, face: u32, barycentric: [f64; 3]) -> SkinWeights {
        let mut sum: BTreeMap<usize, f64> = BTreeMap::new();
        for (&vertex, share) in self.faces[face as usize].iter().zip(barycentric) {
            for &(joint, weight) in &self.weights[vertex as usize] {
                *sum.entry(joint).or_default() += weight * share;
            }
        }
        sum.into_iter().collect()
    }
}

/// Whether each joint's part of the body is felt by the garment: all obstacles are, and what has a vertex within `reach` metres of it, both
/// canonical.
pub(super) fn joints_near(character: &Character, garment: &Mesh, reach: f64) -> Result<Vec<bool>> {
    let body = &character.body.positions;
    let points: Vec<[f64; 3]> = garment.positions.iter().map(|p| p.to_array()).collect();
    let tree: ImmutableKdTree<f64, 3> = ImmutableKdTree::new_from_slice(&points)
        .map_err(|error| Error::Garment(format!("nearest-vertex search: {error:?}")))?;
    let distance: Vec<f64> = body
        .iter()
        .map(|p| tree.query(&p.to_array()).nearest_one::<SquaredEuclidean<f64>>().execute().distance.sqrt())
        .collect();
    near_enough(body, &distance)?;
    let mut near: Vec<bool> = (0..character.joints.len()).map(|joint| character.is_obstacle(joint)).collect();
    for (weights, distance) in character.weights.iter().zip(&distance) {
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

/// Bounding box of a triangle.
pub(super) fn bounds([a, b, c]: [DVec3; 3]) -> Aabb {
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    Aabb::new(Vector::from_array(low.to_array()), Vector::from_array(high.to_array()))
}

/// The skinned body must be usable: finite, indices in range, weights on known joints.
pub(super) fn check(character: &Character) -> Result<()> {
    let (count, joints) = (character.body.positions.len(), character.joints.len());
    let fail = |reason: String| Err(Error::Simulation(format!("body: {reason}")));
    if character.weights.len() != count {
        return fail(format!("wanted skin weights for {count} vertices, found {}", character.weights.len()));
    }
    if character.root >= joints {
        return fail(format!("wanted a root below {joints} joints, found {}", character.root));
    }
    if let Some(bad) = character.body.positions.iter().position(|p| !p.is_finite()) {
        return fail(format!("vertex {bad}: wanted a finite position"));
    }
    if let Some(bad) = character.body.triangles.iter().flatten().find(|&&i| i as usize >= count) {
        return fail(format!("wanted vertices below {count}, found {bad}"));
    }
    let sound = |weights: &SkinWeights| {
        let sum: f64 = weights.iter().map(|&(_, weight)| weight).sum();
        weights.iter().all(|&(joint, _)| joint < joints) && (sum - 1.0).abs() < 1e-3
    };
    match character.weights.iter().position(|weights| !sound(weights)) {
        Some(bad) => fail(format!("vertex {bad}: wanted weights of sum 1 on joints below {joints}")),
        None => Ok(()),
    }
}

/// A garment further from the body than half the body's size is a mistake (other units, other character).
fn near_enough(body: &[DVec3], distance: &[f64]) -> Result<()> {
    let (low, high) = body.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let limit = 0.5 * (high - low).length();
    let nearest = distance.iter().copied().fold(f64::INFINITY, f64::min);
    if nearest.is_finite() && nearest <= limit {
        return Ok(());
    }
    let reason = format!("wanted within {limit:.3} m of the body in the canonical pose, found {nearest:.3} m away");
    Err(Error::Garment(reason))
}

fn neighbours(faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut edges: BTreeMap<(u32, u32), (usize, usize)> = BTreeMap::new();
    let mut neighbours: Vec<[u32; 3]> = (0..faces.len() as u32).map(|face| [face; 3]).collect();
    for (face, corners) in faces.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            match edges.insert((a.min(b), a.max(b)), (face, k)) {
                None => {}
                Some((other, side)) => {
                    neighbours[face][k] = other as u32;
                    neighbours[other][side] = face as u32;
                }
            }
        }
    }
    neighbours
}
