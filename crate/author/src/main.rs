//! The command line: rigged character + garment + motion in, model file out.

mod commands;

use clap::{Parser, Subcommand};
use commands::{bake, bench, character, evaluate, garment, inspect, motion, predict, render, simulate, train};

/// Learned cloth for any skinned character.
///
/// From a rigged glTF to cloth on a web page:
///
///   ctsn bake character.glb -o model.safetensors      simulate, train and evaluate, in one go
///   ctsn inspect model.safetensors                    what is in the file
///
/// The same by steps, each resumable:
///
///   ctsn motion character.glb -o moving.glb           clips, if it has none
///   ctsn garment character.glb -o garment.glb         a garment, if you have none
///   ctsn simulate character.glb garment.glb -o data   quasi-static truth for every frame of the clips
///   ctsn train data -o model.safetensors              the network, from the first 90 % of every clip
///   ctsn evaluate model.safetensors data              errors on the rest
///   ctsn render model.safetensors character.glb --clip NAME --frame N -o picture.png
#[derive(Parser)]
#[command(name = "ctsn", version, verbatim_doc_comment)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Bake(bake::Arguments),
    Character(character::Arguments),
    Motion(motion::Arguments),
    Garment(garment::Arguments),
    Simulate(simulate::Arguments),
    Train(train::Arguments),
    Evaluate(evaluate::Arguments),
    Render(render::Arguments),
    Inspect(inspect::Arguments),
    Predict(predict::Arguments),
    Bench(bench::Arguments),
}

fn main() -> std::process::ExitCode {
    let result = match Cli::parse().command {
        Command::Character(arguments) => character::run(&arguments),
        Command::Motion(arguments) => motion::run(&arguments),
        Command::Garment(arguments) => garment::run(&arguments),
        Command::Render(arguments) => render::run(&arguments),
        Command::Inspect(arguments) => inspect::run(&arguments),
        Command::Predict(arguments) => predict::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Train(arguments) => train::run(&arguments),
        Command::Evaluate(arguments) => evaluate::run(&arguments),
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
