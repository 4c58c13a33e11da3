//! `skiagraph completions`: prints a script that completes commands and options in a shell.

use crate::args::{cli::Cli, commands::CompletionsArgs};
use crate::error::CliError;
use crate::terminal::console::print;
use clap::CommandFactory;

/// Prints the completion script for the shell of the arguments.
///
/// # Errors
/// If standard output cannot be written.
pub fn completions(args: &CompletionsArgs) -> Result<(), CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "skiagraph", &mut script);
    print(&String::from_utf8_lossy(&script))
}
