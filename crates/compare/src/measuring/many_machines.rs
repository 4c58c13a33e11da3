//! Plans the cells of a comparison for many machines, and measures a shard of them into a folder.
//!
//! ```no_run
//! use skiagraph_compare::{
//!     comparison::Comparison,
//!     measuring::many_machines::{SceneCells, Share, measure, plan},
//!     sink::Session,
//! };
//! use std::path::Path;
//!
//! # type Done = Result<(), Box<dyn std::error::Error>>;
//! # async fn third_of_ten(comparison: &Comparison, session: Session<'_>) -> Done {
//! let scenes = [SceneCells { comparison, folder: None }];
//! let plan = plan(&scenes, session, vec!["compare".into()]).await?;
//! let share = Share { plan: &plan, shard: "3/10".parse()?, out: Path::new("out") };
//! let shard = measure(&share, &scenes, session).await?;
//! println!("{} of {} cells were there", shard.kept, shard.cells);
//! # Ok(())
//! # }
//! ```

use crate::comparison::Comparison;
use crate::error::{CompareError, Result};
use crate::files::write::{check_folder, write_new};
use crate::measuring::cell;
use crate::measuring::series::Series;
use crate::measuring::view_or_path::ViewOrPath;
use crate::records::cell_plan::{CellPlan, FILE, Head, PlannedCell, PlannedTruth};
use crate::records::results::Run;
use crate::records::shard::Shard;
use crate::sink::{Session, Silent};
use crate::wording::plural;
use itertools::Itertools;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// One scene of a plan.
#[derive(Clone, Copy)]
pub struct SceneCells<'a> {
    /// Methods, views and viewports on the scene.
    pub comparison: &'a Comparison,
    /// Name of the scene's folder below that of all results; `None` for a single scene.
    pub folder: Option<&'a str>,
}

/// The part of a plan that one process measures.
#[derive(Clone, Copy)]
pub struct Share<'a> {
    /// The plan.
    pub plan: &'a CellPlan,
    /// The part of the plan to be measured.
    pub shard: Shard,
    /// Folder of the results, made if it is missing. Several machines may write into one folder.
    pub out: &'a Path,
}

/// Outcome of a shard.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShardOutcome {
    /// Number of cells of the shard.
    pub cells: usize,
    /// Number of those that the folder held before.
    pub kept: usize,
    /// Labels of the runs whose methods cannot run here
    /// ([`Run::label`](crate::records::results::Run::label)).
    pub unavailable: Vec<String>,
}

/// Plans the cells of scenes, and measures nothing. Defaults of params that depend on the GPU's
/// features are those on the session's GPU. `arguments` are the words of the command line without
/// the program's name, which the plan records.
///
/// # Errors
/// Two methods that are the same cell.
pub async fn plan(
    scenes: &[SceneCells<'_>],
    session: Session<'_>,
    arguments: Vec<String>,
) -> Result<CellPlan> {
    let first = scenes.first();
    let commit = first.and_then(|scene| scene.comparison.commit.clone());
    let mut plan = CellPlan {
        head: Head::new(arguments, commit),
        truths: Vec::new(),
        cells: Vec::new(),
    };
    let silent = Session::new(session.gpu, &Silent);
    for SceneCells { comparison, folder } in scenes {
        let series = Series::new(comparison, silent, None).await?;
        let mut runs = series.planned_runs().iter();
        for view in &comparison.views {
            let frames = match view {
                ViewOrPath::Still(_) => 1,
                ViewOrPath::Path(path) => path.frames(),
            };
            for &viewport in &comparison.viewports {
                let truth = cell::truth_id(comparison, view, viewport);
                let waiting = runs.by_ref().take(comparison.methods.len());
                plan.cells.extend(waiting.map(|run| PlannedCell {
                    cell: run.cell.clone(),
                    truth: truth.clone(),
                    preset: run.preset.clone(),
                    map_size: run.map_size,
                    params: run.params.clone(),
                    fingerprint: run.fingerprint.clone(),
                }));
                plan.truths.push(PlannedTruth {
                    truth,
                    scene: comparison.scene.name.clone(),
                    folder: folder.map(str::to_owned),
                    view: view.name().to_owned(),
                    viewport,
                    frames,
                });
            }
        }
    }
    plan.head.cells = plan.cells.len();
    let mut by_id: BTreeMap<&str, &PlannedCell> = BTreeMap::new();
    for cell in &plan.cells {
        if let Some(other) = by_id.insert(&cell.cell, cell) {
            let [one, other] = [other, cell].map(|cell| plan.label(cell));
            return Err(CompareError::Input(format!(
                "`{one}` and `{other}` are the same cell: leave one of them out"
            )));
        }
    }
    Ok(plan)
}

/// Measures the cells of a shard that the folder [`Share::out`] does not hold yet. Each becomes a
/// file of its own, `cells/ID.json`; the folder also gets the pictures, a copy
/// of the plan, and the reference's answers in `truth`, which are traced once for all machines that
/// share the folder. `scenes` are those of which the plan was made.
///
/// # Errors
/// A folder that holds the cells of another plan; cells that this machine plans otherwise than they
/// were planned; a cell in the folder by another version of the program; a cell or reference that
/// another machine has written meanwhile with other errors or answers; the errors of
/// [`Series::measure`]; [`CompareError::InvalidOutputs`] for graphs whose outputs are not a shadow
/// method's.
pub async fn measure(
    share: &Share<'_>,
    scenes: &[SceneCells<'_>],
    session: Session<'_>,
) -> Result<ShardOutcome> {
    let Share { plan, shard, out } = *share;
    let own_plan = self::plan(scenes, session, plan.head.arguments.clone()).await?;
    check_alike(plan, &own_plan)?;
    check_folder(out)?;
    copy_plan(plan, out)?;
    let chosen = &plan.cells[shard.of(&plan.pixels())];
    let ids: BTreeSet<&str> = chosen.iter().map(|cell| &*cell.cell).collect();
    let mut outcome = ShardOutcome {
        cells: chosen.len(),
        ..ShardOutcome::default()
    };
    let mut broken = BTreeSet::new();
    for SceneCells { comparison, folder } in scenes {
        let folder = folder.map_or(out.to_path_buf(), |name| out.join(name));
        let mut series = Series::of_cells(comparison, session, &folder, &ids).await?;
        outcome.kept += series.results.runs.len();
        let measured = series.measure_all().await;
        measured.map_err(|error| match error {
            CompareError::Interrupted { .. } => interrupted(share),
            error => error,
        })?;
        let unavailable = series.results.runs.iter();
        let unavailable = unavailable.filter(|run| run.measured.is_none());
        outcome.unavailable.extend(unavailable.map(Run::label));
        broken.append(&mut series.broken);
    }
    match broken.iter().join("\nerror: ") {
        broken if broken.is_empty() => Ok(outcome),
        broken => Err(CompareError::InvalidOutputs(broken)),
    }
}

fn interrupted(share: &Share) -> CompareError {
    let out = share.out.display();
    CompareError::Interrupted {
        kept: format!("finished cells are in {out}; the same command goes on from there"),
    }
}

/// Refuses to measure what was not planned.
fn check_alike(plan: &CellPlan, own_plan: &CellPlan) -> Result<()> {
    let refused = |why: String| {
        Err(CompareError::Input(format!(
            "the plan is of other cells than this machine would measure\n  {why}\n  measure all \
             cells with the same files, in the same folder, or plan anew (--plan)"
        )))
    };
    let (planned, own) = (plan.cells.len(), own_plan.cells.len());
    if planned != own {
        let planned = plural(planned, "cell");
        return refused(format!("planned are {planned}, and here are {own}"));
    }
    let mut pairs = plan.cells.iter().zip(&own_plan.cells);
    let Some((planned, own)) = pairs.find(|(planned, own)| planned != own) else {
        return Ok(());
    };
    let label = plan.label(planned);
    let mut params = planned.params.iter();
    let param = params.find(|(name, value)| own.params.get(*name) != Some(*value));
    refused(match param {
        _ if label != own_plan.label(own) => {
            format!("planned is {label}, and here is {}", own_plan.label(own))
        }
        Some((name, value)) => {
            let now = own.params.get(name).cloned().unwrap_or_default();
            format!(
                "{label}: the param {name} was planned as {value}, and is {now} here; a default \
                 that depends on the GPU is settled by --set {name}={}",
                value.as_str().map_or(value.to_string(), str::to_owned)
            )
        }
        None => format!("{label}: its graph, shaders, mesh, light or view are others here"),
    })
}

/// Puts the plan into the folder of its cells, so that `merge` knows which are missing.
fn copy_plan(plan: &CellPlan, out: &Path) -> Result<()> {
    let refused = |what: &str| {
        Err(CompareError::Input(format!(
            "{} holds {what}: name another folder (--out), or delete it",
            out.display()
        )))
    };
    let file: PathBuf = out.join(FILE);
    if !file.exists() && out.join("results.json").exists() {
        return refused("results of a comparison without a plan");
    }
    let text = plan.text();
    if write_new(&file, text.as_bytes())? || fs::read(&file).is_ok_and(|it| it == text.as_bytes()) {
        return Ok(());
    }
    refused("the cells of another plan")
}
