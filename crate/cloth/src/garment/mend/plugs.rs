//! Openings that are closed by discs or cones, which hide that there is no body inside: bones pass through them, as
//! through no cloth that is worn. Such faces are deleted.

use super::patch::Patch;
use crate::garment::check::list;
use crate::wrap::{Bone, Faces};
use ctsn_rig::gltf::Source;
use ctsn_rig::mesh::{Edges, triangle};
use ctsn_rig::{Character, Garment, Mesh};
use glam::DVec3;
use std::collections::BTreeSet;

/// A face of a plug looks along the bone by more than the first, cosine, and goes on from face to face around folds of
/// more than the second.
const ALONG: f64 = 0.35;
const FOLD: f64 = 0.26;
/// A plug is at most this share of the garment's area: a bag is more.
const SHARE: f64 = 0.2;

/// Deletes the plugs of a garment; what was opened, where.
pub(in crate::garment) fn open(
    character: &Character,
    bones: &[Bone],
    garment: Garment,
    source: Source,
    said: &mut Vec<String>,
) -> (Garment, Source) {
    let mesh = &garment.mesh;
    let normals: Vec<DVec3> = mesh.corners().map(|corners| triangle::cross(corners).normalize_or_zero()).collect();
    let mut gone: BTreeSet<usize> = BTreeSet::new();
    let mut opened = Vec::new();
    let edges = Edges::new(&mesh.triangles);
    let faces = Faces::new(mesh);
    for bone in bones {
        let along = bone.ends[1] - bone.ends[0];
        let Some(axis) = along.try_normalize() else { continue };
        let pierced = faces.pierced(bone.ends[0], axis, along.length());
        for seed in pierced {
            if gone.contains(&seed) {
                continue;
            }
            let plug = grown(seed, axis, mesh, &normals, &edges);
            let area: f64 = plug.iter().map(|face| area(mesh, *face)).sum();
            if area < SHARE * mesh.area() && !plug.is_empty() {
                let vertex = source.numbers[mesh.triangles[seed][0] as usize];
                let name = &character.joints[bone.joint].name;
                opened.push(format!("{} faces around {name}, with vertex {vertex}", plug.len()));
                gone.extend(plug);
            }
        }
    }
    drop(faces);
    if gone.is_empty() {
        return (garment, source);
    }
    said.push(format!(
        "{} openings that faces closed, through which bones pass, opened: {}",
        opened.len(),
        list(opened.into_iter())
    ));
    let mut patch = Patch::new(&garment, &source);
    patch.retain(|face| !gone.contains(&face));
    let (garment, numbers) = patch.finish(&garment);
    (garment, Source { numbers, ..source })
}

fn area(mesh: &Mesh, face: usize) -> f64 {
    triangle::area(mesh.triangles[face].map(|vertex| mesh.positions[vertex as usize]))
}

/// The faces that a plug has around a pierced one.
fn grown(seed: usize, axis: DVec3, mesh: &Mesh, normals: &[DVec3], edges: &Edges) -> BTreeSet<usize> {
    let across = |face: usize| normals[face].dot(axis).abs() > ALONG;
    let (mut plug, mut queue) = (BTreeSet::new(), vec![seed]);
    while let Some(face) = queue.pop() {
        if !across(face) || !plug.insert(face) {
            continue;
        }
        for side in ctsn_rig::mesh::around(mesh.triangles[face]).iter().flat_map(|edge| edges.at(*edge)) {
            let next = side.triangle;
            if normals[next].dot(normals[face]) > FOLD && !plug.contains(&next) {
                queue.push(next);
            }
        }
    }
    plug
}
