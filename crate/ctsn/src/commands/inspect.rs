//! `ctsn inspect`: what is in a model file, a dataset folder, or a character.

use super::ordered;
use anyhow::{Context, Result, bail};
use ctsn_cloth::simulate::BodyDistance;
use ctsn_core::cpu::Level;
use ctsn_core::file::Tensors;
use ctsn_core::model::HostModel;
use ctsn_core::{Predictor, Streams};
use ctsn_rig::path::body_frame;
use ctsn_rig::{Character, Mesh, Pose, file, gltf, joints, vertices};
use ctsn_train::report::Report;
use glam::DVec3;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Poses a second that are predicted of a character's clips.
const RATE: f64 = 6.0;
/// Poses a second that the lengths of clips are told by.
const FINE_RATE: f64 = 30.0;

/// Show what is in a model (sizes, tensors, bytes, joints, training), the report of a dataset, or the body, joints and
/// clips of a character
#[derive(clap::Args)]
pub struct Arguments {
    /// Model file (safetensors), dataset folder, or character (glTF)
    path: PathBuf,
    /// Tell instead how much of a model's cloth is inside its character (glTF) in every clip, before the repair and
    /// after
    #[arg(long, value_name = "CHARACTER")]
    on: Option<PathBuf>,
}

pub fn run(Arguments { path, on }: &Arguments) -> Result<()> {
    if let Some(character) = on {
        return inside(path, character);
    }
    if path.is_dir() {
        println!("{}", Report::new(path)?);
        return Ok(());
    }
    let bytes = file::read(path)?;
    if bytes.starts_with(b"glTF") || path.extension().is_some_and(|ending| ending == "gltf") {
        return rigged(path);
    }
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

/// Prints a character's size, joints and clips.
fn rigged(path: &Path) -> Result<()> {
    let character = gltf::read_character(path, FINE_RATE)?;
    let mesh = &character.body.mesh;
    println!("{}: a character", path.display());
    println!(
        "  body       {} vertices, {} triangles, {:.2} m at its greatest extent",
        mesh.positions.len(),
        mesh.triangles.len(),
        mesh.extent()
    );
    let names: Vec<&str> = character.joints.iter().map(|joint| joint.name.as_str()).collect();
    println!("  joints     {}, root {}: {}", names.len(), names[character.root], names.join(", "));
    println!("  clips      {}", character.clips.len());
    for clip in &character.clips {
        println!("    {:<24} {:.1} s", clip.name, clip.poses.len().saturating_sub(1) as f64 / clip.rate);
    }
    Ok(())
}

fn outputs(layers: &[ctsn_core::model::Linear<Vec<f32>>]) -> String {
    layers.iter().map(|layer| layer.outputs.to_string()).collect::<Vec<_>>().join(" → ")
}

/// Prints the share of the cloth's vertices inside the character, and how deep, by clip and over all.
fn inside(path: &Path, character: &Path) -> Result<()> {
    let model = super::model(path)?;
    let character = gltf::read_character(character, RATE)?;
    if character.clips.is_empty() {
        bail!("the character has no clip to look at");
    }
    let cloth = Mesh { positions: vertices(&model.rest), triangles: model.triangles.as_chunks().0.to_vec() };
    let body = BodyDistance::new(&character, &cloth)?;
    let names = model.rig.joints.clone();
    let ways = [HostModel { body: None, ..model.clone() }, model];
    // One of each a thread.
    let predictors = || ways.each_ref().map(|way| Predictor::from_model(way.clone(), Level::new()));
    println!("vertices inside the body before the repair, and after: share, deepest");
    let mut all = [(0.0, 0.0_f64); 2];
    let mut count = 0;
    for clip in &character.clips {
        let look = |ways: &mut [Predictor; 2], pose: &Pose| look(ways, &names, &character, &body, pose);
        let frames = clip.poses.par_iter().map_init(predictors, look);
        let frames = frames.collect::<Result<Vec<_>>>()?;
        let over = |way: usize| {
            frames.iter().fold((0.0, 0.0_f64), |(sum, most), frame| (sum + frame[way].0, most.max(frame[way].1)))
        };
        let found = [over(0), over(1)];
        println!("  {:<20} {}", clip.name, told(found, frames.len()));
        all.iter_mut().zip(found).for_each(|(all, found)| *all = (all.0 + found.0, all.1.max(found.1)));
        count += frames.len();
    }
    println!("  {:<20} {}, {count} frames", "all", told(all, count));
    Ok(())
}

/// Share of the vertices inside in one pose, and the greatest depth in metres, by each of the predictors.
fn look(
    ways: &mut [Predictor; 2],
    names: &[String],
    character: &Character,
    body: &BodyDistance,
    pose: &Pose,
) -> Result<[(f64, f64); 2]> {
    let ordered = joints(&ordered(names, character, pose)?);
    let into = body_frame(character, pose);
    let mut found = [(0.0, 0.0); 2];
    for (found, predictor) in found.iter_mut().zip(ways) {
        predictor.predict_row_major(&ordered, Streams::Both)?;
        let cloth = vertices(predictor.positions()).into_iter().map(|vertex| into.transform_point3(vertex));
        let signed = body.signed(pose, &cloth.collect::<Vec<DVec3>>());
        let inside = signed.iter().filter(|distance| **distance < 0.0);
        let share = inside.clone().count() as f64 / signed.len() as f64;
        *found = (share, inside.fold(0.0_f64, |most, at| most.max(-at)));
    }
    Ok(found)
}

fn told(sums: [(f64, f64); 2], frames: usize) -> String {
    let one = |(sum, deepest): (f64, f64)| format!("{:.3} %, {:.1} mm", 100.0 * sum / frames as f64, 1e3 * deepest);
    sums.map(one).join(" -> ")
}
