//! Combines folders that were measured under the same conditions into one source.

use crate::charts::Kept;
use skiagraph_compare::lists::unique;
use skiagraph_compare::records::results::{Results, Run};
use std::path::{Path, PathBuf};

/// Measurements of one scene on one adapter under the same conditions, from one or several folders.
pub struct Source {
    /// All runs of the source, with their conditions.
    pub results: Results,
    /// Folders that the runs come from.
    pub folders: Vec<PathBuf>,
    /// Index of each run's folder.
    places: Vec<usize>,
}

impl Source {
    /// Returns the folder with the pictures of the run with the index `run` in `results.runs`.
    pub fn folder_of(&self, run: usize) -> &Path {
        &self.folders[self.places[run]]
    }

    fn is_like(&self, other: &Results) -> bool {
        without_runs(&self.results) == without_runs(other)
    }

    fn add(&mut self, folder: PathBuf, results: Results) {
        let place = self.folders.len();
        self.folders.push(folder);
        self.results.commands.extend(results.commands);
        self.results.commands = unique(std::mem::take(&mut self.results.commands));
        for run in results.runs {
            let is_same = |known: &Run| known.is_in_place_of(&run) && known.params == run.params;
            match self.results.runs.iter().position(is_same) {
                // Days are written so that they sort.
                Some(at) if self.results.runs[at].date <= run.date => {
                    self.results.runs[at] = run;
                    self.places[at] = place;
                }
                Some(_) => {}
                None => {
                    self.results.runs.push(run);
                    self.places.push(place);
                }
            }
        }
    }
}

/// The conditions of results.
fn without_runs(results: &Results) -> Results {
    Results {
        runs: Vec::new(),
        commands: Vec::new(),
        ..results.clone()
    }
}

/// Combines the results of folders into sources, one for each adapter, scene and set of conditions,
/// in the order of the folders.
pub fn sources(kept: Vec<Kept>) -> Vec<Source> {
    let mut sources: Vec<Source> = Vec::new();
    for Kept { folder, results } in kept {
        let index = sources.iter().position(|source| source.is_like(&results));
        let index = index.unwrap_or_else(|| {
            sources.push(Source {
                results: without_runs(&results),
                folders: Vec::new(),
                places: Vec::new(),
            });
            sources.len() - 1
        });
        sources[index].add(folder, results);
    }
    sources
}
