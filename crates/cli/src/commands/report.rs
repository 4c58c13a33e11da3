//! `skiagraph report`: shows kept results of `compare` and `stress` on one page.

use crate::args::commands::ReportArgs;
use crate::error::CliError;
use crate::terminal::Terminal;
use crate::terminal::console::note;
use skiagraph_compare::files::write::check_writable;
use skiagraph_report::page::{self, FILE};

/// Reads results of `compare` and `stress`, and writes the HTML page.
///
/// # Errors
/// If a folder has no results, results cannot be read, or the file cannot be written.
pub fn report(args: &ReportArgs) -> Result<(), CliError> {
    let first = args.folders.first().map(|folder| folder.join(FILE));
    let file = args.out.clone().or(first).unwrap_or_else(|| FILE.into());
    check_writable(&[("--out".to_owned(), &file)])?;
    page::write(&args.folders, &file, &Terminal)?;
    let file = file.display();
    note(&format!("{file} shows it all; open it in a browser"));
    Ok(())
}
