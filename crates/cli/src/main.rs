//! `skiagraph`: runs, times and judges shadow methods that are written as RON graphs and WGSL shaders.
//!
//! The program is the first user of the graph's embedding interface and has no rights of its own: whatever it does, a
//! host program can do as well.

mod args;
mod check_json;
mod commands;
mod contract;
mod csv_table;
mod date;
mod error;
mod fault;
mod files;
mod fingerprint;
mod interrupt;
mod items;
mod markdown;
mod measure;
mod parse;
mod picture;
mod preset;
mod profile;
mod progress;
mod published;
mod reference;
mod render;
mod results;
mod resume;
mod stage;
mod table;

use args::{Cli, Command};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let gpu = &cli.gpu;
    let outcome = match &cli.command {
        Command::Compare(args) => commands::compare::compare(args, gpu),
        Command::Run(args) => commands::run::run(args, gpu),
        Command::Profile(args) => commands::profile::profile(args, gpu),
        Command::Stress(args) => commands::stress::stress(args, gpu),
        Command::Check(args) => commands::check::check(args),
        Command::Graph(args) => commands::graph::graph(args),
        Command::Presets(args) => commands::presets::presets(args),
        Command::Scenes => commands::scenes::scenes(),
        Command::Doctor => commands::doctor::doctor(gpu),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => error.report(),
    }
}
