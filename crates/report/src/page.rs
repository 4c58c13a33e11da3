//! Writes `report.html`, the page of results, to a file.

use crate::charts::Kept;
use crate::html::{page, sources};
use skiagraph_compare::error::CompareError;
use skiagraph_compare::files::lock;
use skiagraph_compare::files::write::write_whole;
use skiagraph_compare::records::read_back;
use skiagraph_compare::sink::Sink;
use std::path::{Path, PathBuf};

/// Name of the page's file in a folder of results.
pub const FILE: &str = "report.html";

/// Writes the page of one folder of results into that folder, as [`FILE`]. The sink gets a note
/// about pictures that did not fit into the page.
///
/// # Errors
/// The errors of [`write`](write()).
pub fn write_beside(folder: &Path, sink: &dyn Sink) -> Result<(), CompareError> {
    write(&[folder.to_path_buf()], &folder.join(FILE), sink)
}

/// Writes the page of several folders of results to `file`; a folder without results stands for the
/// folders of results in it. The sink gets a note about pictures
/// that did not fit into the page. If `file` lies in one of the folders, that folder's lock is
/// held, so the page is never older than the results beside it.
///
/// # Errors
/// If a folder has no results, results cannot be read, or the file cannot be written.
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
    for folder in &read_back::with_scenes(folders) {
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
