//! Decides which runs of an earlier comparison are kept: those of other methods, views and sizes,
//! and with `--resume` those that need not be measured again.
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
//! # async fn go_on(comparison: &Comparison, session: Session<'_>) -> Done {
//! // Runs in `out` of which nothing has changed are not measured again.
//! let series = Series::new(comparison, session, Some((Path::new("out"), Kept::All))).await?;
//! println!("{} of {} are there", series.results.runs.len(), series.planned());
//! # Ok(())
//! # }
//! ```

use crate::records::results::Run;
use crate::sink::Sink;
use crate::wording::plural;
use std::path::Path;

/// Which earlier results in a folder a comparison keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// No runs are kept: the first new results replace the file.
    Nothing,
    /// Runs of other methods, views, viewports and map sizes than this comparison measures are
    /// kept.
    Others,
    /// Runs that [`Others`](Self::Others) keeps, and runs of this comparison whose params, graph,
    /// shaders, scene and view have not changed since.
    All,
}

/// Finds the earlier runs that need not be measured again, of those that a folder holds. The
/// returned list is parallel to `planned`: the earlier run, or `None` if the run must be measured.
/// Only [`Kept::All`] reuses any. Tells the sink how many runs of `file` are kept.
pub(crate) fn earlier(
    file: &Path,
    keep: Kept,
    runs: Vec<&Run>,
    planned: &[Run],
    sink: &dyn Sink,
) -> Vec<Option<Run>> {
    let (name, resumes) = (file.display(), keep == Kept::All);
    if runs.is_empty() {
        if resumes {
            sink.note(&format!(
                "{name} is not there yet, so everything is measured"
            ));
        }
        return vec![None; planned.len()];
    }
    let is_planned = |run: &&Run| planned.iter().any(|planned| planned.is_in_place_of(run));
    let (mut runs, rest): (Vec<&Run>, Vec<&Run>) = runs.into_iter().partition(is_planned);
    if !rest.is_empty() {
        let stay = if rest.len() == 1 { "stays" } else { "stay" };
        let runs = plural(rest.len(), "other run");
        sink.note(&format!("{runs} that {name} holds already {stay} in it"));
    }
    if !resumes {
        return vec![None; planned.len()];
    }
    let total = runs.len();
    let is_tuned = planned.iter().any(|run| run.tuned.is_some());
    let take = |planned: &Run| {
        let is_kept =
            |run: &&Run| run.is_whole() && planned.is_in_place_of(run) && planned.is_unchanged(run);
        let index = runs.iter().position(is_kept)?;
        let mut kept = runs.swap_remove(index).clone();
        if let Some(measured) = kept.measured.as_mut().filter(|_| is_tuned) {
            measured.hint = None;
        }
        Some(Run {
            cell: planned.cell.clone(), // an older version may have kept none
            tuned: planned.tuned.clone(),
            ..kept
        })
    };
    let kept: Vec<Option<Run>> = planned.iter().map(take).collect();
    let measured = kept.iter().flatten().filter(|run| run.measured.is_some());
    let (count, planned) = (measured.count(), planned.len());
    sink.note(&format!("{count} of {planned} runs are kept from {name}"));
    if !runs.is_empty() {
        sink.note(&format!(
            "{} of the {total} in it are measured again: params, graph, shaders or \
             scene have changed since, or frames are missing",
            runs.len()
        ));
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measuring::store::Store;
    use crate::records::results::Results;
    use crate::records::results::tests::sample;
    use crate::records::results_csv::save;
    use crate::sink::Silent;

    /// Returns which runs of `sample()`, written to a file after `change`, are kept.
    fn kept(change: impl Fn(&mut Results, &mut Vec<Run>)) -> Result<Vec<bool>, String> {
        let folder = tempfile::tempdir().unwrap();
        save(&sample(), folder.path()).unwrap();
        let mut now = sample();
        let mut planned = now.runs.clone();
        change(&mut now, &mut planned);
        Store::open(folder.path(), Kept::All, (&now, &planned), &Silent)
            .map(|(_, kept)| kept.iter().map(Option::is_some).collect())
            .map_err(|error| error.to_string())
    }

    #[test]
    fn a_run_is_kept_unless_something_of_it_has_changed() {
        assert_eq!(kept(|_, _| ()), Ok(vec![true; 3]));
        type Change = fn(&mut Run);
        let changes: [Change; 2] = [
            |planned| planned.fingerprint = "0".into(),
            |planned| drop(planned.params.insert("cull".into(), "back".into())),
        ];
        for change in changes {
            let kept = kept(|_, planned| change(&mut planned[1]));
            assert_eq!(kept, Ok(vec![true, false, true]));
        }
        let more = kept(|_, planned| {
            let other = Run {
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
        let changes: [(Change, &str); 9] = [
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
                |now| now.others = vec![sample()],
                "joined results: there 0, here 1",
            ),
            (
                |now| now.regime_frames = 0,
                "frames of each regime: there 10, here 0",
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
        let planned = &sample().runs[1..2];
        for keep in [Kept::Others, Kept::All] {
            let now = sample();
            let opened = Store::open(folder.path(), keep, (&now, planned), &Silent);
            let (store, kept) = opened.unwrap();
            let own = Results {
                runs: planned.to_vec(),
                ..now
            };
            let whole = store.whole(&own);
            let presets: Vec<&str> = whole.runs.iter().map(|run| run.preset.as_str()).collect();
            assert_eq!(presets, ["rt", "nsm", "rt_hw"]);
            assert_eq!(kept[0].is_some(), keep == Kept::All);
        }
    }

    #[test]
    fn no_file_keeps_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let (now, planned) = (sample(), sample().runs);
        let opened = Store::open(folder.path(), Kept::All, (&now, &planned), &Silent);
        assert_eq!(opened.unwrap().1, [None, None, None]);
    }
}
