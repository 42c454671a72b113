//! Meshes and bodies for the tests: equilateral strips, icospheres, a pelvis with two legs, all made from nothing.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec3};

use ctsn_rig::{Character, Joint, Mesh, SkinnedMesh, Surface};

/// Near-equilateral strip in the xz-plane: `columns` + 1 vertices along +x, rows along +z, edge length `edge`.
pub fn strip(columns: usize, rows: usize, edge: f64) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let across = edge * 3f64.sqrt() / 2.0;
    for row in 0..=rows {
        for column in 0..=columns {
            let shift = if row % 2 == 1 { 0.5 } else { 0.0 };
            positions.push(DVec3::new((column as f64 + shift) * edge, 0.0, row as f64 * across));
        }
    }
    let width = columns as u32 + 1;
    for row in 0..rows as u32 {
        for column in 0..columns as u32 {
            let a = row * width + column;
            let (b, c, d) = (a + 1, a + width, a + width + 1);
            let pair = if row % 2 == 1 { [[a, c, d], [a, d, b]] } else { [[a, c, b], [b, c, d]] };
            triangles.extend(pair);
        }
    }
    Mesh { positions, triangles }
}

/// Square sheet at height `y`, side 1 m, `n` × `n` vertices, one diagonal direction.
pub fn sheet(n: usize, y: f64) -> Mesh {
    let step = 1.0 / (n - 1) as f64;
    let at = |i: usize| DVec3::new((i % n) as f64 * step - 0.5, y, (i / n) as f64 * step - 0.5);
    let mut triangles = Vec::new();
    for row in 0..n as u32 - 1 {
        for column in 0..n as u32 - 1 {
            let a = row * n as u32 + column;
            let (b, c, d) = (a + 1, a + n as u32, a + n as u32 + 1);
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    Mesh { positions: (0..n * n).map(at).collect(), triangles }
}

/// Sphere of that radius around the origin: an octahedron subdivided `levels` times.
pub fn sphere(radius: f64, levels: usize) -> Mesh {
    let mut positions = vec![DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
    let mut triangles = vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5u32]];
    for _ in 0..levels {
        let mut middle = BTreeMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(i, j): (u32, u32)| {
                *middle.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    positions.push((positions[i as usize] + positions[j as usize]).normalize());
                    positions.len() as u32 - 1
                })
            });
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    positions.iter_mut().for_each(|p| *p *= radius);
    Mesh { positions, triangles }
}

/// Warp along +Y in every triangle: for the isotropic fabrics of the tests any direction will do.
pub fn down(mesh: &Mesh) -> Vec<DVec3> {
    vec![DVec3::Y; mesh.triangles.len()]
}

/// A body that hangs rigidly on one joint.
pub fn rigid(body: Mesh) -> Character {
    let joint = Joint { name: "hip".into(), parent: None, inverse_bind: DAffine3::IDENTITY };
    let weights = vec![vec![(0, 1.0)]; body.positions.len()];
    character(vec![joint], SkinnedMesh { mesh: body, weights })
}

fn character(joints: Vec<Joint>, body: SkinnedMesh) -> Character {
    let surface = Surface::default();
    Character { joints, root: 0, body, surface, clips: Vec::new(), metres_per_unit: 1.0, parts: Default::default() }
}

/// Closed round cone from `a` (radius `ra`) to `b` (radius `rb`), stretched from a sphere.
fn capsule(a: DVec3, b: DVec3, ra: f64, rb: f64) -> Mesh {
    let axis = (b - a).normalize();
    let turn = glam::DQuat::from_rotation_arc(DVec3::Y, axis);
    let mut mesh = sphere(1.0, 4);
    for p in &mut mesh.positions {
        // Cosine of latitude -> a cap at each end and a straight side in between.
        let along = ((p.y / 0.6).clamp(-1.0, 1.0) + 1.0) / 2.0;
        let radius = ra + (rb - ra) * along;
        let cap = DVec3::new(p.x, p.y - p.y.clamp(-0.6, 0.6), p.z);
        let flat = DVec3::new(cap.x, cap.y * 2.0, cap.z).normalize_or(DVec3::Y) * radius;
        *p = a + (b - a) * along + turn * flat;
    }
    mesh
}

/// Pelvis, two thighs and two shins of overlapping shells; the hip at (0, 1, 0). Joints: hip, then thigh and shin
/// left, thigh and shin right.
pub fn legs() -> Character {
    let hip = DVec3::new(0.0, 1.0, 0.0);
    let mut joints = vec![("hip".to_string(), None, hip)];
    let mut parts = vec![(hip + DVec3::new(-0.06, 0.04, 0.0), hip + DVec3::new(0.06, 0.04, 0.0), 0.11, 0.11, 0)];
    for (side, sign) in [("left", 1.0), ("right", -1.0)] {
        let thigh = hip + DVec3::new(0.085 * sign, -0.05, 0.0);
        let knee = thigh - DVec3::Y * 0.42;
        let index = joints.len();
        joints.push((format!("{side} thigh"), Some(0), thigh));
        joints.push((format!("{side} shin"), Some(index), knee));
        parts.push((thigh, knee, 0.085, 0.055, index));
        parts.push((knee, knee - DVec3::Y * 0.42, 0.055, 0.04, index + 1));
    }
    let mut body = SkinnedMesh::default();
    for (a, b, ra, rb, joint) in parts {
        let mesh = capsule(a, b, ra, rb);
        body.extend(SkinnedMesh { weights: vec![vec![(joint, 1.0)]; mesh.positions.len()], mesh });
    }
    let bind = |(name, parent, place): (String, Option<usize>, DVec3)| Joint {
        name,
        parent,
        inverse_bind: DAffine3::from_translation(-place),
    };
    character(joints.into_iter().map(bind).collect(), body)
}

/// Cone skirt around [`legs`]: `rows` + 1 rings of `around` vertices; the first ring is the waistband.
pub fn skirt(around: usize, rows: usize) -> Mesh {
    let (top, hem, length) = (0.15, 0.27, 0.5);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..=rows {
        let t = row as f64 / rows as f64;
        for i in 0..around {
            let turn = (i as f64 + 0.5 * (row % 2) as f64) / around as f64 * std::f64::consts::TAU;
            let radius = top + (hem - top) * t;
            let (x, z) = (radius * 1.2 * turn.cos(), radius * turn.sin());
            positions.push(DVec3::new(x, 1.06 - t * length, z));
        }
    }
    let n = around as u32;
    for row in 0..rows as u32 {
        for i in 0..n {
            let next = (i + 1) % n;
            let (a, b, c, d) = (row * n + i, row * n + next, (row + 1) * n + i, (row + 1) * n + next);
            triangles.extend(if row % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, d, c], [a, b, d]] });
        }
    }
    Mesh { positions, triangles }
}
