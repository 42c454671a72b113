//! What is interrupted leaves nothing half made that the next run takes for finished.

use super::made::Folder;

#[test]
#[cfg(unix)]
fn a_bake_interrupted_while_it_writes_its_garment_makes_it_anew() {
    let folder = Folder::new();
    folder.accepts("character sphere -o sphere.glb");
    // The system ends a process that writes a file of more than 8 blocks of 512 bytes (1,024 in some shells), within
    // the GLB.
    let bake = "bake sphere.glb --kind sheet --vertices 500 -o out.safetensors";
    let script = format!("ulimit -f 8; {} {bake}", env!("CARGO_BIN_EXE_ctsn"));
    let mut shell = std::process::Command::new("sh");
    let output = shell.args(["-c", &script]).current_dir(folder.path("")).output().expect("sh runs");
    assert!(!output.status.success(), "nothing was interrupted");
    assert!(folder.path("out.work/garment.txt").exists(), "interrupted too early: {output:?}");
    assert!(!folder.path("out.work/garment.glb").exists(), "a half-written garment");
    // The next run gets past its garment.
    folder.refuses(&format!("{bake} --clip none"), &["no clip none"]);
    folder.accepts("garment sphere.glb --check out.work/garment.glb");
}
