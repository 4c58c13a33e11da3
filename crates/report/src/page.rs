//! The page of folders of results, `report.html`, as a file.

use crate::charts::Kept;
use crate::html::{page, sources};
use skiagraph_compare::error::CompareError;
use skiagraph_compare::files::lock;
use skiagraph_compare::files::write::write_whole;
use skiagraph_compare::records::read_back;
use skiagraph_compare::sink::Sink;
use std::path::{Path, PathBuf};

/// The name of the page in a folder of results.
pub const FILE: &str = "report.html";

/// Writes the page of one folder into it, and tells the sink which pictures had no room in it.
///
/// # Errors
/// Those of [`write`](write()).
pub fn write_beside(folder: &Path, sink: &dyn Sink) -> Result<(), CompareError> {
    write(&[folder.to_path_buf()], &folder.join(FILE), sink)
}

/// Writes the page of some folders, and tells the sink which pictures had no room in it. A page
/// that stands among results is written while no other process writes these: it is never older
/// than they are.
///
/// # Errors
/// A folder without results, results that cannot be read, a file that cannot be written.
pub fn write(folders: &[PathBuf], file: &Path, sink: &dyn Sink) -> Result<(), CompareError> {
    let beside = file.parent();
    let beside = folders
        .iter()
        .find(|folder| beside == Some(folder.as_path()));
    let _locked = match beside.filter(|folder| folder.is_dir()) {
        Some(folder) => Some(lock::wait_for(folder, lock::RESULTS, sink)?),
        None => None,
    };
    let (mut kept, mut matrices) = (Vec::new(), Vec::new());
    for folder in folders {
        let matrix = read_back::stress(folder)?;
        // A folder may be of `stress` alone.
        if matrix.is_none() || folder.join("results.json").exists() {
            kept.push(Kept::read(folder)?);
        }
        matrices.extend(matrix);
    }
    let page = page(&sources(kept), &matrices);
    for line in &page.left_out {
        sink.note(line);
    }
    write_whole(file, page.html.as_bytes())
}
