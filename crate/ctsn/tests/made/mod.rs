//! Files for the tests of the binary: a small character and garment, made here, and ways to spoil them; a folder to run
//! `ctsn` in.
#![allow(dead_code)] // each test takes what it needs

use ctsn_rig::gltf::{self, Appearance};
use ctsn_rig::{Character, Clip, Garment, Joint, Mesh, SkinnedMesh};
use glam::{DAffine3, DVec3};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A folder of files for one test.
pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: &[u8]) -> &Self {
        std::fs::write(self.path(name), bytes).expect("a file written");
        self
    }

    /// `ctsn` with `arguments`, in this folder.
    pub fn run(&self, arguments: &str) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_ctsn"));
        command.current_dir(self.0.path()).args(arguments.split_whitespace());
        command.output().expect("ctsn runs")
    }

    /// Asserts that `ctsn` refuses `arguments` with every part of `says` in its message, and writes no output.
    #[track_caller]
    pub fn refuses(&self, arguments: &str, says: &[&str]) {
        let output = self.run(arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "ctsn {arguments}: {message}");
        assert!(!message.contains("panicked"), "ctsn {arguments}: {message}");
        assert!(message.lines().any(|line| line.starts_with("error: ")), "ctsn {arguments}: {message}");
        for part in says {
            assert!(message.contains(part), "ctsn {arguments}: wanted {part:?} in {message:?}");
        }
        assert!(!self.path("out.safetensors").exists(), "ctsn {arguments} left a file behind");
    }

    /// Asserts success; what was printed.
    #[track_caller]
    pub fn accepts(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        assert!(output.status.success(), "ctsn {arguments}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    }
}

/// Closed box of half size `half`, counter-clockwise from outside, every face in `cells` × `cells` squares.
fn cuboid(half: DVec3, cells: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let step = |i: u32| 2.0 * f64::from(i) / f64::from(cells) - 1.0;
    let mut index = std::collections::BTreeMap::new();
    for (axis, side) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
        let mut corner = |i: u32, j: u32| {
            let mut point = [0.0; 3];
            (point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3]) = (side, step(i), step(j));
            *index.entry(point.map(|c| (c * 1e6) as i64)).or_insert_with(|| {
                mesh.positions.push(DVec3::from_array(point) * half);
                mesh.positions.len() as u32 - 1
            })
        };
        for (i, j) in (0..cells).flat_map(|i| (0..cells).map(move |j| (i, j))) {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            let faces = if side > 0.0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
            mesh.triangles.extend(faces);
        }
    }
    mesh
}

/// A box 1.2 m tall on two joints, with one clip of three frames.
fn character() -> Character {
    let bind = [DAffine3::IDENTITY, DAffine3::from_translation(DVec3::Y * 0.2)];
    let joint = |(at, name): (usize, &str)| Joint {
        name: name.to_owned(),
        parent: at.checked_sub(1),
        inverse_bind: bind[at].inverse(),
    };
    let body = cuboid(DVec3::new(0.15, 0.6, 0.15), 4);
    let weights = body.positions.iter().map(|p| vec![(usize::from(p.y > 0.2), 1.0)]).collect();
    let pose = |frame: usize| bind.iter().map(|joint| DAffine3::from_rotation_y(0.1 * frame as f64) * *joint).collect();
    let clips = vec![Clip { name: "turn".to_owned(), rate: 10.0, poses: (0..3).map(pose).collect() }];
    let joints = ["Hips", "Chest"].into_iter().enumerate().map(joint).collect();
    Character {
        joints,
        root: 0,
        body: SkinnedMesh { mesh: body, weights },
        surface: Default::default(),
        clips,
        metres_per_unit: 1.0,
        parts: Default::default(),
    }
}

/// Writes `character.glb` as `change` leaves it.
pub fn write_character(folder: &Folder, change: impl FnOnce(&mut Character)) {
    let mut made = character();
    change(&mut made);
    let surface = &mut made.surface;
    surface.vertex = (0..made.body.mesh.positions.len() as u32).collect();
    surface.triangles.clone_from(&made.body.mesh.triangles);
    gltf::write_character(&folder.path("character.glb"), &made, &Appearance::default()).expect("a character written");
}

/// Writes `garment.glb`: an open box around the character's, `away` metres from where it is worn.
pub fn write_garment(folder: &Folder, away: DVec3) {
    let mesh = cuboid(DVec3::new(0.17, 0.2, 0.17), 6);
    write_part(folder, &mesh, away, |corners| corners.iter().any(|corner| corner.y.abs() < 0.19));
}

/// Writes `garment.glb`: a blanket that lies on top of the character's box.
pub fn write_blanket(folder: &Folder) {
    let mesh = cuboid(DVec3::new(0.12, 0.604, 0.12), 6);
    write_part(folder, &mesh, DVec3::ZERO, |corners| corners.iter().all(|corner| corner.y > 0.6));
}

/// Writes the triangles of `mesh` whose corners `kept` wants, moved by `away`.
fn write_part(folder: &Folder, mesh: &Mesh, away: DVec3, kept: impl Fn([DVec3; 3]) -> bool) {
    let wanted = |triangle: &&[u32; 3]| kept(triangle.map(|i| mesh.positions[i as usize]));
    let triangles: Vec<_> = mesh.triangles.iter().filter(wanted).copied().collect();
    let index: std::collections::BTreeSet<u32> = triangles.iter().flatten().copied().collect();
    let index: Vec<u32> = index.into_iter().collect();
    let place = |i: u32| index.binary_search(&i).expect("a kept vertex") as u32;
    let mut garment = Garment::default();
    garment.mesh.triangles = triangles.iter().map(|triangle| triangle.map(place)).collect();
    garment.mesh.positions = index.iter().map(|i| mesh.positions[*i as usize] + away).collect();
    garment.surface.vertex = (0..garment.mesh.positions.len() as u32).collect();
    garment.surface.triangles.clone_from(&garment.mesh.triangles);
    gltf::write_garment(&folder.path("garment.glb"), &garment).expect("a garment written");
}

/// Rewrites `garment.glb` as `change` leaves it.
pub fn change_garment(folder: &Folder, change: impl FnOnce(&mut Garment)) {
    let path = folder.path("garment.glb");
    let (mut garment, _) = gltf::read_garment(&path, 1.0).expect("a garment");
    change(&mut garment);
    garment.surface.triangles.clone_from(&garment.mesh.triangles);
    gltf::write_garment(&path, &garment).expect("a garment written");
}

/// Rewrites a GLB of the folder with its JSON and binary chunk changed.
pub fn edit(path: &Path, change: impl FnOnce(&mut Value, &mut [u8])) {
    let bytes = std::fs::read(path).expect("a GLB");
    let glb = ::gltf::Glb::from_slice(&bytes).expect("a GLB");
    let mut json: Value = serde_json::from_slice(&glb.json).expect("JSON");
    let mut bin = glb.bin.expect("bytes").to_vec();
    change(&mut json, &mut bin);
    let edited = ::gltf::Glb { header: glb.header, json: json.to_string().into_bytes().into(), bin: Some(bin.into()) };
    std::fs::write(path, edited.to_vec().expect("a GLB")).expect("a file written");
}

/// Makes the first number of the file's positions NaN.
pub fn spoil(json: &mut Value, bin: &mut [u8]) {
    let accessor = json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().expect("an accessor");
    let view = json["accessors"][accessor as usize]["bufferView"].as_u64().expect("a view");
    let offset = json["bufferViews"][view as usize]["byteOffset"].as_u64().unwrap_or(0) as usize;
    bin[offset..offset + 4].copy_from_slice(&f32::NAN.to_le_bytes());
}
