//! `ctsn render`: a picture of a dressed character, for people to judge.

use super::{model, ordered};
use crate::pictures;
use anyhow::{Context, Result};
use ctsn_core::cpu::Level;
use ctsn_core::{Predictor, Streams};
use ctsn_rig::gltf;
use ctsn_rig::path::body_frame;
use ctsn_rig::{joints, vertices};
use ctsn_train::dataset::{Sample, Setup, pose_path};
use ctsn_train::judging::check_same;
use std::path::PathBuf;

/// Draw front, side and back of a character in a model's predicted cloth
#[derive(clap::Args)]
pub struct Arguments {
    /// Model file (safetensors)
    model: PathBuf,
    /// The character it was trained on (glTF)
    character: PathBuf,
    /// Clip, by name
    #[arg(long)]
    clip: String,
    /// Frame of the clip, counted at --rate (with --truth, at the rate of the dataset)
    #[arg(long)]
    frame: usize,
    /// Frames per second; with --truth, the dataset's
    #[arg(long, default_value_t = 10.0, conflicts_with = "truth")]
    rate: f64,
    /// Draw the simulated truth of this dataset folder instead of the prediction
    #[arg(long)]
    truth: Option<PathBuf>,
    /// Draw plain skinning instead of the prediction
    #[arg(long, conflicts_with = "truth")]
    skinning: bool,
    /// Where to write the picture (PNG)
    #[arg(short, long)]
    output: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let model = model(&arguments.model)?;
    let dataset = arguments.truth.as_deref().map(Setup::existing).transpose()?;
    if let Some(setup) = &dataset {
        check_same(&model, setup)?;
    }
    let rate = dataset.as_ref().map_or(arguments.rate, |setup| setup.description.rate);
    let character = gltf::read_character(&arguments.character, rate)?;
    let clip = character.clip(&arguments.clip)?;
    let pose = clip.poses.get(arguments.frame).with_context(|| {
        format!(
            "clip {}: no frame {}, it has {} at {} a second",
            clip.name,
            arguments.frame,
            clip.poses.len(),
            clip.rate
        )
    })?;
    let cloth = match arguments.truth.as_ref().zip(dataset) {
        Some((folder, setup)) => {
            let description = &setup.description;
            let index = description.clips.iter().position(|name| *name == clip.name);
            let index = index.with_context(|| {
                format!("{}: no clip {}; it has: {}", folder.display(), clip.name, description.clips.join(", "))
            })?;
            let path = pose_path(folder, index, arguments.frame);
            let sample = Sample::read(&path, model.sizes.joints, model.sizes.vertices)?;
            let back = body_frame(&character, pose).inverse();
            vertices(&setup.shown(&sample.truth)).into_iter().map(|vertex| back.transform_point3(vertex)).collect()
        }
        None => {
            let streams = if arguments.skinning { Streams::None } else { Streams::Both };
            let pose = ordered(&model.rig.joints, &character, pose)?;
            let mut predictor = Predictor::from_model(model.clone(), Level::new());
            predictor.predict_row_major(&joints(&pose), streams)?;
            vertices(predictor.shown_positions())
        }
    };
    let triangles = model.ride.as_ref().map_or(&model.triangles, |ride| &ride.triangles).as_chunks::<3>().0;
    pictures::render_dressed(&character, pose, Some((&cloth, triangles)), &arguments.output)?;
    println!("{}", arguments.output.display());
    Ok(())
}
