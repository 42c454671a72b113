//! Any bytes as a glTF file of a character and of a garment: refused in words, or read, with what is read finite.
#![no_main]

use ctsn_rig::gltf::{read_character, read_garment};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;
use tempfile::TempDir;

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| TempDir::new().expect("a temporary folder"));

fuzz_target!(|bytes: &[u8]| {
    let path = FOLDER.path().join("input.glb");
    std::fs::write(&path, bytes).expect("room for a file");
    if let Ok(character) = read_character(&path, 30.0) {
        assert!(character.joints.iter().all(|joint| joint.inverse_bind.is_finite()), "a bind that is not finite");
    }
    if let Ok((garment, _)) = read_garment(&path, 1.0) {
        assert!(garment.mesh.positions.iter().all(|position| position.is_finite()), "a vertex that is not finite");
    }
});
