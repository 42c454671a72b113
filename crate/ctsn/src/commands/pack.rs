//! `ctsn pack`: a model or a character as a small file.

use super::{bar, file_name};
use crate::packing::{self, BOUND, Difference, Packed, Small, Trial};
use anyhow::{Context, Result, ensure};
use ctsn_core::file::Tensors;
use ctsn_core::model::{HostModel, file_bytes};
use ctsn_rig::{file, gltf};
use ctsn_train::dataset::Dataset;
use std::path::PathBuf;

/// Poses that each tensor is tried in, and those, others, that the whole is judged by.
const TRIED: usize = 48;
const JUDGED: usize = 200;
/// Poses a second that are taken from the clips.
const RATE: f64 = 5.0;

/// Make a file small to download: a model's or a character's, to about a third of the bytes
///
/// Learned tensors become whole numbers of one or two bytes with a scale per row, as coarse as the cloth bears: the
/// mean vertex moves by at most 0.1 mm and its normal by 0.1° over the character's clips, polish and repair included.
/// What comes out is packed by gzip. Every command and every page reads it as the model that it was made of.
///
/// A character (`ctsn pack character.glb -o small.glb`) is coded by meshoptimizer: three.js reads it once GLTFLoader
/// has its MeshoptDecoder.
///
/// The frames of a dataset (`ctsn pack data/andy-tshirt -o andy-tshirt.truth`) become one file in steps of 0.1 mm, for
/// a page to show what was simulated beside what is predicted.
#[derive(clap::Args)]
pub struct Arguments {
    /// Model file (safetensors), a character (GLB), or the folder of a dataset
    file: PathBuf,
    /// The character that a model was trained on (glTF): its clips are the poses that are compared
    character: Option<PathBuf>,
    /// Where to write the small file
    #[arg(short, long)]
    output: PathBuf,
    /// Print bytes and error by tensor
    #[arg(long)]
    report: bool,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let alone = |what: &str| {
        let wanted = "wanted no second file and no --report, which are for models";
        ensure!(arguments.character.is_none() && !arguments.report, "{}: {what}; {wanted}", arguments.file.display());
        Ok(())
    };
    if arguments.file.is_dir() {
        alone("is a dataset")?;
        return frames(arguments);
    }
    let before = file::read(&arguments.file)?;
    if before.starts_with(b"glTF") {
        alone("is a character")?;
        return character(arguments, before.len());
    }
    let context = || arguments.file.display().to_string();
    let wanted =
        "a model is packed to an error that is measured: name its character, too, as in ctsn pack MODEL CHARACTER";
    let path = arguments.character.as_ref().context(wanted)?;
    let tensors = Tensors::parse(&before).with_context(context)?.into_owned();
    let model = HostModel::read(&tensors).with_context(context)?;
    let character = gltf::read_character(path, RATE)?;
    let (trial, judge) = (Trial::new(model.clone(), &character, TRIED)?, Trial::new(model, &character, JUDGED)?);
    let bar = bar(0, "pack");
    let Small { file: small, list, difference } =
        packing::pack(&tensors, [&trial, &judge], |name| bar.set_message(name.to_owned()))?;
    bar.finish_and_clear();
    if arguments.report {
        report(&tensors, &small, &list);
    }
    let Difference { distance, angle, greatest } = difference;
    let said = format!(
        "over {} poses: {:.4} mm and {angle:.4}° in the mean, at most {:.2} mm; wanted {:.1} mm and {:.1}°",
        judge.poses(),
        1e3 * distance,
        1e3 * greatest,
        1e3 * BOUND.0,
        BOUND.1
    );
    ensure!(difference.within(1.0), "{}: cannot be packed: {said}", arguments.file.display());
    let plain = file_bytes(small);
    let packed = file::gzip(&plain);
    file::write(&arguments.output, &packed)?;
    println!(
        "{}: {} bytes, {} unpacked; before {}",
        file_name(&arguments.output),
        packed.len(),
        plain.len(),
        before.len()
    );
    println!("{said}");
    Ok(())
}

/// Packs the frames of a dataset.
fn frames(Arguments { file: path, output, .. }: &Arguments) -> Result<()> {
    let data = Dataset::read(path)?;
    let packed = file::gzip(&serde_json::to_vec(&packing::truth(&data)?)?);
    file::write(output, &packed)?;
    println!("{}: {} frames, {} bytes", file_name(output), data.samples.len(), packed.len());
    Ok(())
}

/// Packs a character, and says how far its joints are from where they were, over its clips.
fn character(Arguments { file: path, output, .. }: &Arguments, before: usize) -> Result<()> {
    gltf::pack(path, output)?;
    let [was, is] = [path, output].map(|path| gltf::read_character(path, RATE));
    let (was, is) = (was?, is?);
    let poses = was.clips.iter().zip(&is.clips).flat_map(|(was, is)| was.poses.iter().zip(&is.poses));
    let joints = poses.flat_map(|(was, is)| was.iter().zip(is));
    let far = joints.map(|(was, is)| was.translation.distance(is.translation)).fold(0.0, f64::max);
    let bytes = file::read(output)?.len();
    println!(
        "{}: {bytes} bytes, before {before}; joints at most {:.2} mm from where they were",
        file_name(output),
        1e3 * far
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
