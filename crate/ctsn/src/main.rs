//! The command line: rigged character + garment + motion in, model file out.

#![forbid(unsafe_code)]

mod commands;
mod onnx;
mod packing;
mod pages;
mod pictures;

use clap::{Parser, Subcommand};
use commands::{
    bake, bench, character, evaluate, export, garment, inspect, motion, pack, polish, predict, render, sheet, simulate,
    split, study, train,
};

/// Learned cloth for any skinned character.
///
/// From a rigged glTF to cloth on a web page:
///
///   ctsn bake character.glb -o model.safetensors      simulate, train and evaluate, in one go
///   ctsn inspect model.safetensors                    what is in the file
///
/// The same by steps, each resumable:
///
///   ctsn split character.glb -o parts                 clothes of a character's own, apart from it
///   ctsn motion character.glb -o moving.glb           clips, if it has none
///   ctsn garment character.glb -o garment.glb         a garment, if you have none
///   ctsn simulate character.glb garment.glb -o data   quasi-static truth for every frame of the clips
///   ctsn sheet data character.glb -o sheet.png        twelve of the poses, to judge by eye
///   ctsn train data -o model.safetensors              the network, from all clips but the last tenth
///   ctsn evaluate model.safetensors data              errors on the rest
///   ctsn study data -o study                          plain skinning, older methods, ablations and sizes beside it
///   ctsn render model.safetensors character.glb --clip NAME --frame N -o picture.png
///   ctsn polish model.safetensors data -o model.safetensors    its folds, crisper or calmer
///   ctsn pack model.safetensors character.glb -o small.safetensors   the same to download, a third of the bytes
///   ctsn export model.safetensors -o model.onnx       the network for Unity, Unreal and other runtimes
#[derive(Parser)]
#[command(name = "ctsn", version, verbatim_doc_comment)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Bake(Box<bake::Arguments>),
    Character(character::Arguments),
    Split(split::Arguments),
    Motion(motion::Arguments),
    Garment(garment::Arguments),
    Simulate(simulate::Arguments),
    Train(train::Arguments),
    Evaluate(evaluate::Arguments),
    Study(study::Arguments),
    Render(render::Arguments),
    Sheet(sheet::Arguments),
    Inspect(inspect::Arguments),
    Polish(polish::Arguments),
    Pack(pack::Arguments),
    Predict(predict::Arguments),
    Export(export::Arguments),
    Bench(bench::Arguments),
}

/// Exit code of a program that the signal SIGPIPE ends.
const BROKEN_PIPE: i32 = 128 + 13;

/// Ends quietly where the reader of the output has gone, as in `ctsn … | head`: `println!` can only panic then.
fn end_with_the_reader() {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if panic
            .payload_as_str()
            .is_some_and(|text| text.starts_with("failed printing to std") && text.contains("pipe"))
        {
            std::process::exit(BROKEN_PIPE);
        }
        report(panic);
    }));
}

fn main() -> std::process::ExitCode {
    end_with_the_reader();
    let result = match Cli::parse().command {
        Command::Character(arguments) => character::run(&arguments),
        Command::Split(arguments) => split::run(&arguments),
        Command::Motion(arguments) => motion::run(&arguments),
        Command::Garment(arguments) => garment::run(&arguments),
        Command::Render(arguments) => render::run(&arguments),
        Command::Sheet(arguments) => sheet::run(&arguments),
        Command::Inspect(arguments) => inspect::run(&arguments),
        Command::Polish(arguments) => polish::run(&arguments),
        Command::Pack(arguments) => pack::run(&arguments),
        Command::Predict(arguments) => predict::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Train(arguments) => train::run(&arguments),
        Command::Evaluate(arguments) => evaluate::run(&arguments),
        Command::Study(arguments) => study::run(&arguments),
        Command::Bake(arguments) => bake::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
    };
    match result {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            std::process::ExitCode::FAILURE
        }
    }
}
