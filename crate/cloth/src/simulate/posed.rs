//! Signed distance to the posed body: closest point by a bounding volume tree, sign by angle-weighted pseudo-normals
//! (Bærentzen & Aanæs 2005). Linear blend skinning makes bodies that cut through themselves, so depth is limited.

use std::cell::Cell;
use std::f64::consts::TAU;

use glam::DVec3;
use parry3d_f64::partitioning::Bvh;

use super::burial::winding;
use super::collider::Collider;
use super::crossing::pierces;
use crate::wrap::{bounds, squared_distance};
use ctsn_rig::mesh::triangle;

/// How far behind a face a point may lie and still be pushed out through it, metres.
const DEPTH: f64 = 0.05;
/// [`DEPTH`] for other parts than the one the point was last near: the far side of a thin part, or another limb.
const DEPTH_ELSEWHERE: f64 = 0.012;

/// Two sides of a crease differ by at least the angle with this cosine.
const CREASE: f64 = 0.75;

/// A direction without symmetry: rays along body axes run through edges.
const RAY: DVec3 = DVec3::new(0.8313, 0.2231, 0.5090);

/// Which faces a search considers.
#[derive(Clone, Copy)]
enum Faces {
    /// All.
    All,
    /// Those that look another way than this normal.
    Across(DVec3),
    /// Those of the part this face belongs to.
    Around(u32),
    /// Those of the side the tracked face belongs to.
    Side,
}

/// The closest point of the body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    /// Face of the collider.
    pub face: u32,
    /// Barycentric coordinates on the face.
    pub barycentric: [f64; 3],
    /// Unit gradient of the signed distance.
    pub normal: DVec3,
    /// Signed distance in metres, negative inside.
    pub distance: f64,
}

/// A collider in one pose.
pub(super) struct PosedBody<'a> {
    /// What is posed.
    pub collider: &'a Collider,
    positions: Vec<DVec3>,
    face_normals: Vec<DVec3>,
    vertex_normals: Vec<DVec3>,
    tree: Bvh,
    /// Faces found to be buried or not.
    buried: Vec<Cell<Option<bool>>>,
}

impl<'a> PosedBody<'a> {
    /// `positions`: posed collider vertices, metres.
    pub fn new(collider: &'a Collider, positions: Vec<DVec3>) -> Self {
        let mut vertex_normals = vec![DVec3::ZERO; positions.len()];
        let mut face_normals = Vec::with_capacity(collider.touched.len());
        let mut tree = collider.tree.clone();
        for (index, face) in collider.body.mesh.triangles.iter().enumerate() {
            let corners = face.map(|i| positions[i as usize]);
            let normal = triangle::cross(corners).normalize_or_zero();
            for k in 0..3 {
                let (u, v) = (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
                let cosine = u.dot(v) / (u.length() * v.length()).max(1e-30);
                vertex_normals[face[k] as usize] += normal * cosine.clamp(-1.0, 1.0).acos();
            }
            face_normals.push(normal);
            tree.update_partially_if_present(bounds(corners), index as u32, 0.0);
        }
        tree.refit_without_opt();
        let buried = vec![Cell::new(None); collider.touched.len()];
        Self { collider, positions, face_normals, vertex_normals, tree, buried }
    }

    /// Posed vertices, each moved along its normal by a share of its height, metres.
    pub fn offset(&self, heights: &[f64], share: f64) -> Vec<DVec3> {
        let outward = self.vertex_normals.iter().map(|normal| normal.normalize_or_zero());
        self.positions
            .iter()
            .zip(outward)
            .zip(heights)
            .map(|((p, normal), height)| p + normal * (share * height))
            .collect()
    }

    /// The closest body point within `reach` metres, or none. `tracked`: the face found before, which speeds up the
    /// search and tells near sides from far ones.
    pub fn closest(&self, point: DVec3, tracked: Option<u32>, reach: f64) -> Option<Hit> {
        self.search(point, tracked, reach, Faces::All)
    }

    /// The closest point of another side of a concave crease than that of `first`, within `reach` metres.
    pub fn across_crease(&self, point: DVec3, first: &Hit, reach: f64) -> Option<Hit> {
        let hit = self.search(point, Some(first.face), reach, Faces::Across(first.normal))?;
        (hit.normal.dot(first.normal) < CREASE).then_some(hit)
    }

    /// The closest point of the part that `face` belongs to, within `reach` metres.
    pub fn closest_around(&self, point: DVec3, face: u32, reach: f64) -> Option<Hit> {
        self.search(point, None, reach, Faces::Around(face))
    }

    /// The closest point of the side of the part that `face` belongs to, within `reach` metres.
    pub fn closest_on_side(&self, point: DVec3, face: u32, reach: f64) -> Option<Hit> {
        self.search(point, Some(face), reach, Faces::Side)
    }

    /// Unit normal of a face.
    pub fn normal(&self, face: u32) -> DVec3 {
        self.face_normals[face as usize]
    }

    /// A point of a face, metres.
    pub fn point(&self, face: u32, barycentric: [f64; 3]) -> DVec3 {
        triangle::point(self.corners(face), barycentric)
    }

    /// Whether another part of the body lies within `gap` metres above a face, or the face is inside one.
    pub fn is_buried(&self, face: u32, gap: f64) -> bool {
        let known = &self.buried[face as usize];
        known.get().unwrap_or_else(|| {
            let buried = self.winding(face, gap, RAY) != 0;
            known.set(Some(buried));
            buried
        })
    }

    /// Whether the place `gap` metres above a face is inside the body, by rays both ways: a single one may enter an
    /// open shell unseen.
    pub fn is_within(&self, face: u32, gap: f64) -> bool {
        [RAY, -RAY].iter().all(|ray| self.winding(face, gap, *ray) > 0)
    }

    /// Winding number of the body about the place `gap` metres above a face, by a ray.
    fn winding(&self, face: u32, gap: f64, ray: DVec3) -> i32 {
        let [a, b, c] = self.corners(face);
        let above = (a + b + c) / 3.0 + self.face_normals[face as usize] * gap;
        winding(&self.tree, above, ray, |face| self.corners(face))
    }

    /// Whether a point is inside the body, by the solid angle of its faces (generalised winding number, Jacobson et al.
    /// 2013): behind the nearest face may be outside, where shells are open or folded.
    pub fn encloses(&self, point: DVec3) -> bool {
        // A corner is that of six faces.
        let towards: Vec<DVec3> = self.positions.iter().map(|corner| (*corner - point).normalize_or_zero()).collect();
        let angle = |face: &[u32; 3]| triangle::solid_angle_between(face.map(|i| towards[i as usize]));
        self.collider.body.mesh.triangles.iter().map(angle).sum::<f64>() > TAU
    }

    /// Whether a face within `reach` metres of a point is buried: the body passes into itself there.
    pub fn pinches(&self, point: DVec3, reach: f64, gap: f64) -> bool {
        let around = bounds([point - reach, point + reach, point]);
        self.tree.intersect_aabb(&around).any(|face| self.is_buried(face, gap))
    }

    /// Whether a segment passes through a face that cloth touches.
    pub fn crosses(&self, ends: [DVec3; 2]) -> bool {
        let around = bounds([ends[0], ends[1], ends[1]]);
        self.tree
            .intersect_aabb(&around)
            .any(|face| self.collider.touched[face as usize] && pierces(ends, self.corners(face)))
    }

    /// Posed corners of a face, metres.
    fn corners(&self, face: u32) -> [DVec3; 3] {
        self.collider.face(face).map(|i| self.positions[i as usize])
    }

    fn search(&self, point: DVec3, tracked: Option<u32>, reach: f64, faces: Faces) -> Option<Hit> {
        let guess = tracked.and_then(|face| Some((face, self.candidate(face, point, tracked, faces, reach * reach)?)));
        let bound = guess.as_ref().map_or(reach * reach, |(_, (squared, _))| *squared);
        let found = self.tree.find_best(
            bound,
            |node, _| squared_distance(node, point),
            |face, best| self.candidate(face, point, tracked, faces, best),
        );
        let (face, (squared, spot)) = found.or(guess)?;
        let offset = point - spot.point;
        let distance = squared.sqrt();
        let sign = if offset.dot(spot.normal) < 0.0 { -1.0 } else { 1.0 };
        let normal = if distance > 1e-7 { offset * (sign / distance) } else { spot.normal };
        Some(Hit { face, barycentric: spot.barycentric, normal, distance: sign * distance })
    }

    /// Squared distance to a face and where, if below `best` and not refused as too deep.
    fn candidate(&self, face: u32, point: DVec3, tracked: Option<u32>, faces: Faces, best: f64) -> Option<(f64, Spot)> {
        if !self.collider.touched[face as usize] {
            return None;
        }
        let corners = self.corners(face);
        let barycentric = triangle::closest(point, corners);
        let foot = self.point(face, barycentric);
        let squared = foot.distance_squared(point);
        if squared >= best {
            return None;
        }
        let normal = self.pseudo_normal(face, barycentric);
        let own = tracked
            .is_none_or(|old| self.face_normals[old as usize].dot(normal) > 0.0 && self.collider.near(old, face));
        let behind = (point - foot).dot(normal) < 0.0;
        let refused = match faces {
            Faces::All => false,
            Faces::Around(centre) => !self.collider.near(centre, face),
            Faces::Side => !own,
            // Behind a face turned all the way round is not a crease but the far side of a thin part.
            Faces::Across(first) => !(if behind { -CREASE } else { -1.0 }..CREASE).contains(&first.dot(normal)),
        };
        let limit = if own { DEPTH } else { DEPTH_ELSEWHERE };
        if refused || behind && (squared > limit * limit || self.on_border(face, barycentric)) {
            return None;
        }
        Some((squared, Spot { point: foot, barycentric, normal }))
    }

    /// Whether the closest point lies on the border of an open body: nothing is behind that.
    fn on_border(&self, face: u32, barycentric: [f64; 3]) -> bool {
        (0..3).any(|k| barycentric[k] == 0.0 && self.collider.neighbours[face as usize][(k + 1) % 3] == face)
    }

    /// Face normal inside a face, mean of two on an edge, angle-weighted mean at a corner; unit length.
    fn pseudo_normal(&self, face: u32, barycentric: [f64; 3]) -> DVec3 {
        let own = self.face_normals[face as usize];
        let zeros = barycentric.iter().filter(|&&b| b == 0.0).count();
        let sum = match zeros {
            0 => return own,
            1 => {
                let opposite = barycentric.iter().position(|&b| b == 0.0).unwrap_or(0);
                let across = self.collider.neighbours[face as usize][(opposite + 1) % 3];
                own + self.face_normals[across as usize]
            }
            _ => {
                let corner = barycentric.iter().position(|&b| b != 0.0).unwrap_or(0);
                self.vertex_normals[self.collider.face(face)[corner] as usize]
            }
        };
        sum.try_normalize().unwrap_or(own)
    }
}

/// Closest point of a face and the pseudo-normal there.
struct Spot {
    point: DVec3,
    barycentric: [f64; 3],
    normal: DVec3,
}
