//! The files of measured cells: a `results.json` with one run for each cell, in the folder `cells`
//! beside the plan. Joins those of several machines.
//!
//! ```
//! use skiagraph_compare::records::cell_files;
//!
//! let folder = tempfile::tempdir()?;
//! assert!(!cell_files::is_folder(folder.path()), "it has no cells.jsonl");
//! let joined = cell_files::join(&[folder.path().into()])?;
//! assert!(joined.kept.is_empty() && joined.missing.is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::lists::entry;
use crate::records::cell_plan::{self, CellPlan, PlannedCell, version};
use crate::records::read_back;
use crate::records::results::{PROGRAM, Results, Run};
use crate::records::sources::Kept;
use crate::wording::plural;
use itertools::Itertools;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Name of the folder of the files of cells, below that of the results.
pub(crate) const FOLDER: &str = "cells";

/// Name of the folder of the reference's answers, beside it.
pub(crate) const TRUTHS: &str = "truth";

/// Fields of a run that are the same on all machines with one adapter and driver.
const ANSWERS: [&str; 15] = [
    "pixels",
    "band",
    "wrong_surface",
    "area",
    "certain",
    "uncertain",
    "split",
    "wrong",
    "certain_wrong_blockers",
    "facing_mismatch",
    "answer",
    "graded",
    "edges",
    "texels",
    "layer_jump",
];

/// Returns the file of a cell in a folder of results.
pub(crate) fn path(folder: &Path, cell: &str) -> PathBuf {
    folder.join(FOLDER).join(format!("{cell}.json"))
}

/// Reads the file of a cell; `None` if there is none.
///
/// # Errors
/// A file that cannot be read, or does not hold the run of this cell.
pub(crate) fn read(path: &Path) -> Result<Option<Results>> {
    let Some(results) = read_back::cell(path)? else {
        return Ok(None);
    };
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    match &results.runs[..] {
        [run] if name.starts_with(&run.cell) => Ok(Some(results)),
        _ => Err(CompareError::Input(format!(
            "{} is not the file of a cell: it does not hold that one run; delete it, and measure \
             the cell again",
            path.display()
        ))),
    }
}

/// Checks that this version of the program measured a cell; `commit` is the one that it was built
/// from.
///
/// # Errors
/// Another version or commit.
pub(crate) fn check_version(path: &Path, cell: &Results, commit: Option<&str>) -> Result<()> {
    check_versions(path, cell, &version(PROGRAM, commit))
}

fn check_versions(path: &Path, cell: &Results, ours: &str) -> Result<()> {
    let commit = cell.runs.first().and_then(|run| run.commit.as_deref());
    let theirs = version(&cell.program, commit);
    if theirs == ours {
        return Ok(());
    }
    Err(CompareError::Input(format!(
        "{} was measured by {theirs}, and the other cells by {ours}\n  one version measures all \
         cells of a comparison: delete that file, and measure its cell with the other version",
        path.display()
    )))
}

/// Compares the errors of two runs of one cell, on machines with one adapter and driver. Returns
/// the first figure that differs, as text; `None` if they agree, or if one could not run.
pub(crate) fn disagreement(one: &Run, other: &Run) -> Option<String> {
    if one.measured.is_none() || other.measured.is_none() {
        return None;
    }
    let [one, other] = [one, other].map(|run| serde_json::to_value(run).unwrap_or_default());
    let mut answers = ANSWERS.iter();
    answers.find_map(|name| difference(name, one.get(name), other.get(name)))
}

/// The first figure within two values that differs by more than the rounding of its text.
fn difference(name: &str, one: Option<&Value>, other: Option<&Value>) -> Option<String> {
    match (one, other) {
        (Some(Value::Object(one)), Some(Value::Object(other))) => {
            let names = one.keys().chain(other.keys());
            let mut each = names.map(|key| (format!("{name}.{key}"), one.get(key), other.get(key)));
            each.find_map(|(name, one, other)| difference(&name, one, other))
        }
        (Some(Value::Number(one)), Some(Value::Number(other)))
            if one.is_f64() || other.is_f64() =>
        {
            let [a, b] = [one, other].map(|number| number.as_f64().unwrap_or(f64::NAN));
            let is_same = (a - b).abs() <= 1e-12 * a.abs().max(b.abs());
            (!is_same).then(|| format!("{name}: {one} and {other}"))
        }
        (one, other) => (one != other).then(|| {
            let text = |value: Option<&Value>| value.map_or("none".to_owned(), Value::to_string);
            format!("{name}: {} and {}", text(one), text(other))
        }),
    }
}

/// The error of a cell whose errors differ in two places; `why` has the figures in their order.
pub(crate) fn at_odds(run: &Run, places: [&Path; 2], why: &str) -> CompareError {
    let [one, other] = places.map(Path::display);
    let (cell, label) = (&run.cell, run.label());
    CompareError::Input(format!(
        "the cell {cell} ({label}) was measured twice on one kind of adapter with other errors\n  \
         {one}\n  {other}\n  {why}\n  errors repeat to the pixel: find out which machine is wrong, \
         delete its cells, and measure them again"
    ))
}

/// The measured cells of folders, joined.
#[derive(Debug, Default)]
pub struct Joined {
    /// The cells, each as results with one run, in the order of their plans. A cell that was
    /// measured on several adapters has an entry for each.
    pub kept: Vec<Kept>,
    /// Remarks for the user.
    pub notes: Vec<String>,
    /// Text on the planned cells that no folder holds, with the command that measures them; `None`
    /// if all are there.
    pub missing: Option<String>,
}

/// True if `place` is a folder into which `compare --cells` wrote.
pub fn is_folder(place: &Path) -> bool {
    place.join(cell_plan::FILE).is_file()
}

/// Reads the cells of those of `places` that are folders of cells. Of a cell that several folders
/// hold from one adapter (the same name, backend and driver), the first counts; those of other
/// adapters are kept beside it.
///
/// # Errors
/// A plan or cell that cannot be read; cells of several versions of the program, or other than
/// planned; a cell or a truth that is in two folders and differs.
pub fn join(places: &[PathBuf]) -> Result<Joined> {
    let mut plans: Vec<(CellPlan, Vec<&Path>)> = Vec::new();
    for place in places.iter().filter(|place| is_folder(place)) {
        let plan = CellPlan::read(&place.join(cell_plan::FILE))?;
        entry(&mut plans, plan).push(place);
    }
    let mut joined = Joined::default();
    if let [(first, folders), other_plans @ ..] = &plans[..] {
        for (other, other_folders) in other_plans {
            check_plans([first, other], [folders[0], other_folders[0]])?;
        }
    }
    for (plan, folders) in &plans {
        check_truths(plan, folders)?;
        join_plan(plan, folders, &mut joined)?;
    }
    Ok(joined)
}

/// Refuses plans of two versions.
fn check_plans(plans: [&CellPlan; 2], places: [&Path; 2]) -> Result<()> {
    let [one, other] = plans.map(|plan| plan.head.version());
    if one == other {
        return Ok(());
    }
    let [place, other_place] = places.map(Path::display);
    Err(CompareError::Input(format!(
        "{place} holds cells of {one}, and {other_place} of {other}\n  one version measures all \
         cells of a comparison: join them into folders of their own, or measure anew with one"
    )))
}

/// The folders of a plan's scenes, below that of its results.
fn scene_folder(folder: &Path, plan: &CellPlan, cell: &PlannedCell) -> PathBuf {
    let name = plan.truth_of(cell).and_then(|truth| truth.folder.as_ref());
    name.map_or(folder.to_path_buf(), |name| folder.join(name))
}

fn join_plan(plan: &CellPlan, folders: &[&Path], joined: &mut Joined) -> Result<()> {
    let ours = plan.head.version();
    let (id, mut missing, mut twice) = (plan.id(), Vec::new(), 0);
    for cell in &plan.cells {
        let mut copies: Vec<(PathBuf, Kept)> = Vec::new();
        for folder in folders {
            let folder = scene_folder(folder, plan, cell);
            let path = path(&folder, &cell.cell);
            let Some(mut results) = read(&path)? else {
                continue;
            };
            check_versions(&path, &results, &ours)?;
            let run = &results.runs[0];
            if run.fingerprint != cell.fingerprint {
                return Err(CompareError::Input(format!(
                    "{} was measured with another graph, shader, mesh, light or view than planned: \
                     delete it, and measure the cell again",
                    path.display()
                )));
            }
            let is_like = |kept: &Kept| kept.results.adapter == results.adapter;
            let earlier = copies.iter_mut().find(|(_, kept)| is_like(kept));
            results.plan = Some(id.clone());
            if let Some((other, kept)) = earlier {
                if let Some(why) = disagreement(&kept.results.runs[0], run) {
                    return Err(at_odds(run, [other, &path], &why));
                }
                twice += 1;
                if run.is_whole() && !kept.results.runs[0].is_whole() {
                    (*other, *kept) = (path, Kept { folder, results });
                }
            } else {
                copies.push((path, Kept { folder, results }));
            }
        }
        let mut runs = copies.iter().map(|(_, kept)| &kept.results.runs[0]);
        if !runs.any(Run::is_whole) {
            missing.push(plan.label(cell));
        }
        joined.kept.extend(copies.into_iter().map(|(_, kept)| kept));
    }
    if twice > 0 {
        let cells = plural(plan.cells.len(), "cell");
        joined.notes.push(format!(
            "{twice} of {cells} were measured more than once and agree: the first of each counts"
        ));
    }
    if let [first, ..] = &missing[..] {
        let (count, cells) = (missing.len(), plural(plan.cells.len(), "planned cell"));
        let plan = folders[0].join(cell_plan::FILE);
        let place = folders[0].display();
        joined.missing = Some(format!(
            "{count} of {cells} are not measured yet, the first of them {first}: `skiagraph \
             compare --cells {} --out {place}` measures what {place} lacks",
            plan.display()
        ));
    }
    Ok(())
}

/// Refuses truths that two folders hold and that differ.
fn check_truths(plan: &CellPlan, folders: &[&Path]) -> Result<()> {
    let read = |file: &Path| {
        fs::read(file).map_err(|error| {
            let file = file.display();
            CompareError::Input(format!("cannot read {file}: {error}"))
        })
    };
    let scenes = plan.truths.iter().map(|truth| truth.folder.as_deref());
    let scenes: Vec<&str> = scenes.map(Option::unwrap_or_default).unique().collect();
    let mut by_name: BTreeMap<PathBuf, PathBuf> = BTreeMap::new();
    for (folder, scene) in folders.iter().cartesian_product(scenes) {
        let below = Path::new(scene).join(TRUTHS);
        let entries = fs::read_dir(folder.join(&below)).into_iter().flatten();
        let names = entries.flatten().map(|entry| below.join(entry.file_name()));
        for name in names.filter(|name| name.extension().is_some_and(|it| it == "truth")) {
            let path = folder.join(&name);
            let other = by_name.entry(name).or_insert_with(|| path.clone());
            if *other != path && read(other)? != read(&path)? {
                let [one, other] = [other, &path].map(|path| path.display());
                return Err(CompareError::Input(format!(
                    "two machines have traced the same reference, and their bits differ\n  \
                     {one}\n  {other}\n  find out which machine is wrong, delete its cells and its \
                     truth, and measure them again on machines that agree"
                )));
            }
        }
    }
    Ok(())
}
