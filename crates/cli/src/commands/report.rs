//! `skiagraph report`: what `compare` and `stress` kept, as one page.

use crate::args::commands::ReportArgs;
use crate::error::CliError;
use crate::files::lock::{self, Shared};
use crate::files::write::{check_writable, write_whole};
use crate::records::read_back;
use crate::reporting::charts::Kept;
use crate::reporting::html::{page, sources};
use crate::terminal::console::note;
use std::path::{Path, PathBuf};

/// The name of the page in a folder of results.
const FILE: &str = "report.html";

/// Reads what was kept and writes the page.
///
/// # Errors
/// A folder without results, results that cannot be read, a file that cannot be written.
pub fn report(args: &ReportArgs) -> Result<(), CliError> {
    let first = args.folders.first().map(|folder| folder.join(FILE));
    let file = args.out.clone().or(first).unwrap_or_else(|| FILE.into());
    check_writable(&[("--out".to_owned(), &file)])?;
    write(&args.folders, &file)?;
    note(&format!(
        "{} shows it all; open it in a browser",
        file.display()
    ));
    Ok(())
}

/// Writes the page of one folder into it, and says what had no room in it.
///
/// # Errors
/// Those of [`report`].
pub fn write_beside(folder: &Path) -> Result<(), CliError> {
    write(&[folder.to_path_buf()], &folder.join(FILE))
}

/// A page that stands among results is written while no other process writes these: it is never
/// older than they are.
fn write(folders: &[PathBuf], file: &Path) -> Result<(), CliError> {
    let beside = file.parent();
    let beside = folders
        .iter()
        .find(|folder| beside == Some(folder.as_path()));
    let _locked = match beside.filter(|folder| folder.is_dir()) {
        Some(folder) => Some(lock::wait_for(folder, Shared::Results)?),
        None => None,
    };
    let (mut kept, mut matrices) = (Vec::new(), Vec::new());
    for folder in folders {
        let matrix = read_back::stress(folder)?;
        // A folder may be of `stress` alone.
        if matrix.is_none() || folder.join("results.json").exists() {
            let results = read_back::kept(folder)?;
            let folder = folder.clone();
            kept.push(Kept { folder, results });
        }
        matrices.extend(matrix);
    }
    let page = page(&sources(kept), &matrices);
    for line in &page.left_out {
        note(line);
    }
    write_whole(file, page.html.as_bytes())
}
