//! `ctsn inspect`: what is in a model file or a dataset folder.

use anyhow::{Context, Result};
use ctsn_core::file::Tensors;
use ctsn_core::model::HostModel;
use ctsn_rig::file;
use ctsn_train::report::Report;
use std::path::PathBuf;

/// Show what is in a model (sizes, tensors, bytes, joints, training), or the report of a dataset
#[derive(clap::Args)]
pub struct Arguments {
    /// Model file (safetensors), or dataset folder
    path: PathBuf,
}

pub fn run(Arguments { path }: &Arguments) -> Result<()> {
    if path.is_dir() {
        println!("{}", Report::new(path)?);
        return Ok(());
    }
    let bytes = file::read(path)?;
    let context = || path.display().to_string();
    let tensors = Tensors::parse(&bytes).with_context(context)?;
    let model = HostModel::parse(&bytes).with_context(context)?;
    let sizes = model.sizes;
    println!("{}: {} bytes, {} tensors", path.display(), bytes.len(), tensors.tensors.len());
    println!("  cloth      {} vertices, {} triangles", sizes.vertices, model.triangles.len() / 3);
    if let Some(ride) = &model.ride {
        let (vertices, triangles) = (ride.corners.len() / 3, ride.triangles.len() / 3);
        println!("  drawn      {vertices} vertices, {triangles} triangles, which ride on the cloth");
    }
    println!("  joints     {}, root {}, frame {:?}", sizes.joints, model.rig.joints[model.rig.root], model.rig.frame);
    println!("  embedding  m = {}, layers {}", sizes.embedding, outputs(&model.embedding));
    println!("  graph      {} layers, {} heads × {}", model.layers.len(), sizes.heads, sizes.features / sizes.heads);
    println!("  vertex MLP k = {}, layers {}", sizes.basis, outputs(&model.vertex_mlp));
    println!("  skinning   up to {} joints a vertex", model.skinning.width);
    println!("  trained    {}", model.training.as_deref().unwrap_or("(the file does not say)"));
    println!("  joints     {}", model.rig.joints.join(", "));
    println!("  tensors");
    for (name, tensor) in &tensors.tensors {
        let shape = format!("{:?}", tensor.shape);
        println!("    {name:<24} {:<4} {shape:<16} {:>10} bytes", tensor.dtype.name(), tensor.bytes.len());
    }
    Ok(())
}

fn outputs(layers: &[ctsn_core::model::Linear<Vec<f32>>]) -> String {
    layers.iter().map(|layer| layer.outputs.to_string()).collect::<Vec<_>>().join(" → ")
}
