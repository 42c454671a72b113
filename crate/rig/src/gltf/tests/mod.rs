//! Tests on small files made here and, on request, on characters from outside (`CTSN_CHARACTERS`).

mod hostile;
mod packed;
mod reading;
mod small;
mod unusual;
mod world;

use super::write::{Appearance, write_character};
use crate::{Character, Clip, Joint, Mesh, SkinnedMesh, Surface};
use glam::{DAffine3, DQuat, DVec2, DVec3};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Poses per second of the made clips.
pub(super) const RATE: f64 = 10.0;
const SIDES: u32 = 6;
const RINGS: u32 = 13;

/// A closed tube 1.2 m tall on a chain of six joints, four to six weights per vertex, a seam along its side, two
/// colours and two clips.
pub(super) fn tube() -> Character {
    let names = ["Hips", "Spine", "Chest", "Neck", "Head", "Crown"];
    let bind: Vec<DAffine3> =
        (0..6).map(|i| DAffine3::from_translation(DVec3::new(0.0, 0.1 + 0.2 * i as f64, 0.0))).collect();
    let joint = |(i, name): (usize, &&str)| Joint {
        name: name.to_string(),
        parent: i.checked_sub(1),
        inverse_bind: bind[i].inverse(),
    };
    let (body, surface) = tube_mesh();
    let weights = body.positions.iter().map(|p| {
        let mut list: Vec<(usize, f64)> =
            (0..6).map(|i| (i, (-30.0 * (p.y - bind[i].translation.y).powi(2)).exp())).filter(|w| w.1 > 0.01).collect();
        let sum: f64 = list.iter().map(|w| w.1).sum();
        list.iter_mut().for_each(|w| w.1 /= sum);
        list.sort_by(|a, b| b.1.total_cmp(&a.1));
        list
    });
    let clips = vec![clip("bend", 11, 0.3, &bind), clip("sway", 4, -0.2, &bind)];
    Character {
        joints: names.iter().enumerate().map(joint).collect(),
        root: 0,
        body: SkinnedMesh { weights: weights.collect(), mesh: body },
        surface,
        clips,
        metres_per_unit: 1.0,
        parts: Default::default(),
    }
}

/// Each joint turns more and more about Z, the hip walks along X.
fn clip(name: &str, frames: usize, turn: f64, bind: &[DAffine3]) -> Clip {
    let pose = |frame: usize| {
        let share = frame as f64 / (frames - 1) as f64;
        let bend = DAffine3::from_rotation_z(turn * share);
        let mut world = DAffine3::from_translation(bind[0].translation + DVec3::X * share) * bend;
        let mut pose = vec![world];
        for _ in 1..bind.len() {
            world = world * DAffine3::from_translation(DVec3::Y * 0.2) * bend;
            pose.push(world);
        }
        pose
    };
    Clip { name: name.to_string(), rate: RATE, poses: (0..frames).map(pose).collect() }
}

fn tube_mesh() -> (Mesh, Surface) {
    let ring_point = |ring: u32, side: f64| {
        let turn = DQuat::from_rotation_y(std::f64::consts::TAU * side / f64::from(SIDES));
        turn * DVec3::new(0.0, 0.0, 0.1) + DVec3::Y * (0.1 * f64::from(ring))
    };
    let welded: fn(u32, u32) -> u32 = |ring, side| ring * SIDES + side % SIDES;
    let drawn: fn(u32, u32) -> u32 = |ring, side| ring * (SIDES + 1) + side;
    let (mut mesh, mut surface) = (Mesh::default(), Surface::default());
    for ring in 0..RINGS {
        mesh.positions.extend((0..SIDES).map(|side| ring_point(ring, f64::from(side))));
        for side in 0..=SIDES {
            surface.vertex.push(welded(ring, side));
            surface.uv.push(DVec2::new(f64::from(side), f64::from(ring)) * 0.05);
        }
    }
    for (ring, side) in (0..RINGS - 1).flat_map(|ring| (0..SIDES).map(move |side| (ring, side))) {
        let quad = |index: fn(u32, u32) -> u32| {
            let (below, above) =
                ([side, side + 1].map(|s| index(ring, s)), [side, side + 1].map(|s| index(ring + 1, s)));
            [[below[0], below[1], above[1]], [below[0], above[1], above[0]]]
        };
        mesh.triangles.extend(quad(welded));
        surface.triangles.extend(quad(drawn));
    }
    for side in 1..SIDES - 1 {
        let (bottom, top) = ([0, side + 1, side], [0, side, side + 1]);
        mesh.triangles.extend([bottom.map(|s| welded(0, s)), top.map(|s| welded(RINGS - 1, s))]);
        surface.triangles.extend([bottom.map(|s| drawn(0, s)), top.map(|s| drawn(RINGS - 1, s))]);
    }
    let half = surface.vertex.len() / 2;
    surface.colour = (0..surface.vertex.len()).map(|at| [if at < half { 0.25 } else { 0.75 }, 0.5, 0.125]).collect();
    (mesh, surface)
}

/// Writes the tube into a folder and returns its path.
pub(super) fn tube_file(folder: &Path) -> PathBuf {
    let path = folder.join("tube.glb");
    write_character(&path, &tube(), &Appearance::default()).unwrap();
    path
}

/// Changes the JSON and the binary chunk of a GLB in place.
pub(super) fn edit(path: &Path, change: impl FnOnce(&mut Value, &mut Vec<u8>)) -> PathBuf {
    let bytes = std::fs::read(path).unwrap();
    let glb = ::gltf::Glb::from_slice(&bytes).unwrap();
    let mut json: Value = serde_json::from_slice(&glb.json).unwrap();
    let mut bin = glb.bin.unwrap().to_vec();
    change(&mut json, &mut bin);
    if json["buffers"].as_array().is_none_or(|buffers| buffers.len() == 1) {
        json["buffers"][0]["byteLength"] = bin.len().into();
    }
    let header = glb.header;
    let edited = ::gltf::Glb { header, json: json.to_string().into_bytes().into(), bin: Some(bin.into()) };
    let path = path.with_file_name("edited.glb");
    std::fs::write(&path, edited.to_vec().unwrap()).unwrap();
    path
}

/// Overwrites the first bytes of what an accessor reads.
pub(super) fn overwrite(json: &Value, bin: &mut [u8], accessor: usize, bytes: &[u8]) {
    let view = json["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
    let offset = json["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize;
    bin[offset..offset + bytes.len()].copy_from_slice(bytes);
}
