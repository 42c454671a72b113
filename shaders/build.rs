//! Tells the tests whether tint is installed: `cfg(tint)`.

use std::process::{Command, Stdio};

fn main() {
    println!("cargo::rustc-check-cfg=cfg(tint)");
    println!("cargo::rerun-if-env-changed=PATH");
    let tint = Command::new("tint").arg("--help").stdout(Stdio::null()).stderr(Stdio::null()).status();
    if tint.is_ok() {
        println!("cargo::rustc-cfg=tint");
    }
}
