//! `compare --resume`: what of an earlier comparison need not be measured again.

use crate::{
    error::{CliError, note},
    fault::Fault,
    results::{Results, Run},
};
use serde::Deserialize;
use serde_json::Value;
use skiagraph_graph::SourceFile;
use skiagraph_scene::Limit;
use std::{collections::BTreeMap, io::ErrorKind, path::Path};

/// How to get on without the earlier results.
const WAY_OUT: &str =
    "give another --out, or leave out --resume, which measures everything and overwrites the file";

/// Some twenty thousand runs.
const RESULTS: Limit = Limit {
    of: "a results.json",
    mib: 64,
    way_out: WAY_OUT,
};

/// What tells a run from every other.
#[derive(Clone, Debug, PartialEq)]
pub struct Identity {
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
    /// Of everything else that the run depends on.
    pub fingerprint: String,
}

impl Identity {
    /// Whether the run stands at this place of the comparison.
    fn is_place_of(&self, run: &Run) -> bool {
        (&self.preset, &self.view, self.viewport, self.map_size)
            == (&run.preset, &run.view, run.viewport, run.map_size)
    }

    fn is_of(&self, run: &Run) -> bool {
        self.is_place_of(run)
            && (&self.params, &self.fingerprint) == (&run.params, &run.fingerprint)
    }
}

/// The runs of an earlier comparison that are as this one would have them: one for each of `planned`, where there is one.
///
/// # Errors
/// A file that cannot be read, is no results.json, was measured under other conditions than `now`, or holds runs that the new file
/// would not.
pub fn resume(
    folder: &Path,
    now: &Results,
    planned: &[Identity],
) -> Result<Vec<Option<Run>>, CliError> {
    let path = folder.join("results.json");
    let name = path.display().to_string();
    let text = match RESULTS.read_text(&path) {
        Ok(text) => text,
        Err(error) if error.kind() == ErrorKind::NotFound => {
            note(&format!(
                "--resume: there is no {name} yet, so everything is measured"
            ));
            return Ok(planned.iter().map(|_| None).collect());
        }
        Err(error) => return Err(CliError::Input(format!("--resume {name}: {error}"))),
    };
    let earlier = read(&SourceFile::new(name.as_str(), text))?;
    let differences = differences(&earlier, now);
    if !differences.is_empty() {
        return Err(refused(
            &name,
            "was measured under other conditions",
            &differences,
        ));
    }
    let foreign: Vec<String> = earlier
        .runs
        .iter()
        .filter(|run| !planned.iter().any(|planned| planned.is_place_of(run)))
        .map(place)
        .collect();
    if !foreign.is_empty() {
        return Err(refused(
            &name,
            "holds runs that this comparison has not, and they would be lost",
            &foreign,
        ));
    }
    let mut runs = earlier.runs;
    let total = runs.len();
    let kept: Vec<Option<Run>> = planned
        .iter()
        .map(|planned| {
            let index = runs.iter().position(|run| planned.is_of(run))?;
            Some(runs.swap_remove(index))
        })
        .collect();
    let measured = kept.iter().flatten().filter(|run| run.measured.is_some());
    note(&format!(
        "--resume: {} of {} runs are kept from {name}",
        measured.count(),
        planned.len()
    ));
    if !runs.is_empty() {
        note(&format!(
            "--resume: {} of the {total} in it are measured again: params, graph, shaders or scene have changed since",
            runs.len()
        ));
    }
    Ok(kept)
}

fn refused(name: &str, what: &str, lines: &[String]) -> CliError {
    /// Nobody reads on to the end of a longer list.
    const MOST_LINES: usize = 8;
    let mut shown = lines[..lines.len().min(MOST_LINES)].join("\n  ");
    if lines.len() > MOST_LINES {
        shown.push_str(&format!("\n  and {} more", lines.len() - MOST_LINES));
    }
    CliError::Input(format!(
        "--resume: {name} {what}\n  {shown}\n  ask for the same, {WAY_OUT}"
    ))
}

fn place(run: &Run) -> String {
    let [width, height] = run.viewport;
    let map = run.map_size.map_or(String::new(), |n| format!(", map {n}"));
    format!("{} on {} {width}x{height}{map}", run.preset, run.view)
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

/// What tells a results.json from other JSON. Any other file lacks many fields, and to name the first would mislead.
#[derive(Deserialize)]
struct Head {
    schema: Option<Value>,
    oracle: Option<Value>,
    runs: Option<Value>,
}

fn read(file: &SourceFile) -> Result<Results, CliError> {
    parse(file).map_err(|fault| {
        let summary = "nothing was measured";
        fault.in_file(file, "results.json to resume", WAY_OUT, summary)
    })
}

fn parse(file: &SourceFile) -> Result<Results, Fault> {
    let text = &*file.text;
    let head: Head = serde_json::from_str(text).map_err(|error| Fault::json(text, &error))?;
    if head.oracle.is_none() || head.runs.is_none() {
        let what = "there is no \"oracle\" in it, or there are no \"runs\"".into();
        return Err(Fault::at_field(text, "{", what));
    }
    if head.schema != Some(1.into()) {
        let version = head.schema.unwrap_or_default();
        let what = format!("this program reads version 1 of the schema, not {version}");
        return Err(Fault::at_field(text, "\"schema\"", what));
    }
    let results: Results = serde_json::from_str(text).map_err(|error| Fault::json(text, &error))?;
    // A mistake in a run's measurements reads as a run without any.
    let is_broken = |run: &&Run| run.measured.is_none() && run.unavailable.is_none();
    match results.runs.iter().find(is_broken) {
        None => Ok(results),
        Some(run) => {
            let what = format!(
                "{} has neither all its measurements nor a reason why not",
                place(run)
            );
            let field = format!("\"preset\": {}", Value::from(run.preset.as_str()));
            Err(Fault::at_field(text, &field, what))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::tests::sample;

    fn identities(results: &Results) -> Vec<Identity> {
        let identity = |run: &Run| Identity {
            preset: run.preset.clone(),
            view: run.view.clone(),
            viewport: run.viewport,
            map_size: run.map_size,
            params: run.params.clone(),
            fingerprint: run.fingerprint.clone(),
        };
        results.runs.iter().map(identity).collect()
    }

    /// What is kept of `sample()`, written to a file, by what `change` makes of it.
    fn kept(change: impl Fn(&mut Results, &mut Vec<Identity>)) -> Result<Vec<bool>, String> {
        let folder = tempfile::tempdir().unwrap();
        sample().save(folder.path()).unwrap();
        let mut now = sample();
        let mut planned = identities(&now);
        change(&mut now, &mut planned);
        resume(folder.path(), &now, &planned)
            .map(|runs| runs.iter().map(Option::is_some).collect())
            .map_err(|error| error.to_string())
    }

    #[test]
    fn a_run_is_kept_unless_something_of_it_has_changed() {
        assert_eq!(kept(|_, _| ()), Ok(vec![true; 3]));
        type Change = fn(&mut Identity);
        let changes: [Change; 2] = [
            |planned| planned.fingerprint = "0".into(),
            |planned| drop(planned.params.insert("cull".into(), "back".into())),
        ];
        for change in changes {
            let kept = kept(|_, planned| change(&mut planned[1]));
            assert_eq!(kept, Ok(vec![true, false, true]));
        }
        let more = kept(|_, planned| {
            let other = Identity {
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
                error.contains("another --out") && error.contains("leave out --resume"),
                "{error}"
            );
        }
    }

    #[test]
    fn runs_that_would_be_lost_are_named() {
        let error = kept(|_, planned| drop(planned.remove(0))).unwrap_err();
        assert!(error.contains("nsm on main 512x256, map 1024"), "{error}");
    }

    #[test]
    fn no_file_keeps_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let kept = resume(folder.path(), &sample(), &identities(&sample())).unwrap();
        assert_eq!(kept, [None, None, None]);
    }

    #[test]
    fn a_broken_or_foreign_file_is_shown_with_its_place() {
        let good = sample().to_json();
        let texts = [
            good.replacen("\"lit\": 60000,", "\"lit\": 60000", 1),
            good.replacen("\"frames\": 10", "\"frames\": \"ten\"", 1),
            good.replacen("\"schema\": 1", "\"schema\": 2", 1),
            good.replacen("\"memory_bytes\": 12582912,", "", 1),
            "{\"schema\": 1, \"kind\": \"profile\"}\n".to_owned(),
            String::new(),
        ];
        let refused = |text: String| {
            let error = read(&SourceFile::new("results.json", text)).unwrap_err();
            assert_eq!(error.exit_code(), 1);
            error.to_string()
        };
        assert!(texts.iter().all(|text| *text != good));
        insta::assert_snapshot!(texts.map(refused).join("\n"));
    }
}
