//! `skiagraph`: runs, times and judges shadow methods that are written as RON graphs and WGSL
//! shaders.
//!
//! The program uses the graph's embedding interface as any host does: a host program can do
//! whatever it does.

mod args;
mod commands;
mod error;
mod scene_selection;
mod terminal;

use args::cli::{Cli, Command};
use clap::{Parser, error::ErrorKind};
use error::CliError;
use skiagraph_gpu::block_on;
use std::process::ExitCode;

/// Without a session, in a container say, Mesa's loader asks for this folder and complains above
/// all that we have to say. The environment of a process is only safe to change before it begins:
/// so it begins anew.
#[cfg(unix)]
fn with_runtime_dir() {
    use std::os::unix::process::CommandExt;
    const FOLDER: &str = "XDG_RUNTIME_DIR";
    if std::env::var_os(FOLDER).is_some() {
        return;
    }
    if let Ok(program) = std::env::current_exe() {
        let mut again = std::process::Command::new(program);
        again.args(std::env::args_os().skip(1));
        // Only comes back if it cannot be done, and then things are as they were.
        let _ = again.env(FOLDER, std::env::temp_dir()).exec();
    }
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Err(error) if error.kind() == ErrorKind::InvalidUtf8 => {
            let argument = std::env::args_os().find(|argument| argument.to_str().is_none());
            return terminal::console::report(&CliError::Usage(format!(
                "the argument {:?} is not UTF-8, as scenes, methods and names are: rename the \
                 file, or link it under another name",
                argument.unwrap_or_default()
            )));
        }
        parsed => parsed.unwrap_or_else(|error| error.exit()),
    };
    #[cfg(unix)]
    with_runtime_dir();
    // Measuring waits for the GPU here alone.
    let outcome = block_on(run(&cli));
    // Where the process ends in the middle of work, that is what is told.
    terminal::stop::take_end();
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => terminal::console::report(&error),
    }
}

/// Runs the command that was typed.
async fn run(cli: &Cli) -> Result<(), CliError> {
    let gpu = &cli.gpu;
    match &cli.command {
        Command::Compare(args) if args.plan.is_some() => commands::cells::plan(args, gpu).await,
        Command::Compare(args) if args.cells.is_some() => commands::cells::measure(args, gpu).await,
        Command::Compare(args) => commands::compare::compare(args, gpu).await,
        Command::Run(args) => commands::run::run(args, gpu).await,
        Command::Chart(args) => commands::chart::chart(args),
        Command::Report(args) => commands::report::report(args),
        Command::Merge(args) => commands::merge::merge(args),
        Command::Completions(args) => commands::completions::completions(args),
        Command::Profile(args) => commands::profile::profile(args, gpu).await,
        Command::Stress(args) => commands::stress::stress(args, gpu).await,
        Command::Judge(args) => commands::judge::judge(args, gpu).await,
        Command::Truth(args) => commands::judge::truth(args, gpu).await,
        Command::Check(args) => commands::check::check(args, gpu),
        Command::Graph(args) => commands::graph::graph(args),
        Command::Presets(args) => commands::presets::presets(args),
        Command::New(args) => commands::new::new(args),
        Command::Show(args) => commands::show::show(args),
        Command::Schema(args) => commands::schema::schema(args),
        Command::Scenes => commands::scenes::scenes(),
        Command::Doctor(args) => commands::doctor::doctor(args, gpu),
        Command::View(args) => commands::view::view(args, gpu),
    }
}
