//! Keeps results in a folder that other processes may write at the same time, without losing the
//! runs of these processes.

use crate::error::CompareError;
use crate::files::lock;
use crate::lists::unique;
use crate::pictures::run_pictures::{PictureFile, write_pictures};
use crate::records::read_back::{self, WITHOUT_RESULTS};
use crate::records::results::{Results, Run};
use crate::records::results_csv::save;
use crate::sink::Sink;
use std::path::{Path, PathBuf};

/// The `results.json` of a folder, and the files beside it.
#[derive(Debug, Default)]
pub struct ResultsFolder {
    folder: PathBuf,
    /// Runs that were in the folder when it was opened, and that the next [`save`](Self::save)
    /// removes.
    pub dropped: Vec<Run>,
    /// The file as this process has read or written it last; none if there was none, or one that
    /// cannot be read.
    known: Option<String>,
    /// There is one that cannot be read, and is overwritten.
    is_unreadable: bool,
    /// Runs in the folder that are kept and were not measured by this process.
    pub others: Vec<Run>,
    /// Command lines that measured `others`.
    pub commands: Vec<String>,
    /// Notes on the scene that were recorded with `others`.
    pub notes: Vec<String>,
}

impl ResultsFolder {
    /// Opens a folder; its lists of runs are empty. A `results.json` that cannot be read will be
    /// overwritten by [`save`](Self::save); a caller that must not do so refuses it first.
    pub fn new(folder: &Path) -> Self {
        let file = read_back::results_file(&folder.join("results.json"));
        Self {
            folder: folder.to_path_buf(),
            is_unreadable: file.is_err(),
            known: file.ok().flatten().map(|file| file.text.to_string()),
            ..Self::default()
        }
    }

    /// Returns `own`, the results that this process measured, with [`others`](Self::others) behind
    /// its runs.
    pub fn whole(&self, own: &Results) -> Results {
        let commands = [&self.commands[..], &own.commands].concat();
        let notes = [&self.notes[..], &own.notes].concat();
        Results {
            commands: unique(commands),
            notes: unique(notes),
            runs: [&own.runs[..], &self.others].concat(),
            ..own.clone()
        }
    }

    /// Writes the runs of `own` (measured by this process), [`others`](Self::others), those that
    /// other processes have written meanwhile, and `pictures`, all under one lock.
    ///
    /// # Errors
    /// An early end; a file that cannot be written; a results.json that another process has
    /// meanwhile written of another adapter, scene or protocol ([`check_alike`]).
    pub fn save(
        &mut self,
        own: &Results,
        pictures: &[PictureFile],
        sink: &dyn Sink,
    ) -> Result<(), CompareError> {
        let _locked = lock::wait_for(&self.folder, lock::RESULTS, sink)?;
        self.merge(own)?;
        write_pictures(&self.folder, pictures)?;
        self.known = Some(save(&self.whole(own), &self.folder)?);
        self.is_unreadable = false;
        Ok(())
    }

    /// Takes over what other processes have written.
    fn merge(&mut self, own: &Results) -> Result<(), CompareError> {
        let path = self.folder.join("results.json");
        let file = match read_back::results_file(&path) {
            Err(_) if self.is_unreadable => None,
            file => file?,
        };
        let Some(file) = file else {
            return Ok(());
        };
        if self.known.as_deref() != Some(&*file.text) {
            let earlier = read_back::results_of(&file)?;
            check_alike(&path, &earlier, own)?;
            self.commands = unique([earlier.commands, self.commands.clone()].concat());
            self.notes = unique([earlier.notes, self.notes.clone()].concat());
            self.others = earlier.runs;
            self.others.retain(|run| !self.dropped.contains(run));
        }
        // Runs that were measured here count.
        let is_own = |run: &Run| own.runs.iter().any(|own| own.is_in_place_of(run));
        self.others.retain(|run| !is_own(run));
        Ok(())
    }
}

/// Refuses the earlier results in the file `path` if program, adapter, scene or protocol differ
/// from those of `now`.
///
/// # Errors
/// Lists how they differ.
pub fn check_alike(path: &Path, earlier: &Results, now: &Results) -> Result<(), CompareError> {
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
    pairs
        .filter(|((_, earlier), (_, now))| earlier != now)
        .map(|((what, earlier), (_, now))| format!("{what}: there {earlier}, here {now}"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::results::tests::sample;
    use crate::sink::Silent;

    /// Names of the runs in the folder's two files.
    fn kept(folder: &Path) -> Vec<String> {
        let results = read_back::kept(folder).unwrap();
        let names = results.runs.iter().map(|run| run.preset.clone());
        let names: Vec<String> = names.collect();
        let csv = std::fs::read_to_string(folder.join("results.csv")).unwrap();
        assert_eq!(csv.lines().count(), names.len() + 1);
        names
    }

    fn only(index: usize, command: &str) -> Results {
        let mut results = sample();
        results.runs = vec![results.runs.swap_remove(index)];
        results.commands = vec![command.into()];
        results
    }

    fn begin(folder: &Path, dropped: Vec<Run>) -> ResultsFolder {
        ResultsFolder {
            dropped,
            ..ResultsFolder::new(folder)
        }
    }

    #[test]
    fn runs_of_two_processes_that_began_together_are_both_kept() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let (mut one, mut other) = (begin(folder, Vec::new()), begin(folder, Vec::new()));
        one.save(&only(0, "one"), &[], &Silent).unwrap();
        other.save(&only(1, "other"), &[], &Silent).unwrap();
        one.save(&only(0, "one"), &[], &Silent).unwrap();
        assert_eq!(kept(folder), ["nsm", "rt"]);
        let mut commands = read_back::kept(folder).unwrap().commands;
        commands.sort();
        assert_eq!(commands, ["one", "other"]);
    }

    #[test]
    fn of_a_run_that_both_measure_the_later_one_counts() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let (mut one, mut other) = (begin(folder, Vec::new()), begin(folder, Vec::new()));
        other.save(&only(0, "other"), &[], &Silent).unwrap();
        let mut again = only(0, "one");
        again.runs[0].band = 77;
        let picture = PictureFile {
            name: "a.png".into(),
            bytes: vec![1],
        };
        one.save(&again, &[picture], &Silent).unwrap();
        assert_eq!(kept(folder), ["nsm"]);
        assert_eq!(read_back::kept(folder).unwrap().runs[0].band, 77);
        assert!(folder.join("a.png").is_file());
    }

    #[test]
    fn what_was_there_and_is_dropped_does_not_come_back_by_another_process() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        save(&sample(), folder).unwrap();
        let mut replaces = begin(folder, sample().runs);
        let mut adds = begin(folder, Vec::new());
        adds.others = sample().runs;
        let mut own = only(0, "adds");
        own.runs[0].preset = "crsm".into();
        adds.save(&own, &[], &Silent).unwrap();
        assert_eq!(kept(folder), ["crsm", "nsm", "rt", "rt_hw"]);
        let mut mine = only(1, "replaces");
        mine.runs[0].band = 1;
        replaces.save(&mine, &[], &Silent).unwrap();
        assert_eq!(kept(folder), ["rt", "crsm"]);
    }

    #[test]
    fn other_conditions_of_another_process_are_refused_and_its_file_stays() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let (mut one, mut other) = (begin(folder, Vec::new()), begin(folder, Vec::new()));
        other.save(&only(0, "other"), &[], &Silent).unwrap();
        let mut results = only(1, "one");
        results.frames = 3;
        let error = one.save(&results, &[], &Silent).unwrap_err().to_string();
        assert!(error.contains("frames: there 10, here 3"), "{error}");
        assert_eq!(kept(folder), ["nsm"]);
    }
}
