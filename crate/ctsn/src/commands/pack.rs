//! `ctsn pack`: a model as a small file.

use super::{bar, file_name};
use crate::packing::{self, BOUND, Difference, Packed, Trial};
use anyhow::{Context, Result};
use ctsn_core::file::Tensors;
use ctsn_core::model::{HostModel, file_bytes};
use ctsn_rig::{file, gltf};
use std::path::PathBuf;

/// Poses that each tensor is tried in, and those, others, that the whole is judged by.
const TRIED: usize = 48;
const JUDGED: usize = 200;
/// Poses a second that are taken from the clips.
const RATE: f64 = 5.0;

/// Make a model's file small to download: about a third of the bytes
///
/// Learned tensors become whole numbers of one or two bytes with a scale per row, as coarse as the cloth bears: the
/// mean vertex moves by at most 0.1 mm and its normal by 0.1° over the character's clips, polish and repair included.
/// What comes out is packed by gzip. Every command and every page reads it as the model that it was made of.
#[derive(clap::Args)]
pub struct Arguments {
    /// Model file (safetensors)
    model: PathBuf,
    /// The character it was trained on (glTF), whose clips are the poses that are compared
    character: PathBuf,
    /// Where to write the small file
    #[arg(short, long)]
    output: PathBuf,
    /// Print bytes and error by tensor
    #[arg(long)]
    report: bool,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let before = file::read(&arguments.model)?;
    let context = || arguments.model.display().to_string();
    let tensors = Tensors::parse(&before).with_context(context)?.into_owned();
    let model = HostModel::read(&tensors).with_context(context)?;
    let character = gltf::read_character(&arguments.character, RATE)?;
    let trial = Trial::new(model.clone(), &character, TRIED)?;
    let bar = bar(0, "pack");
    let (small, list) = packing::pack(&tensors, &trial, |name| bar.set_message(name.to_owned()))?;
    bar.finish_and_clear();
    let judge = Trial::new(model, &character, JUDGED)?;
    let difference = judge.difference(&small)?;
    if arguments.report {
        report(&tensors, &small, &list);
    }
    let plain = file_bytes(small);
    let packed = file::gzip(&plain);
    file::write(&arguments.output, &packed)?;
    let Difference { distance, angle, greatest } = difference;
    println!("{}: {} bytes, {} unpacked; before {}", file_name(&arguments.output), packed.len(), plain.len(), before.len());
    println!(
        "over {} poses: {:.4} mm and {angle:.4}° in the mean, at most {:.2} mm; wanted {:.1} mm and {:.1}°",
        judge.poses(),
        1e3 * distance,
        1e3 * greatest,
        1e3 * BOUND.0,
        BOUND.1
    );
    Ok(())
}

/// By tensor: bytes before, after, and after gzip; bits of a number; what it alone changes.
fn report(before: &Tensors, small: &Tensors, list: &[Packed]) {
    println!("{:<24} {:>9} {:>9} {:>9} {:>5} {:>10} {:>9}", "tensor", "bytes", "packed", "gzip", "bits", "mm", "°");
    for (name, tensor) in &before.tensors {
        let bytes = packing::bytes(small, name);
        print!("{name:<24} {:>9} {:>9} {:>9}", tensor.bytes.len(), bytes.len(), file::gzip(&bytes).len());
        match list.iter().find(|packed| packed.name == *name) {
            Some(Packed { levels, difference: Difference { distance, angle, .. }, .. }) => {
                let bits = f64::from(2 * levels + 1).log2();
                println!(" {bits:>5.1} {:>10.5} {angle:>9.5}", 1e3 * distance);
            }
            None => println!(),
        }
    }
}
