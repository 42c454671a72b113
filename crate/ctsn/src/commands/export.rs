//! `ctsn export`: the network for other runtimes.

use super::model;
use crate::onnx::onnx;
use anyhow::Result;
use ctsn_rig::file;
use std::path::PathBuf;

/// Write the network as ONNX, for Unity, Unreal and any other runtime
///
/// Input  `joints`    [J, 3, 4] float32: world transforms of the joints, row-major, metres, in the order of
///                    `ctsn inspect MODEL` (the file's metadata has it, too: `joints`, a JSON list).
/// Output `positions` [n, 3] float32: the cloth's vertices in the world, metres, as `ctsn predict` gives them
///                    before its polish and its repair of penetration, which are not part of the network.
///
/// Opset 15. Triangles and texture coordinates stay in the model file. docs/export.md tells how to feed it.
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// Model file (safetensors)
    model: PathBuf,
    /// Where to write the network (ONNX)
    #[arg(short, long)]
    output: PathBuf,
}

pub fn run(Arguments { model: path, output }: &Arguments) -> Result<()> {
    let model = model(path)?;
    let (joints, n) = (model.sizes.joints, model.sizes.vertices);
    let bytes = onnx(&model);
    file::write(output, &bytes)?;
    if model.ride.is_some() {
        println!("the drawn mesh that rides on the cloth stays in the model file: docs/export.md");
    }
    println!("{}: joints [{joints}, 3, 4] -> positions [{n}, 3], {:.1} MB", output.display(), bytes.len() as f64 / 1e6);
    Ok(())
}
