//! Writes the run of each cell into a file of its own, so that machines need no lock and lose
//! nothing of each other.

use crate::comparison::Comparison;
use crate::error::CompareError;
use crate::files::json::to_text;
use crate::files::write::{write_new, write_whole};
use crate::measuring::truth_folder::TruthFolder;
use crate::pictures::run_pictures::{PictureFile, write_pictures};
use crate::records::cell_files::{self, disagreement};
use crate::records::results::{Results, Run};
use crate::sink::Sink;
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

/// A folder of cells, with their pictures and the truths that they wait for.
pub struct CellFolder {
    folder: PathBuf,
    /// The reference's answers.
    pub truths: TruthFolder,
    /// Ids of the cells whose files hold what this process knows of them.
    written: BTreeSet<String>,
    /// Ids of the cells whose files are replaced: they are of other shaders, or cannot be read.
    stale: BTreeSet<String>,
}

impl CellFolder {
    /// Opens the folder of a comparison's cells, and makes it if it is missing.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn open(folder: &Path, comparison: &Comparison) -> Result<Self, CompareError> {
        let cells = folder.join(cell_files::FOLDER);
        fs::create_dir_all(&cells).map_err(|error| CompareError::write(&cells, error))?;
        let truths = TruthFolder::new(folder, comparison);
        truths.make()?;
        Ok(Self {
            folder: folder.to_path_buf(),
            truths,
            written: BTreeSet::new(),
            stale: BTreeSet::new(),
        })
    }

    /// Returns the run of a planned cell that is in the folder, measured by whichever machine;
    /// `None` if it must be measured. Tells the sink about a file that cannot be read.
    ///
    /// # Errors
    /// A cell that another version of the program has measured.
    pub fn earlier(&mut self, planned: &Run, sink: &dyn Sink) -> Result<Option<Run>, CompareError> {
        let path = cell_files::path(&self.folder, &planned.cell);
        let run = match cell_files::read(&path) {
            Ok(None) => return Ok(None),
            Ok(Some(results)) => {
                cell_files::check_version(&path, &results, planned.commit.as_deref())?;
                let run = results.runs.into_iter().next();
                run.filter(|run| {
                    (&run.fingerprint, &run.params) == (&planned.fingerprint, &planned.params)
                })
            }
            Err(error) => {
                sink.note(&format!("{error}\n  it is measured anew"));
                None
            }
        };
        // One that could not run elsewhere may run here.
        let is_measured = run.as_ref().is_some_and(|run| run.measured.is_some());
        let ids = if is_measured {
            &mut self.written
        } else {
            &mut self.stale
        };
        ids.insert(planned.cell.clone());
        Ok(run)
    }

    /// Writes the pictures of the last run, and each finished run that is not in the folder yet.
    ///
    /// # Errors
    /// A file that cannot be written; a cell that another machine has measured meanwhile with other
    /// errors.
    pub fn save(&mut self, own: &Results, pictures: &[PictureFile]) -> Result<(), CompareError> {
        write_pictures(&self.folder, pictures)?;
        let finished = own.runs.iter().filter(|run| run.is_whole());
        for run in finished {
            if self.written.contains(&run.cell) {
                continue;
            }
            let one = Results {
                runs: vec![run.clone()],
                ..own.clone()
            };
            self.write(run, &one)?;
            self.written.insert(run.cell.clone());
        }
        Ok(())
    }

    fn write(&self, run: &Run, one: &Results) -> Result<(), CompareError> {
        let path = cell_files::path(&self.folder, &run.cell);
        let text = to_text(one);
        if self.stale.contains(&run.cell) {
            return write_whole(&path, text.as_bytes());
        }
        if write_new(&path, text.as_bytes())? {
            return Ok(());
        }
        // The same cell was measured elsewhere meanwhile: the first one stays.
        let Some(kept) = cell_files::read(&path)? else {
            return write_whole(&path, text.as_bytes());
        };
        let other = kept.runs.first().filter(|_| kept.adapter == one.adapter);
        match other.and_then(|other| disagreement(run, other)) {
            None => Ok(()),
            Some(why) => Err(cell_files::at_odds(run, [&path, Path::new("here")], &why)),
        }
    }
}
