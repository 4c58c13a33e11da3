//! `skiagraph merge`: joins kept results of several folders and machines.

use crate::args::commands::MergeArgs;
use crate::error::CliError;
use crate::terminal::{Terminal, console::note};
use skiagraph_report::page;

/// Reads results of earlier commands, and writes them together into one folder.
///
/// # Errors
/// If there are no results, results cannot be read, or a file cannot be written.
pub fn merge(args: &MergeArgs) -> Result<(), CliError> {
    page::merge(&args.places, &args.out, &Terminal)?;
    let out = args.out.display();
    note(&format!("report.html and the joined results are in {out}"));
    Ok(())
}
