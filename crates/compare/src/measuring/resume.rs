//! The parts of an earlier comparison that stay: the runs of others, and with `--resume` those that
//! need not be measured again.
//!
//! ```no_run
//! use skiagraph_compare::{
//!     comparison::Comparison,
//!     measuring::{resume::Kept, series::Series},
//!     sink::Session,
//! };
//! use std::path::Path;
//!
//! # type Done = Result<(), Box<dyn std::error::Error>>;
//! # fn go_on(comparison: &Comparison, session: Session) -> Done {
//! // Runs in `out` of which nothing has changed are not measured again.
//! let series = Series::new(comparison, session, Some((Path::new("out"), Kept::All)))?;
//! println!("{} of {} are there", series.results.runs.len(), series.planned());
//! # Ok(())
//! # }
//! ```

use crate::error::CompareError;
use crate::records::read_back::{self, WITHOUT_RESULTS};
use crate::records::results::{Results, Run};
use crate::sink::Sink;
use crate::wording::plural;
use serde_json::Value;
use std::{collections::BTreeMap, path::Path};

/// The results in a folder that stay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// Nothing.
    Nothing,
    /// Runs of other methods, views and sizes.
    Others,
    /// These, and runs of which nothing has changed since.
    All,
}

/// The traits that tell a run from every other.
#[derive(Clone, Debug, PartialEq)]
pub struct RunKey {
    /// Name of the preset, or path of the graph.
    pub preset: String,
    /// Name of the view.
    pub view: String,
    /// Width and height in pixels.
    pub viewport: [u32; 2],
    /// Value of the param `map_size`.
    pub map_size: Option<u32>,
    /// All params.
    pub params: BTreeMap<String, Value>,
    /// Hash of everything else that the run depends on.
    pub fingerprint: String,
}

impl RunKey {
    /// True if the run stands at this place of the comparison.
    fn is_place_of(&self, run: &Run) -> bool {
        (&self.preset, &self.view, self.viewport, self.map_size)
            == (&run.preset, &run.view, run.viewport, run.map_size)
    }

    fn is_of(&self, run: &Run) -> bool {
        self.is_place_of(run)
            && (&self.params, &self.fingerprint) == (&run.params, &run.fingerprint)
    }
}

/// The parts of an earlier comparison that stay.
#[derive(Debug, Default)]
pub struct Earlier {
    /// For each planned run the one that is as this comparison would have it.
    pub kept: Vec<Option<Run>>,
    /// Runs that this comparison has not: of other methods, views, sizes.
    pub others: Vec<Run>,
    /// Runs that it measures again.
    pub dropped: Vec<Run>,
    /// Commands that measured them.
    pub commands: Vec<String>,
}

/// Returns what stays of an earlier comparison in the same folder; of the planned runs only if
/// `resumes`.
///
/// # Errors
/// A file that cannot be read, is no results.json, or was measured under other conditions than
/// `now`.
pub fn earlier(
    folder: &Path,
    now: &Results,
    planned: &[RunKey],
    resumes: bool,
    sink: &dyn Sink,
) -> Result<Earlier, CompareError> {
    let path = folder.join("results.json");
    let name = path.display().to_string();

    let Some(earlier) = read_back::results(&path)? else {
        if resumes {
            sink.note(&format!(
                "{name} is not there yet, so everything is measured"
            ));
        }
        return Ok(Earlier {
            kept: vec![None; planned.len()],
            ..Earlier::default()
        });
    };
    check_alike(&path, &earlier, now)?;
    let is_planned = |run: &Run| planned.iter().any(|planned| planned.is_place_of(run));
    let (mut runs, others): (Vec<Run>, Vec<Run>) = earlier.runs.into_iter().partition(is_planned);
    if !others.is_empty() {
        let stay = if others.len() == 1 { "stays" } else { "stay" };
        let runs = plural(others.len(), "other run");
        sink.note(&format!("{runs} that {name} holds already {stay} in it"));
    }
    let commands = if others.is_empty() && !resumes {
        Vec::new()
    } else {
        earlier.commands
    };
    let total = runs.len();
    let take = |planned: &RunKey| {
        let mut known = runs.iter();
        let is_kept = |run: &Run| planned.is_of(run) && run.is_whole();
        let index = known.position(|run| resumes && is_kept(run))?;
        Some(runs.swap_remove(index))
    };
    let kept: Vec<Option<Run>> = planned.iter().map(take).collect();
    if resumes {
        let measured = kept.iter().flatten().filter(|run| run.measured.is_some());
        let (count, of) = (measured.count(), planned.len());
        sink.note(&format!("{count} of {of} runs are kept from {name}"));
    }
    if resumes && !runs.is_empty() {
        sink.note(&format!(
            "{} of the {total} in it are measured again: params, graph, shaders or \
             scene have changed since, or frames are missing",
            runs.len()
        ));
    }
    Ok(Earlier {
        kept,
        others,
        dropped: runs,
        commands,
    })
}

/// Refuses earlier results that were measured under other conditions.
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
            ("cached frames", results.cached_frames.to_string()),
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
    use crate::records::results_csv::save;
    use crate::sink::Silent;

    fn run_keys(results: &Results) -> Vec<RunKey> {
        let identity = |run: &Run| RunKey {
            preset: run.preset.clone(),
            view: run.view.clone(),
            viewport: run.viewport,
            map_size: run.map_size,
            params: run.params.clone(),
            fingerprint: run.fingerprint.clone(),
        };
        results.runs.iter().map(identity).collect()
    }

    /// Returns which runs of `sample()`, written to a file after `change`, are kept.
    fn kept(change: impl Fn(&mut Results, &mut Vec<RunKey>)) -> Result<Vec<bool>, String> {
        let folder = tempfile::tempdir().unwrap();
        save(&sample(), folder.path()).unwrap();
        let mut now = sample();
        let mut planned = run_keys(&now);
        change(&mut now, &mut planned);
        earlier(folder.path(), &now, &planned, true, &Silent)
            .map(|earlier| earlier.kept.iter().map(Option::is_some).collect())
            .map_err(|error| error.to_string())
    }

    #[test]
    fn a_run_is_kept_unless_something_of_it_has_changed() {
        assert_eq!(kept(|_, _| ()), Ok(vec![true; 3]));
        type Change = fn(&mut RunKey);
        let changes: [Change; 2] = [
            |planned| planned.fingerprint = "0".into(),
            |planned| drop(planned.params.insert("cull".into(), "back".into())),
        ];
        for change in changes {
            let kept = kept(|_, planned| change(&mut planned[1]));
            assert_eq!(kept, Ok(vec![true, false, true]));
        }
        let more = kept(|_, planned| {
            let other = RunKey {
                preset: "crsm".into(),
                ..planned[0].clone()
            };
            planned.insert(1, other);
        });
        assert_eq!(more, Ok(vec![true, false, true, true]));
    }

    #[test]
    fn other_conditions_are_named_with_the_way_out() {
        type Change = fn(&mut Results);
        let changes: [(Change, &str); 8] = [
            (|now| now.program = "x".into(), "program: there"),
            (|now| now.adapter.driver = "x".into(), "adapter: there"),
            (
                |now| now.adapter.gpu_unavailable = Some("x".into()),
                "GPU times: there measured, here not to be had",
            ),
            (|now| now.scene.triangles = 1, "here park, 1 triangle"),
            (|now| now.oracle = "offset:1".into(), "here offset:1"),
            (|now| now.frames = 7, "frames: there 10, here 7"),
            (|now| now.warmup = 0, "warmup: there 2, here 0"),
            (
                |now| now.cached_frames = 0,
                "cached frames: there 10, here 0",
            ),
        ];
        for (change, part) in changes {
            let error = kept(|now, _| change(now)).unwrap_err();
            assert!(error.contains(part), "no {part:?} in {error}");
            assert!(
                error.contains("another folder") && error.contains("`--replace`"),
                "{error}"
            );
        }
    }

    #[test]
    fn runs_of_other_methods_stay() {
        let folder = tempfile::tempdir().unwrap();
        save(&sample(), folder.path()).unwrap();
        let planned = &run_keys(&sample())[1..2];
        for resumes in [false, true] {
            let stay = earlier(folder.path(), &sample(), planned, resumes, &Silent).unwrap();
            let others: Vec<&str> = stay.others.iter().map(|run| run.preset.as_str()).collect();
            assert_eq!(others, ["nsm", "rt_hw"]);
            assert_eq!(stay.kept[0].is_some(), resumes);
        }
    }

    #[test]
    fn no_file_keeps_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let none = earlier(
            folder.path(),
            &sample(),
            &run_keys(&sample()),
            true,
            &Silent,
        )
        .unwrap();
        assert_eq!(none.kept, [None, None, None]);
        assert_eq!(none.others, []);
    }
}
