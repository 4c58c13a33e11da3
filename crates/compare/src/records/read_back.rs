//! Reads files back that `compare`, `stress` and `profile --json` wrote.
//!
//! ```
//! use skiagraph_compare::records::read_back;
//!
//! # let out = tempfile::tempdir()?;
//! # let name = "skiagraph_compare__records__results__tests__the_schema_is_pinned_and_reads_back";
//! # let pinned = std::fs::read_to_string(format!("src/records/snapshots/{name}.snap"))?;
//! # std::fs::write(out.path().join("results.json"), &pinned[pinned.find('{').unwrap_or(0)..])?;
//! let results = read_back::results(&out.path().join("results.json"))?.ok_or("there are some")?;
//! assert_eq!(results.scene.name, "park");
//! assert!(read_back::kept("no/such/folder".as_ref()).is_err());
//! assert!(read_back::stress(out.path())?.is_none(), "there is no stress.json");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::files::json::{Mistake, check_schema};
use crate::records::profile::{KIND, Line, PassProfile, Profile};
use crate::records::results::{Results, Run, SCHEMA};
use crate::records::statistics::Series;
use crate::records::stress::Report;
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::Value;
use skiagraph_graph::SourceFile;
use skiagraph_scene::Limit;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Advice for messages on a `results.json` that cannot be used: how to go on without it.
pub const WITHOUT_RESULTS: &str =
    "take another folder (`--out`), or replace all that this one holds (`--replace`)";

/// Where results come from.
const COMPARE_FIRST: &str = "name a folder that `skiagraph compare --out DIR` wrote";

/// Some twenty thousand runs.
const RESULTS: Limit = Limit {
    of: "a results.json",
    mib: 64,
    way_out: WITHOUT_RESULTS,
};

/// The same, not to be resumed.
const KEPT: Limit = Limit {
    way_out: "compare fewer views, viewports or maps into one folder",
    ..RESULTS
};

/// The most frames that can be asked for, of fifty passes.
const PROFILE: Limit = Limit {
    of: "a profile",
    mib: 256,
    way_out: "name one that `skiagraph profile --json FILE` wrote, of fewer --frames",
};

/// Reads the older profile at `path`, for `--baseline`.
///
/// # Errors
/// A file that cannot be read, or is not a profile; the message shows the place.
pub fn profile(path: &Path) -> Result<Profile> {
    let name = path.display().to_string();
    let text = PROFILE.read_text(path);
    let text = text.map_err(|error| CompareError::Input(format!("{name}: {error}")))?;
    profile_of(&SourceFile::new(name, text))
}

/// Reads the results.json at `path`, for `--resume`; `None` if the file does not exist.
///
/// # Errors
/// A file that cannot be read, or is not a results.json; the message shows the place.
pub fn results(path: &Path) -> Result<Option<Results>> {
    let file = read(&RESULTS, path).map_err(CompareError::Input)?;
    file.map(|file| results_of(&file)).transpose()
}

/// Reads a file; `None` if there is none.
fn read(limit: &Limit, path: &Path) -> Result<Option<SourceFile>, String> {
    let name = path.display().to_string();
    match limit.read_text(path) {
        Ok(text) => Ok(Some(SourceFile::new(name, text))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(format!("{name}: {error}")),
    }
}

/// Returns the folders of results that `folders` stand for. A folder stands for itself, or if it
/// holds no results itself, for the folders directly in it that do, sorted by name: `compare`
/// writes these for several scenes, `scripts/adapter.sh` for its rows.
pub fn with_scenes(folders: &[PathBuf]) -> Vec<PathBuf> {
    let is_own = |folder: &Path| {
        let has = |file: &str| folder.join(file).is_file();
        has("results.json") || has("stress.json")
    };
    let each = folders.iter().flat_map(|folder| {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut scenes: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        scenes.retain(|scene| is_own(scene));
        scenes.sort();
        if is_own(folder) || scenes.is_empty() {
            scenes = vec![folder.clone()];
        }
        scenes
    });
    each.collect()
}

/// Reads a results.json, for example to write a report of it. `place` is a folder that holds one,
/// or the path of the file, which ends in `.json`.
///
/// # Errors
/// A missing folder or file; a file that cannot be read, or is not a results.json. The message
/// shows the place.
pub fn kept(place: &Path) -> Result<Results> {
    let refused = |why: String| CompareError::Input(format!("{why}; {COMPARE_FIRST}"));
    let shown = place.display();
    let (file, missing) = if place.is_dir() {
        let missing = format!("there is no results.json in {shown}");
        (place.join("results.json"), missing)
    } else if place.extension().is_some_and(|it| it == "json") {
        (place.to_path_buf(), format!("there is no file {shown}"))
    } else {
        return Err(refused(format!("there is no folder {shown}")));
    };
    let source = read(&KEPT, &file).map_err(refused)?;
    let file = source.ok_or_else(|| refused(missing))?;
    let advice = [COMPARE_FIRST, "the results cannot be used"];
    checked(&file, parse_results, "results.json", advice)
}

/// Reads the file of a cell, a results.json with one run; `None` if the file does not exist.
///
/// # Errors
/// A file that cannot be read, or is not a results.json; the message shows the place.
pub(crate) fn cell(path: &Path) -> Result<Option<Results>> {
    let file = read(&KEPT, path).map_err(CompareError::Input)?;
    let advice = [
        "delete it, and measure the cell again",
        "the cell cannot be used",
    ];
    let cell = file.map(|file| checked(&file, parse_results, "results.json", advice));
    cell.transpose()
}

/// Parses a file; a mistake says what kind of file it is not, and gives advice and a summary.
fn checked<T>(
    file: &SourceFile,
    parse: fn(&str) -> Result<T, Mistake>,
    what_for: &str,
    [help, summary]: [&str; 2],
) -> Result<T> {
    parse(&file.text).map_err(|mistake| mistake.in_file(file, what_for, help, summary))
}

/// Reads the stress.json in a folder; `None` if the file does not exist.
///
/// # Errors
/// A file that cannot be read, or is not a stress.json; the message shows the place.
pub fn stress(folder: &Path) -> Result<Option<Report>> {
    let file = read(&KEPT, &folder.join("stress.json")).map_err(CompareError::Input)?;
    let help = "`skiagraph stress --out DIR` writes it anew";
    let advice = [help, "the matrix cannot be used"];
    let matrix = file.map(|file| checked(&file, parse_stress, "stress.json", advice));
    matrix.transpose()
}

fn parse_stress(text: &str) -> Result<Report, Mistake> {
    let head: Head = parse(text)?;
    check_schema(text, head.schema, 1)?;
    if head.methods.is_none() || head.cases.is_none() {
        let what = "\"methods\" or \"cases\" is missing".into();
        return Err(Mistake::at_field(text, "{", what));
    }
    parse(text)
}

fn profile_of(file: &SourceFile) -> Result<Profile> {
    let help = "a baseline is what `skiagraph profile --json FILE` writes";
    let advice = [help, "the baseline cannot be used"];
    checked(file, parse_profile, "profile to compare with", advice)
}

/// Parses the text of a results.json, to continue from its runs.
fn results_of(file: &SourceFile) -> Result<Results> {
    let advice = [WITHOUT_RESULTS, "nothing was measured"];
    checked(file, parse_results, "results.json to resume", advice)
}

/// Fields that tell our files from each other and from other JSON. Any other file lacks many
/// fields, and to name the first would mislead.
#[derive(Deserialize)]
struct Head {
    schema: Option<Value>,
    kind: Option<Value>,
    oracle: Option<Value>,
    runs: Option<Value>,
    methods: Option<Value>,
    cases: Option<Value>,
}

fn parse<T: DeserializeOwned>(text: &str) -> Result<T, Mistake> {
    serde_json::from_str(text).map_err(|error| Mistake::from_serde(text, &error))
}

fn parse_profile(text: &str) -> Result<Profile, Mistake> {
    let head: Head = parse(text)?;
    if head.kind != Some(KIND.into()) {
        let what = match head.kind {
            Some(kind) => format!("the kind is {kind}, not \"{KIND}\""),
            None => format!("\"kind\": \"{KIND}\" is missing"),
        };
        return Err(Mistake::at_field(text, "\"kind\"", what));
    }
    check_schema(text, head.schema, 1)?;
    let profile: Profile = parse(text)?;
    let what = "no samples here, or some that are not times";
    match without_times(&profile) {
        None => Ok(profile),
        Some(place) => Err(Mistake::at_field(text, &place, what.into())),
    }
}

/// How the JSON begins where something has samples that are no times.
fn without_times(profile: &Profile) -> Option<String> {
    let are_times = |series: &Series| {
        let samples = &series.samples;
        !samples.is_empty() && samples.iter().all(|ms| ms.is_finite() && *ms >= 0.0)
    };
    let frame = || "\"frame\": {".to_owned();
    let is_broken = |(_, gpu, cpu): &Line| !gpu.iter().chain([cpu]).all(|series| are_times(series));
    let line = profile.lines().find(is_broken);
    let named = |pass: &PassProfile| format!("\"name\": \"{}\"", pass.name);
    let place = line.map(|(pass, ..)| pass.map_or_else(frame, named));
    place.or_else(|| (!are_times(&profile.frame.wall_ms)).then(frame))
}

fn parse_results(text: &str) -> Result<Results, Mistake> {
    let head: Head = parse(text)?;
    if head.oracle.is_none() || head.runs.is_none() {
        let what = "\"oracle\" or \"runs\" is missing".into();
        return Err(Mistake::at_field(text, "{", what));
    }
    check_schema(text, head.schema, SCHEMA)?;
    let results: Results = parse(text)?;
    // A mistake in a run's measurements reads as a run without any.
    let is_broken = |run: &&Run| run.measured.is_none() && run.unavailable.is_none();
    let other_runs = results.others.iter().flat_map(|other| &other.runs);
    match results.runs.iter().chain(other_runs).find(is_broken) {
        None => Ok(results),
        Some(run) => {
            let label = run.label();
            let what = format!("{label} has neither all its measurements nor a reason why not");
            let field = format!("\"preset\": {}", Value::from(run.preset.as_str()));
            Err(Mistake::at_field(text, &field, what))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::json::to_text;
    use crate::records::{profile, results};

    /// Lists the messages for these texts, each of which differs from a good one.
    fn refused<T>(
        read: fn(&SourceFile) -> Result<T, CompareError>,
        name: &str,
        good: &str,
        texts: &[String],
    ) -> String {
        let messages = texts.iter().map(|text| {
            assert_ne!(text, good);
            let error = read(&SourceFile::new(name, text.clone()));
            let error = error.err().expect("refused");
            assert!(matches!(error, CompareError::Diagnostics { .. }), "{error}");
            error.to_string()
        });
        messages.collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn what_json_writes_can_be_read() {
        let sample = profile::tests::sample();
        assert!(parse_profile(&to_text(&sample)).is_ok_and(|profile| profile == sample));
    }

    #[test]
    fn a_broken_baseline_is_shown_with_its_place() {
        let good = to_text(&profile::tests::sample());
        let texts = [
            good.replacen("\"median\": 2.0", "\"median\": \"two\"", 1),
            good.replacen("\"kind\": \"profile\"", "\"kind\": \"results\"", 1),
            good.replacen("\"schema\": 1", "\"schema\": 2", 1),
            good.replacen("2.5,", "2.5", 1),
            "{\"schema\": 1, \"runs\": []}".to_owned(),
            String::new(),
            good.replacen("        4.0,\n        5.0,\n        4.5\n", "", 1),
            good.replacen("        2.0,", "        -2.0,", 1),
        ];
        insta::assert_snapshot!(refused(profile_of, "old.json", &good, &texts));
    }

    #[test]
    fn a_broken_run_of_joined_results_is_found() {
        let mut joined = results::tests::sample();
        joined.others = vec![results::tests::sample()];
        joined.others[0].runs[1].measured = None;
        let file = SourceFile::new("all.json", to_text(&joined));
        let error = results_of(&file).unwrap_err().to_string();
        assert!(error.contains("rt on main 512x256 has neither"), "{error}");
    }

    #[test]
    fn a_broken_or_foreign_file_is_shown_with_its_place() {
        let good = to_text(&results::tests::sample());
        let texts = [
            good.replacen("\"lit\": 60000,", "\"lit\": 60000", 1),
            good.replacen("\"frames\": 10", "\"frames\": \"ten\"", 1),
            good.replacen("\"schema\": 2", "\"schema\": 1", 1),
            good.replacen("\"memory_bytes\": 12582912,", "", 1),
            "{\"schema\": 1, \"kind\": \"profile\"}\n".to_owned(),
            String::new(),
        ];
        insta::assert_snapshot!(refused(results_of, "results.json", &good, &texts));
    }
}
