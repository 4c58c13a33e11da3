//! Keeps the runs of a comparison in a folder that other processes may write at the same time: each
//! in a file of its own, of which `results.json` and `results.csv` are made.

use crate::comparison::Comparison;
use crate::error::{CompareError, Result};
use crate::lists::unique;
use crate::measuring::resume::{Kept, earlier};
use crate::measuring::truth_folder::TruthFolder;
use crate::pictures::run_pictures::{PictureFile, write_pictures};
use crate::records::cell_files::{at_odds, check_version, disagreement};
use crate::records::cells::Cells;
use crate::records::read_back::{self, WITHOUT_RESULTS};
use crate::records::results::{Results, Run};
use crate::records::results_csv;
use crate::sink::{Silent, Sink};
use itertools::Itertools;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The cells in a folder, and what else a comparison writes there.
pub struct Store {
    folder: PathBuf,
    cells: Cells,
    /// The conditions of this comparison, without runs.
    head: Results,
    /// Names of files that the next [`save`](Self::save) removes.
    dropped: Vec<String>,
    /// The reference's answers that a shard of a plan shares with others, and the commit that the
    /// program was built from. A shard leaves `results.json` to `merge`.
    share: Option<(TruthFolder, Option<String>)>,
}

impl Store {
    /// Opens the folder of a comparison whose runs are `planned`, under the conditions of `now`.
    /// Returns the earlier runs that need not be measured again, parallel to `planned`, and tells
    /// the sink how many runs are kept.
    ///
    /// # Errors
    /// A file that cannot be read, or was measured with another adapter, scene or protocol than
    /// `now`. With [`Kept::Nothing`], such a file is not an error.
    pub fn open(
        folder: &Path,
        keep: Kept,
        (now, planned): (&Results, &[Run]),
        sink: &dyn Sink,
    ) -> Result<(Self, Vec<Option<Run>>)> {
        let (file, keeps) = (folder.join("results.json"), keep != Kept::Nothing);
        let results = keeps.then(|| read_back::results(&file)).transpose()?;
        let results = results.flatten();
        if let Some(results) = &results {
            check_alike(&file, results, now)?;
        }
        let mut store = Self::new(folder, Cells::open(folder, None, results)?, now);
        if keeps {
            return store.begin(keep, planned, sink);
        }
        store.dropped = store.cells.files.keys().cloned().collect();
        store.cells.torn.clear();
        Ok((store, vec![None; planned.len()]))
    }

    /// Opens a folder for a shard: for those of the `planned` runs whose cells are `chosen`.
    /// Returns those that need not be measured again, as [`open`](Self::open) does, whichever
    /// machine measured them. Tells the sink about files that cannot be read.
    ///
    /// # Errors
    /// A folder that cannot be made; a cell that another version of the program has measured.
    pub fn of_share(
        folder: &Path,
        (comparison, chosen): (&Comparison, &BTreeSet<&str>),
        (now, planned): (&Results, &[Run]),
        sink: &dyn Sink,
    ) -> Result<(Self, Vec<Option<Run>>)> {
        let truths = TruthFolder::new(folder, comparison);
        truths.make()?;
        let names = chosen.iter().map(|id| format!("{id}.json")).collect();
        let mut store = Self::new(folder, Cells::open(folder, Some(names), None)?, now);
        for why in store.cells.torn.drain(..) {
            sink.note(&format!("{why}\n  it is measured anew"));
        }
        store.share = Some((truths, comparison.commit.clone()));
        store.begin(Kept::All, planned, &Silent)
    }

    fn new(folder: &Path, cells: Cells, now: &Results) -> Self {
        Self {
            folder: folder.to_path_buf(),
            cells,
            head: now.clone(),
            dropped: Vec::new(),
            share: None,
        }
    }

    fn begin(
        mut self,
        keep: Kept,
        planned: &[Run],
        sink: &dyn Sink,
    ) -> Result<(Self, Vec<Option<Run>>)> {
        let names: Vec<String> = self.cells.files.keys().cloned().collect();
        self.check(&names)?;
        let cells = self.cells.in_order().into_iter();
        let runs = cells.flat_map(|one| &one.runs).collect();
        let kept = earlier(&self.folder.join("results.json"), keep, runs, planned, sink);
        Ok((self, kept))
    }

    /// Returns the reference's answers that machines share, for a shard.
    pub fn truths(&self) -> Option<&TruthFolder> {
        self.share.as_ref().map(|(truths, _)| truths)
    }

    /// Refuses files that cannot be read, and cells that were not measured alike.
    fn check(&mut self, names: &[String]) -> Result<()> {
        if let Some(why) = self.cells.torn.pop() {
            return Err(why);
        }
        for name in names {
            let path = self.cells.path(name);
            match (self.cells.get(name), &self.share) {
                (Some(one), Some((_, commit))) => check_version(&path, one, commit.as_deref())?,
                (Some(one), None) => check_alike(&path, one, &self.head)?,
                (None, _) => {}
            }
        }
        Ok(())
    }

    /// Takes over what other processes have written; returns false if they have written nothing.
    fn refresh(&mut self) -> Result<bool> {
        let changed = self.cells.refresh();
        self.check(&changed)?;
        Ok(!changed.is_empty())
    }

    /// Returns `own`, the results that this process measured, with the other runs that the folder
    /// holds behind its runs.
    pub fn whole(&self, own: &Results) -> Results {
        let mut whole = own.clone();
        let cells = self.cells.in_order();
        let heads = cells.iter().copied().sorted_by_key(|one| &one.began);
        let heads: Vec<&Results> = heads.chain([own]).collect();
        whole.commands = unique(heads.iter().flat_map(|head| head.commands.clone()));
        whole.notes = unique(heads.iter().flat_map(|head| head.notes.clone()));
        // Runs that were measured here count.
        let is_own = |run: &Run| own.runs.iter().any(|own| own.is_in_place_of(run));
        let runs = cells.iter().flat_map(|one| &one.runs);
        whole.runs.extend(runs.filter(|run| !is_own(run)).cloned());
        whole
    }

    /// Writes `pictures`, and each run of `own` (measured by this process) that the folder does not
    /// hold yet. Then makes `results.json` and `results.csv` of all runs in the folder.
    ///
    /// # Errors
    /// A file that cannot be written; a cell that another process has meanwhile measured under
    /// other conditions ([`check_alike`]) or with other errors.
    pub fn save(&mut self, own: &Results, pictures: &[PictureFile]) -> Result<()> {
        self.refresh()?;
        write_pictures(&self.folder, pictures)?;
        for name in std::mem::take(&mut self.dropped) {
            let cell = self.cells.files.get(&name);
            if cell.is_some_and(|cell| !cell.is_foreign) {
                self.cells.remove(&name)?;
            }
        }
        for run in &own.runs {
            // Where another process has just made the file, it is read first.
            if self.keep(run)? || (self.refresh()? && self.keep(run)?) {
                continue;
            }
            let path = self.cells.path(&self.cells.name_of(run));
            let why = "another process writes and removes it";
            return Err(CompareError::write(&path, why));
        }
        // The process that writes last has seen the cells of all.
        while self.share.is_none() {
            results_csv::save(&self.whole(own), &self.folder)?;
            if !self.refresh()? {
                break;
            }
        }
        Ok(())
    }

    /// Writes the file of a run, unless it holds it already. Returns false if another process has
    /// just made that file.
    fn keep(&mut self, run: &Run) -> Result<bool> {
        let name = self.cells.name_of(run);
        let cell = self.cells.files.get(&name);
        let (is_there, is_foreign) = (cell.is_some(), cell.is_some_and(|cell| cell.is_foreign));
        let mut head = &self.head;
        if let Some(there) = self.cells.get(&name) {
            let other = &there.runs[0];
            if other == run {
                return Ok(true);
            }
            if is_foreign && other.fingerprint == run.fingerprint {
                let is_like = there.adapter == head.adapter;
                if let Some(why) = disagreement(run, other).filter(|_| is_like) {
                    let places = [&self.cells.path(&name), Path::new("here")];
                    return Err(at_odds(run, places, &why));
                }
                let is_further = other.measured.is_none() || !other.is_whole() && run.is_whole();
                if !(is_like && is_further) {
                    return Ok(true);
                }
            }
            if other.session == run.session {
                head = there;
            }
        }
        let one = Results {
            runs: vec![run.clone()],
            ..head.clone()
        };
        if !is_there {
            let is_replaced = |name: &&String| {
                let there = self.cells.get(name);
                there.is_some_and(|there| run.is_in_place_of(&there.runs[0]))
            };
            let names = self.cells.files.keys().filter(is_replaced);
            for name in names.cloned().collect_vec() {
                self.cells.remove(&name)?;
            }
        }
        self.cells.write(&name, one)
    }
}

/// Refuses the earlier results in the file `path` if program, adapter, scene or protocol differ
/// from those of `now`.
///
/// # Errors
/// Lists how they differ.
pub fn check_alike(path: &Path, earlier: &Results, now: &Results) -> Result<()> {
    match &differences(earlier, now)[..] {
        [] => Ok(()),
        lines => Err(CompareError::Input(format!(
            "{} was measured under other conditions\n  {}\n  ask for the same, \
             {WITHOUT_RESULTS}",
            path.display(),
            lines.join("\n  ")
        ))),
    }
}

/// Conditions in which both were not measured alike.
fn differences(earlier: &Results, now: &Results) -> Vec<String> {
    // Why timestamps are not trusted may hold figures of the check that found it out.
    let trusted = |results: &Results| match results.adapter.gpu_unavailable {
        None => "measured",
        Some(_) => "not to be had",
    };
    let facts = |results: &Results| {
        [
            ("program", results.program.clone()),
            ("adapter", results.adapter.to_string()),
            ("GPU times", trusted(results).to_owned()),
            ("scene", results.scene.to_string()),
            ("oracle", results.oracle.clone()),
            ("frames", results.frames.to_string()),
            ("warmup", results.warmup.to_string()),
            ("frames of each regime", results.regime_frames.to_string()),
            ("joined results", results.others.len().to_string()),
        ]
    };
    let pairs = facts(earlier).into_iter().zip(facts(now));
    let pairs = pairs.filter(|((_, earlier), (_, now))| earlier != now);
    let line = |((what, there), (_, own))| format!("{what}: there {there}, here {own}");
    pairs.map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::results::tests::sample;
    use std::{fs, thread};

    /// Names of the runs in the folder's two files, and that of cells.
    fn kept(folder: &Path) -> Vec<String> {
        let results = read_back::kept(folder).unwrap();
        let names = results.runs.iter().map(|run| run.preset.clone());
        let names: Vec<String> = names.collect();
        let csv = fs::read_to_string(folder.join("results.csv")).unwrap();
        assert_eq!(csv.lines().count(), names.len() + 1);
        assert_eq!(cells(folder).len(), names.len());
        names
    }

    fn cells(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder.join("cells")).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.sorted().collect()
    }

    fn only(index: usize, command: &str) -> Results {
        let mut results = sample();
        results.runs = vec![results.runs.swap_remove(index)];
        results.commands = vec![command.into()];
        results
    }

    fn open(folder: &Path, keep: Kept, now: &Results) -> Result<Store, CompareError> {
        let opened = Store::open(folder, keep, (now, &now.runs), &Silent);
        opened.map(|(store, _)| store)
    }

    fn begin(folder: &Path, now: &Results) -> Store {
        open(folder, Kept::Others, now).unwrap()
    }

    #[test]
    fn runs_of_two_processes_that_began_together_are_both_kept() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let results = [only(0, "one"), only(1, "other")];
        let [mut one, mut other] = results.each_ref().map(|results| begin(folder, results));
        one.save(&results[0], &[]).unwrap();
        other.save(&results[1], &[]).unwrap();
        assert_eq!(kept(folder), ["rt", "nsm"]);
        one.save(&results[0], &[]).unwrap();
        assert_eq!(kept(folder), ["nsm", "rt"]);
        let mut commands = read_back::kept(folder).unwrap().commands;
        commands.sort();
        assert_eq!(commands, ["one", "other"]);
    }

    /// Writers that overlap in all ways lose nothing, and the files of all are those of the last.
    #[test]
    fn many_writers_at_once_lose_no_cell() {
        let (writers, runs) = (4, 12);
        for round in 0..5 {
            let folder = tempfile::tempdir().unwrap();
            thread::scope(|scope| {
                for writer in 0..writers {
                    let folder = folder.path();
                    scope.spawn(move || {
                        let mut own = only(0, &format!("writer {writer}"));
                        let run = own.runs.remove(0);
                        let mut store = begin(folder, &own);
                        for number in 0..runs {
                            let number = writer * runs + number;
                            let mut judged = Run {
                                preset: format!("nsm@n={number}"),
                                cell: format!("{number:016x}"),
                                ..run.clone()
                            };
                            let turns = judged.measured.as_mut().unwrap().turns.take();
                            own.runs.push(judged);
                            store.save(&own, &[]).unwrap();
                            let timed = own.runs.last_mut().unwrap();
                            timed.measured.as_mut().unwrap().turns = turns;
                            thread::yield_now();
                        }
                        store.save(&own, &[]).unwrap();
                    });
                }
            });
            let names = kept(folder.path());
            assert_eq!(names.iter().unique().count(), writers * runs, "{round}");
            let results = read_back::kept(folder.path()).unwrap();
            assert!(results.runs.iter().all(Run::is_whole), "{round}");
            assert_eq!(results.commands.len(), writers);
        }
    }

    #[test]
    fn of_a_cell_that_two_measure_the_first_whole_one_stays_and_errors_must_agree() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let (first, mut second) = (only(0, "one"), only(0, "other"));
        second.runs[0].session = "2026-11-21T04:30:12Z".into();
        let [mut one, mut other, mut third] = [(); 3].map(|()| begin(folder, &first));
        let mut judged = first.clone();
        judged.runs[0].measured.as_mut().unwrap().turns = None;
        one.save(&judged, &[]).unwrap();
        other.save(&second, &[]).unwrap();
        one.save(&first, &[]).unwrap();
        let file = folder.join("cells").join(&cells(folder)[0]);
        let written = || read_back::kept(&file).unwrap().runs[0].session.clone();
        assert_eq!(written(), second.runs[0].session);
        second.runs[0].band = 77;
        let picture = PictureFile {
            name: "a.png".into(),
            bytes: vec![1],
        };
        let error = third.save(&second, &[picture]).unwrap_err().to_string();
        assert!(
            error.contains("was measured twice") && error.contains("band: 77 and 12"),
            "{error}"
        );
        assert!(folder.join("a.png").is_file());
        // One that is there before is measured anew.
        let mut later = begin(folder, &second);
        later.save(&second, &[]).unwrap();
        assert_eq!(read_back::kept(folder).unwrap().runs[0].band, 77);
        assert_eq!(cells(folder).len(), 1);
    }

    #[test]
    fn a_run_takes_the_place_of_one_with_other_params() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        begin(folder, &sample()).save(&sample(), &[]).unwrap();
        let mut own = only(1, "again");
        own.runs[0].cell = "0123456789abcdef".into();
        begin(folder, &own).save(&own, &[]).unwrap();
        assert_eq!(kept(folder), ["rt", "nsm", "rt_hw"]);
        assert!(cells(folder).contains(&"0123456789abcdef.json".to_owned()));
        // Another label of the same cell has a file beside it.
        own.runs[0].preset = "rt@n=1".into();
        begin(folder, &own).save(&own, &[]).unwrap();
        assert_eq!(kept(folder), ["rt@n=1", "rt", "nsm", "rt_hw"]);
        assert!(cells(folder).contains(&"0123456789abcdef_2.json".to_owned()));
    }

    #[test]
    fn what_was_there_and_is_dropped_does_not_come_back_by_another_process() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        results_csv::save(&sample(), folder).unwrap();
        let mut own = sample();
        own.runs.truncate(2);
        (own.runs[0].preset, own.runs[0].cell) = ("crsm".into(), "1".into());
        own.runs[1].session = "2026-11-21T04:30:12Z".into();
        let mut adds = begin(folder, &own);
        let mine = only(2, "replaces");
        let mut replaces = open(folder, Kept::Nothing, &mine).unwrap();
        adds.save(&own, &[]).unwrap();
        assert_eq!(kept(folder), ["crsm", "rt", "nsm", "rt_hw"]);
        replaces.save(&mine, &[]).unwrap();
        let names: Vec<String> = kept(folder).into_iter().sorted().collect();
        assert_eq!(names, ["crsm", "rt", "rt_hw"]);
        adds.save(&own, &[]).unwrap();
        assert_eq!(kept(folder), ["crsm", "rt", "rt_hw"]);
        // Conditions that differ are no hindrance, and end the other.
        let mut other = only(0, "replaces");
        other.frames = 3;
        let mut replaces = open(folder, Kept::Nothing, &other).unwrap();
        replaces.save(&other, &[]).unwrap();
        assert_eq!(kept(folder), ["nsm"]);
        let error = adds.save(&own, &[]).unwrap_err().to_string();
        assert!(error.contains("frames: there 3, here 10"), "{error}");
        assert_eq!(kept(folder), ["nsm"]);
    }

    #[test]
    fn other_conditions_of_another_process_are_refused_and_its_file_stays() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let mut results = only(1, "one");
        results.frames = 3;
        let mut one = begin(folder, &results);
        let mut other = begin(folder, &only(0, "other"));
        other.save(&only(0, "other"), &[]).unwrap();
        let error = one.save(&results, &[]).unwrap_err().to_string();
        assert!(error.contains("frames: there 10, here 3"), "{error}");
        assert_eq!(kept(folder), ["nsm"]);
    }

    #[test]
    fn a_torn_cell_is_told_with_the_way_out_and_replace_needs_none() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        begin(folder, &sample()).save(&sample(), &[]).unwrap();
        let file = folder.join("cells").join(&cells(folder)[0]);
        let text = fs::read(&file).unwrap();
        fs::write(&file, &text[..text.len() / 2]).unwrap();
        let error = open(folder, Kept::All, &sample())
            .err()
            .unwrap()
            .to_string();
        assert!(error.contains("delete it, and measure the cell"), "{error}");
        assert_eq!(cells(folder).len(), 3, "nothing is lost");
        let own = only(0, "replaces");
        let mut store = open(folder, Kept::Nothing, &own).unwrap();
        store.save(&own, &[]).unwrap();
        assert_eq!(kept(folder), ["nsm"]);
    }
}
