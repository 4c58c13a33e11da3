//! Joins the results of several folders and machines. Results of one machine, adapter, scene and
//! protocol become one source; others stay apart, and so do methods that have the same label and
//! other params.
//!
//! ```
//! use skiagraph_compare::records::sources::{Kept, merged, sources};
//!
//! # let out = tempfile::tempdir()?;
//! # let name = "skiagraph_compare__records__results__tests__the_schema_is_pinned_and_reads_back";
//! # let pinned = std::fs::read_to_string(format!("src/records/snapshots/{name}.snap"))?;
//! # std::fs::write(out.path().join("results.json"), &pinned[pinned.find('{').unwrap_or(0)..])?;
//! let mut kept = Kept::read(out.path())?;
//! let mut far = Kept::read(out.path())?;
//! far[0].results.machine.host = Some("far".into());
//! kept.append(&mut far);
//! let sources = sources(kept);
//! assert_eq!(sources.len(), 2);
//! let results = merged(&sources, out.path()).ok_or("there are sources")?;
//! assert_eq!(results.others[0].machine.host.as_deref(), Some("far"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::Result;
use crate::lists::{find_or_push, place, unique};
use crate::records::read_back;
use crate::records::results::{Results, Run};
use std::path::{Path, PathBuf};

/// Results of `compare`, read back from the folder that it wrote.
#[derive(Clone, Debug)]
pub struct Kept {
    /// The folder that the results were read from, with their pictures.
    pub folder: PathBuf,
    /// Results from the folder's `results.json` of one machine, adapter, scene and protocol:
    /// `others` is empty.
    pub results: Results,
}

impl Kept {
    /// Reads the results of `place`: a folder with a results.json, or the path of that file.
    /// Returns one entry for each machine, adapter, scene and protocol in it.
    ///
    /// # Errors
    /// The errors of [`read_back::kept`].
    pub fn read(place: &Path) -> Result<Vec<Self>> {
        let results = read_back::kept(place)?;
        let own = place.is_dir().then_some(place);
        let folder = own.or(place.parent()).unwrap_or(Path::new(""));
        let each = results.each().into_iter().flat_map(by_machine);
        let each = each.map(|results| Self {
            folder: folder.to_path_buf(),
            results,
        });
        Ok(each.collect())
    }
}

/// Parts results by the machine of their runs: another machine may have gone on with a comparison.
fn by_machine(mut results: Results) -> Vec<Results> {
    let mut parts: Vec<Results> = Vec::new();
    for run in std::mem::take(&mut results.runs) {
        let machine = results.machine_of(&run).clone();
        let is_known = |part: &Results| part.joins(&part.machine, &machine);
        let part = find_or_push(&mut parts, is_known, || Results {
            // Load is that of the comparison, where it is the same machine.
            machine: if results.joins(&machine, &results.machine) {
                results.machine.clone()
            } else {
                machine.clone()
            },
            ..results.clone()
        });
        part.runs.push(run);
    }
    if parts.is_empty() {
        parts.push(results);
    }
    parts
}

/// Measurements of one scene on one machine and adapter under one protocol, in which each label of
/// a method is of one choice of params.
#[derive(Debug)]
pub struct Source {
    /// All runs of the source, with their conditions.
    pub results: Results,
    /// The folders of the joined results, in the order in which they were joined.
    pub folders: Vec<PathBuf>,
    /// Index of each run's folder.
    places: Vec<usize>,
    /// Number of runs that were left out because there is a newer one of the same method, params,
    /// view and viewport.
    pub replaced: usize,
}

impl Source {
    /// Returns the folder with the pictures of the run with the index `run` in `results.runs`.
    pub fn folder_of(&self, run: usize) -> &Path {
        &self.folders[self.places[run]]
    }

    fn new(results: &Results) -> Self {
        Self {
            results: Results {
                runs: Vec::new(),
                commands: Vec::new(),
                notes: Vec::new(),
                ..results.clone()
            },
            folders: Vec::new(),
            places: Vec::new(),
            replaced: 0,
        }
    }

    fn is_like(&self, other: &Results) -> bool {
        let conditions = |results: &Results| {
            let (adapter, scene) = (&results.adapter, results.scene.clone());
            let adapter = (adapter.to_string(), adapter.gpu_unavailable.is_some());
            let counts = (results.frames, results.warmup, results.regime_frames);
            let protocol = (results.oracle.clone(), counts);
            (results.program.clone(), adapter, scene, protocol)
        };
        let results = &self.results;
        let (machine, other_machine) = (&results.machine, &other.machine);
        let is_of_plan = results.plan == other.plan && results.joins(machine, other_machine);
        let joins = is_of_plan || machine.is_same(other_machine);
        joins && conditions(results) == conditions(other)
    }

    /// True if one of the runs has the label of a run of this source and is another cell, of other
    /// params for example. Under one label a table could not tell them apart.
    fn is_at_odds(&self, other: &Results) -> bool {
        let at_odds = |own: &Run, run: &Run| own.is_in_place_of(run) && !own.is_same_cell(run);
        let own_runs = &self.results.runs;
        let mut runs = other.runs.iter();
        runs.any(|run| own_runs.iter().any(|own| at_odds(own, run)))
    }

    /// Names all machines of the runs, where they are several of one kind.
    fn name_machines(&mut self) {
        let runs = self.results.runs.iter();
        let hosts = runs.filter_map(|run| run.machine.as_ref()?.host.clone());
        let hosts = unique(hosts);
        if self.results.plan.is_some() && hosts.len() > 1 {
            self.results.machine.host = Some(match hosts.len() - 1 {
                further @ 4.. => format!("{} and {further} others", hosts[0]),
                _ => hosts.join(", "),
            });
        }
    }

    fn add(&mut self, folder: PathBuf, other: Results) {
        let place = place(&mut self.folders, folder);
        let commands = [&self.results.commands[..], &other.commands].concat();
        let notes = [&self.results.notes[..], &other.notes].concat();
        let machine = other.machine.clone();
        let plan = self.results.plan.clone().or_else(|| other.plan.clone());
        if self.results.began < other.began {
            // Load, budgets and hour are those of the newest comparison.
            self.results = Results {
                runs: std::mem::take(&mut self.results.runs),
                ..other.clone()
            };
        }
        self.results.commands = unique(commands);
        self.results.notes = unique(notes);
        self.results.plan = plan;
        for mut run in other.runs {
            run.machine.get_or_insert_with(|| machine.clone());
            // Times are written so that they sort.
            let when = |run: &Run| (run.session.clone(), run.date.clone(), run.is_whole());
            let runs = &mut self.results.runs;
            match runs.iter().position(|own| own.is_same_cell(&run)) {
                Some(at) if runs[at] == run => {}
                Some(at) => {
                    self.replaced += 1;
                    if when(&runs[at]) <= when(&run) {
                        (runs[at], self.places[at]) = (run, place);
                    }
                }
                None => {
                    runs.push(run);
                    self.places.push(place);
                }
            }
        }
    }
}

/// Joins results into sources, one for each scene, machine, adapter and protocol, in the order of
/// `kept`. Of several runs of one method with the same params, view and viewport only the newest
/// stays in a source; results in which methods of the same labels have other params, of another
/// `--set` for example, are a source of their own.
pub fn sources(kept: Vec<Kept>) -> Vec<Source> {
    let mut sources: Vec<Source> = Vec::new();
    for Kept { folder, results } in kept {
        let fits = |source: &Source| source.is_like(&results) && !source.is_at_odds(&results);
        find_or_push(&mut sources, fits, || Source::new(&results)).add(folder, results);
    }
    sources.iter_mut().for_each(Source::name_machines);
    sources
}

/// Returns the content of one results.json with all sources, for the folder `out`: the first
/// source, with the others in [`Results::others`]; `None` without sources. Runs whose pictures are
/// in other folders list no pictures in it.
pub fn merged(sources: &[Source], out: &Path) -> Option<Results> {
    let mut each = sources.iter().map(|source| {
        let mut results = source.results.clone();
        for (index, run) in results.runs.iter_mut().enumerate() {
            if source.folder_of(index) != out
                && let Some(measured) = &mut run.measured
            {
                measured.images = None;
            }
        }
        results
    });
    let mut first = each.next()?;
    first.others = each.collect();
    Some(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::results::Machine;
    use crate::records::results::tests::sample;

    fn kept(folder: &str, results: Results) -> Kept {
        let folder = folder.into();
        Kept { folder, results }
    }

    /// The first run of `sample()`, measured in a later hour on a busier machine.
    fn later() -> Results {
        let mut later = sample();
        later.runs.truncate(1);
        later.runs[0].session = "2026-11-21T04:30:12Z".into();
        (later.began, later.machine.load) = (later.runs[0].session.clone(), Some(7.0));
        later.runs[0].machine = None;
        later.runs[0].band = 77;
        later.commands = vec!["later".into()];
        later
    }

    #[test]
    fn of_one_cell_on_one_machine_the_newer_run_counts_whatever_the_order() {
        for order in [[0, 1], [1, 0]] {
            let both = [("old", sample()), ("new", later())];
            let both = order.map(|index| both[index].clone());
            let kept = both.map(|(folder, results)| kept(folder, results));
            let [source] = &sources(kept.into())[..] else {
                panic!("one machine, scene and protocol")
            };
            let runs = &source.results.runs;
            assert_eq!((runs.len(), source.replaced), (3, 1));
            let newer = runs.iter().position(|run| run.band == 77).unwrap();
            assert_eq!(source.folder_of(newer), Path::new("new"));
            assert_eq!(source.results.began, later().began);
            assert_eq!(source.results.commands.len(), 2);
            assert_eq!(source.results.notes, sample().notes, "once");
            let load = |run: usize| source.results.machine_of(&runs[run]).load;
            assert_eq!(load(newer), Some(7.0), "that of its own comparison");
            assert_eq!((newer, load(1)), (0, Some(0.25)));
        }
    }

    #[test]
    fn runs_of_another_machine_in_one_file_are_a_source_of_their_own() {
        let folder = tempfile::tempdir().unwrap();
        let mut of_two = sample();
        of_two.runs[1].machine = Some(Machine {
            host: Some("far".into()),
            ..of_two.machine.clone()
        });
        crate::records::results_csv::save(&of_two, folder.path()).unwrap();
        let kept = Kept::read(folder.path()).unwrap();
        let runs = kept.iter().map(|kept| kept.results.runs.len());
        assert_eq!(runs.collect::<Vec<_>>(), [2, 1]);
        let joined = sources(kept);
        assert_eq!(joined[1].results.machine.host.as_deref(), Some("far"));
        assert_eq!(joined[1].results.runs, of_two.runs[1..2]);
    }

    #[test]
    fn cells_of_one_plan_on_machines_of_one_kind_stay_together() {
        let on = |host: &str, run: usize| {
            let mut part = sample();
            part.plan = Some("0123456789abcdef".into());
            part.machine.host = Some(host.into());
            part.runs = vec![part.runs.swap_remove(run)];
            part.runs[0].machine = Some(part.machine.clone());
            kept(host, part)
        };
        let mut other_kind = on("c", 2);
        other_kind.results.machine.cores = 64;
        other_kind.results.runs[0].machine = Some(other_kind.results.machine.clone());
        let joined = sources(vec![on("a", 0), on("b", 1), other_kind]);
        assert_eq!(joined.len(), 2);
        assert_eq!(joined[0].results.runs.len(), 2);
        assert_eq!(joined[0].results.machine.host.as_deref(), Some("a, b"));
        // Read back from one file, they are the same sources again.
        let folder = tempfile::tempdir().unwrap();
        let whole = merged(&joined, folder.path()).unwrap();
        crate::records::results_csv::save(&whole, folder.path()).unwrap();
        let again = sources(Kept::read(folder.path()).unwrap());
        let runs = again.iter().map(|source| source.results.runs.len());
        assert_eq!(runs.collect::<Vec<_>>(), [2, 1]);
        // Each run names its own machine.
        let machines = again[0].results.runs.iter().map(|run| run.machine.clone());
        let hosts = machines.map(|machine| machine.unwrap().host.unwrap());
        assert_eq!(hosts.collect::<Vec<_>>(), ["a", "b"]);
    }

    #[test]
    fn other_cells_machines_scenes_and_protocols_stay_apart() {
        let mut other_cell = later();
        other_cell.runs[0].cell = "1".into();
        let joined = sources(vec![kept("a", sample()), kept("b", other_cell.clone())]);
        assert_eq!(joined.len(), 2, "one label has one cell in each source");
        // Read back from one file, they are the same sources again.
        let again = merged(&joined, Path::new("a")).unwrap();
        let again = again.each().into_iter().map(|results| kept("a", results));
        assert_eq!(sources(again.collect()).len(), 2);
        other_cell.runs[0].preset = "another".into();
        let joined = sources(vec![kept("a", sample()), kept("b", other_cell)]);
        assert_eq!((joined.len(), joined[0].results.runs.len()), (1, 4));
        type Change = fn(&mut Results);
        let changes: [Change; 5] = [
            |other| other.machine.host = Some("far".into()),
            |other| other.adapter.driver = "driver 2".into(),
            |other| other.scene.name = "sponza".into(),
            |other| other.oracle = "offset:1".into(),
            |other| other.frames = 3,
        ];
        for change in changes {
            let mut other = sample();
            change(&mut other);
            let joined = sources(vec![kept("a", sample()), kept("b", other.clone())]);
            assert_eq!(joined.len(), 2);
            let whole = merged(&joined, Path::new("a")).unwrap();
            let images = |part: &Results| part.runs[0].measured.as_ref().unwrap().images.is_some();
            assert!(images(&whole) && !images(&whole.others[0]));
            assert_eq!(whole.each().len(), 2);
        }
        assert_eq!(merged(&[], Path::new("a")), None);
    }
}
