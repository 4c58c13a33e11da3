//! The cells of a folder of results: the folder `cells` has a file for each run, which is a
//! `results.json` with that run alone. Several processes may write them at once; `results.json`,
//! `results.csv` and the page beside them are made of them.
//!
//! ```
//! use skiagraph_compare::records::{cells::Cells, read_back};
//!
//! # let out = tempfile::tempdir()?;
//! # let name = "skiagraph_compare__records__results__tests__the_schema_is_pinned_and_reads_back";
//! # let pinned = std::fs::read_to_string(format!("src/records/snapshots/{name}.snap"))?;
//! # std::fs::write(out.path().join("results.json"), &pinned[pinned.find('{').unwrap_or(0)..])?;
//! let results = read_back::kept(out.path())?;
//! let mut cells = Cells::open(out.path(), None, Some(results.clone()))?;
//! assert_eq!(std::fs::read_dir(out.path().join("cells"))?.count(), 3);
//! assert_eq!(cells.in_order()[2].runs, results.runs[2..]);
//! assert_eq!(cells.refresh(), [""; 0], "no other process has changed one");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::files::json::to_text;
use crate::files::write::{write_durable, write_new};
use crate::records::cell_files::{FOLDER, read};
use crate::records::results::{Results, Run};
use itertools::Itertools;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// When a file was written last, and its length; `None` if there is none.
type Stamp = Option<(SystemTime, u64)>;

/// A cell as this process knows it.
#[derive(Debug)]
pub struct Cell {
    stamp: Stamp,
    /// Results with one run; `None` if the file cannot be read.
    results: Option<Results>,
    /// True if another process has written it since this one opened the folder.
    pub is_foreign: bool,
}

/// The cells of a folder, as this process knows them.
#[derive(Debug, Default)]
pub struct Cells {
    place: PathBuf,
    /// The cells by the names of their files.
    pub files: BTreeMap<String, Cell>,
    only: Option<BTreeSet<String>>,
    /// Places in `results.json` by ids.
    order: BTreeMap<String, usize>,
    /// Why files cannot be read.
    pub torn: Vec<CompareError>,
}

impl Cells {
    /// Reads the cells of a folder, or of the files `only` those that are there. A folder without
    /// any gets those of `earlier`, its `results.json`, whose order they keep.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn open(
        folder: &Path,
        only: Option<BTreeSet<String>>,
        earlier: Option<Results>,
    ) -> Result<Self> {
        let mut cells = Self {
            place: folder.join(FOLDER),
            only,
            ..Self::default()
        };
        cells.refresh();
        if let Some(earlier) = earlier {
            let runs = earlier.clone().each_run().enumerate();
            let order = runs.map(|(place, one)| (one.runs[0].cell.clone(), place));
            cells.order = order.collect();
            if cells.files.is_empty() {
                cells.split(folder, earlier)?;
            }
        }
        let made = fs::create_dir_all(&cells.place);
        made.map_err(|error| CompareError::write(&cells.place, error))?;
        for cell in cells.files.values_mut() {
            cell.is_foreign = false;
        }
        Ok(cells)
    }

    /// Gives the runs of results their files, all at once.
    fn split(&mut self, folder: &Path, results: Results) -> Result<()> {
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
        let beside = builder.prefix(".skiagraph-").tempdir_in(folder);
        let failed = |error| CompareError::write(&self.place, error);
        let beside = beside.map_err(failed)?;
        let mut parts = Self {
            place: beside.path().to_path_buf(),
            ..Self::default()
        };
        parts.set(results)?;
        let _ = fs::remove_dir(&self.place);
        // Another process may have done it.
        fs::rename(beside.path(), &self.place)
            .or_else(|error| self.place.is_dir().then_some(()).ok_or(error))
            .map_err(failed)?;
        self.refresh();
        Ok(())
    }

    /// Returns the path of a file.
    pub fn path(&self, name: &str) -> PathBuf {
        self.place.join(name)
    }

    /// Returns what a file holds: results with one run.
    pub fn get(&self, name: &str) -> Option<&Results> {
        self.files.get(name)?.results.as_ref()
    }

    /// Takes over what other processes have written and removed since the last time, and returns
    /// the names of the files that have changed.
    pub fn refresh(&mut self) -> Vec<String> {
        let entries = fs::read_dir(&self.place).into_iter().flatten().flatten();
        let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
        let only = self.only.as_ref();
        let is_cell =
            |name: &String| name.ends_with(".json") && only.is_none_or(|only| only.contains(name));
        let names = names.filter(is_cell).chain(self.files.keys().cloned());
        let mut changed: Vec<String> = names.sorted().dedup().collect();
        changed.retain(|name| {
            let path = self.place.join(name);
            let stamp = stamp(&path);
            if self.files.get(name).is_some_and(|cell| cell.stamp == stamp) {
                return false;
            }
            let results = read(&path).unwrap_or_else(|why| {
                self.torn.push(why);
                None
            });
            let cell = Cell {
                stamp,
                results,
                is_foreign: true,
            };
            if stamp.is_some() {
                self.files.insert(name.clone(), cell);
            } else {
                self.files.remove(name);
            }
            true
        });
        changed
    }

    /// Returns the name of a run's file: that in which it is, or would be.
    pub fn name_of(&self, run: &Run) -> String {
        name_that(run, |name| {
            let there = self.get(name);
            there.is_none_or(|there| there.runs[0].is_in_place_of(run))
        })
    }

    /// Writes a file. Returns false if another process has meanwhile written one of that name,
    /// where there was none.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&mut self, name: &str, one: Results) -> Result<bool> {
        let (path, text) = (self.path(name), to_text(&one));
        if self.files.contains_key(name) {
            write_durable(&path, text.as_bytes())?;
        } else if !write_new(&path, text.as_bytes())? {
            return Ok(false);
        }
        let cell = Cell {
            stamp: stamp(&path),
            results: Some(one),
            is_foreign: false,
        };
        self.files.insert(name.to_owned(), cell);
        Ok(true)
    }

    /// Removes a file, unless another process has changed it meanwhile.
    ///
    /// # Errors
    /// The file cannot be removed.
    pub fn remove(&mut self, name: &str) -> Result<()> {
        let path = self.path(name);
        let last = self.files.remove(name).and_then(|cell| cell.stamp);
        if last.is_some()
            && last == stamp(&path)
            && let Err(error) = fs::remove_file(&path)
            && path.exists()
        {
            return Err(CompareError::write(&path, error));
        }
        Ok(())
    }

    /// Makes the cells those of joined results.
    ///
    /// # Errors
    /// A file that cannot be written or removed.
    pub fn set(&mut self, joined: Results) -> Result<()> {
        let mut wanted: BTreeMap<String, Results> = BTreeMap::new();
        for one in joined.each_run() {
            let name = name_that(&one.runs[0], |name| !wanted.contains_key(name));
            wanted.insert(name, one);
        }
        let names: Vec<String> = self.files.keys().cloned().collect();
        for name in names.iter().filter(|name| !wanted.contains_key(*name)) {
            self.remove(name)?;
        }
        for (name, one) in wanted {
            if self.get(&name).is_none_or(|there| there.runs != one.runs) {
                self.write(&name, one)?;
            }
        }
        Ok(())
    }

    /// Returns all cells, each as results with one run: in the order of `results.json`, and behind
    /// those that are not in it, the oldest first.
    pub fn in_order(&self) -> Vec<&Results> {
        let cells = self.files.values();
        let cells = cells.filter_map(|cell| Some((cell.results.as_ref()?, cell.stamp)));
        let place = |one: &Results| self.order.get(&one.runs[0].cell).copied();
        let cells = cells.sorted_by_key(|(one, stamp)| place(one).ok_or(*stamp));
        cells.map(|(one, _)| one).collect()
    }
}

/// The first name of a run's cell that will do: settings of two labels, and runs on several
/// adapters, may be one cell.
fn name_that(run: &Run, will_do: impl Fn(&str) -> bool) -> String {
    let further = (2..).map(|number| format!("{}_{number}.json", run.cell));
    let mut names = [format!("{}.json", run.cell)].into_iter().chain(further);
    names.find(|name| will_do(name)).unwrap_or_default()
}

fn stamp(path: &Path) -> Stamp {
    let metadata = fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}
